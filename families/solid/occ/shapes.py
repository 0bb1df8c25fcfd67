"""What is asked of OpenCASCADE's shapes [mm]: their faces, volume and soundness."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray
from OCP.BOPTools import BOPTools_AlgoTools3D
from OCP.BRep import BRep_Builder
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.gp import gp_Pnt, gp_Pnt2d
from OCP.GProp import GProp_GProps
from OCP.IntTools import IntTools_Context
from OCP.TopAbs import TopAbs_FACE
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS, TopoDS_Compound, TopoDS_Face, TopoDS_Shape

from families.declaration.units import MM

ACCURACY = 1e-7  # of a volume: not told it, OpenCASCADE misses 1e-5 where two arches are nearly equally high


def faces(shape: TopoDS_Shape) -> Iterator[TopoDS_Face]:
    """The faces of a shape in its order."""
    explorer = TopExp_Explorer(shape, TopAbs_FACE)
    while explorer.More():
        yield TopoDS.Face_s(explorer.Current())
        explorer.Next()


def inner_points(shapes: list[TopoDS_Face]) -> NDArray[np.float64]:
    """One point (n, 3) [m] inside each face."""
    context, points = IntTools_Context(), np.empty((len(shapes), 3))
    for k, face in enumerate(shapes):
        point, uv = gp_Pnt(), gp_Pnt2d()
        BOPTools_AlgoTools3D.PointInFace_s(face, point, uv, context)
        points[k] = point.X(), point.Y(), point.Z()
    return points / MM


def together(shapes: Iterable[TopoDS_Shape]) -> TopoDS_Compound:
    """A compound of shapes."""
    compound, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(compound)
    for shape in shapes:
        builder.Add(compound, shape)
    return compound


def is_sound(shape: TopoDS_Shape) -> bool:
    """Whether a shape has a face and OpenCASCADE finds no fault in it."""
    in_threads = False  # in a process that is forked where there were some, these would be waited for without end
    return next(faces(shape), None) is not None and bool(BRepCheck_Analyzer(shape, True, in_threads).IsValid())


def volume(shape: TopoDS_Shape) -> float:
    """Volume [mm³]."""
    sums = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, sums, ACCURACY)
    return float(sums.Mass())
