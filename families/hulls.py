"""The faces of the masonry in a cell: those of the body outside and of the room inside, less where both end.

Both are bodies in the same cell, so that only their plane ends there have to be cut from each other; that is several
times as quick as to cut the bodies.
"""

from __future__ import annotations

from collections.abc import Iterable

from OCP.BRep import BRep_Builder
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
from OCP.BRepGProp import BRepGProp
from OCP.GeomAbs import GeomAbs_Plane
from OCP.GProp import GProp_GProps
from OCP.TopoDS import TopoDS_Compound, TopoDS_Face, TopoDS_Shape
from OCP.TopTools import TopTools_ListOfShape

from families.cells import Cell
from families.sewing import faces
from families.sketch import MM

ON = 1e-6  # [m] from a side of the cell
UPRIGHT = 1 - 1e-9  # cosine
SAME = 1e-5  # of an area

Side = tuple[int, float]  # axis, place [m]


def hull(whole: TopoDS_Shape, hollow: TopoDS_Shape, cell: Cell, ends: Iterable[Side]) -> TopoDS_Shape:
    """The faces of a body without another that lies in it; they do not close where cells meet.

    Args:
        whole: the body.
        hollow: the body in it.
        cell: in which both were made.
        ends: the sides of the cell at which the masonry ends; beyond the others it goes on.

    Raises:
        ValueError: OpenCASCADE cannot cut the ends.
    """
    outer, inner = _by_side(whole, cell), _by_side(hollow, cell)
    found = [*outer.pop(None, []), *inner.pop(None, [])]
    for side in ends:
        found += _cut(outer.get(side, []), inner.get(side, []))
    compound, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(compound)
    for face in found:
        builder.Add(compound, face)
    return compound


def sides(cell: Cell) -> tuple[Side, ...]:
    """The four plumb sides of a cell, and its bottom."""
    return (0, cell.x[0]), (0, cell.x[1]), (1, cell.y[0]), (1, cell.y[1]), (2, cell.low)


def _by_side(body: TopoDS_Shape, cell: Cell) -> dict[Side | None, list[TopoDS_Face]]:
    """The faces of a body by the side of the cell that they lie on, under None those that lie on none."""
    found: dict[Side | None, list[TopoDS_Face]] = {}
    for face in faces(body):
        found.setdefault(_side(face, cell), []).append(face)
    return found


def _side(face: TopoDS_Face, cell: Cell) -> Side | None:
    surface = BRepAdaptor_Surface(face)
    if surface.GetType() != GeomAbs_Plane:
        return None
    plane = surface.Plane()
    normal, place = plane.Axis().Direction(), plane.Location()
    for axis, where in sides(cell):
        along = (normal.X(), normal.Y(), normal.Z())[axis]
        if abs(along) > UPRIGHT and abs((place.X(), place.Y(), place.Z())[axis] / MM - where) < ON:
            return axis, where
    return None


def _cut(whole: list[TopoDS_Face], hollow: list[TopoDS_Face]) -> list[TopoDS_Face]:
    """Plane faces without others in the same plane."""
    if not whole or not hollow:
        return whole
    step = BRepAlgoAPI_Cut()
    step.SetArguments(_listed(whole))
    step.SetTools(_listed(hollow))
    step.Build()
    if not step.IsDone():
        raise ValueError("OpenCASCADE cannot cut the ends of this vault; change a parameter a little")
    left = list(faces(step.Shape()))
    if abs(_area(left) - _area(whole) + _area(hollow)) > SAME * _area(whole):
        raise ValueError("OpenCASCADE cuts the ends of this vault wrongly; change a parameter a little")
    return left


def _area(found: list[TopoDS_Face]) -> float:
    total = 0.0
    for face in found:
        sums = GProp_GProps()
        BRepGProp.SurfaceProperties_s(face, sums)
        total += sums.Mass()
    return float(total)


def _listed(shapes: list[TopoDS_Face]) -> TopTools_ListOfShape:
    listed = TopTools_ListOfShape()
    for shape in shapes:
        listed.Append(shape)
    return listed
