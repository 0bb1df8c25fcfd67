"""Solids made cell by cell, joined into one."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray
from OCP.BOPTools import BOPTools_AlgoTools3D
from OCP.BRep import BRep_Builder
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeSolid, BRepBuilderAPI_Sewing
from OCP.BRepLib import BRepLib
from OCP.GeomAbs import GeomAbs_Plane
from OCP.gp import gp_Pnt, gp_Pnt2d
from OCP.IntTools import IntTools_Context
from OCP.TopAbs import TopAbs_FACE, TopAbs_SHELL
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS, TopoDS_Compound, TopoDS_Face, TopoDS_Shape

from families.cells import Cuts
from families.sketch import MM
from families.spheres import unturned

SEAM = 1e-5  # [m], edges nearer than that are sewn
NEAR = 1e-7  # [m]


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


def sewn(bodies: Iterable[TopoDS_Shape], cuts: Cuts) -> TopoDS_Compound:
    """A compound of one solid, or more if they lie apart, of bodies that touch in the planes of the cuts."""
    sewing = BRepBuilderAPI_Sewing(MM * SEAM)
    for body in bodies:
        found = list(faces(body))
        for face, point in zip(found, inner_points(found), strict=True):
            if not _is_cut(face, point, cuts):
                sewing.Add(unturned(face))
    sewing.Perform()
    return solids(sewing.SewedShape())


def solids(shape: TopoDS_Shape) -> TopoDS_Compound:
    """A compound of the solids that the closed shells of a shape bound."""
    explorer = TopExp_Explorer(shape, TopAbs_SHELL)
    found = []
    while explorer.More():
        solid = BRepBuilderAPI_MakeSolid(TopoDS.Shell_s(explorer.Current())).Solid()
        BRepLib.OrientClosedSolid_s(solid)
        found.append(solid)
        explorer.Next()
    compound, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(compound)
    for solid in found:
        builder.Add(compound, solid)
    return compound


def _is_cut(face: TopoDS_Face, point: NDArray[np.float64], cuts: Cuts) -> bool:
    near = [
        axis for axis, places in enumerate((cuts.x, cuts.y)) if any(abs(point[axis] - place) < NEAR for place in places)
    ]
    if not near:
        return False
    surface = BRepAdaptor_Surface(face)
    if surface.GetType() != GeomAbs_Plane:
        return False
    normal = surface.Plane().Axis().Direction()
    return any(abs((normal.X(), normal.Y())[axis]) > 1 - 1e-9 for axis in near)
