"""A B-Rep bent by a smooth map of space: its poles are moved, after knots were put in until that is near enough."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakePolygon,
    BRepBuilderAPI_MakeSolid,
    BRepBuilderAPI_MakeWire,
    BRepBuilderAPI_NurbsConvert,
    BRepBuilderAPI_Sewing,
)
from OCP.BRepLib import BRepLib
from OCP.BRepTools import BRepTools_WireExplorer
from OCP.gp import gp_Pnt
from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal
from OCP.TopAbs import TopAbs_FORWARD, TopAbs_SHELL, TopAbs_WIRE
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Face, TopoDS_Shape, TopoDS_Wire

from families.declaration.units import MM
from families.solid.occ.shapes import faces, is_sound, together

Array = NDArray[np.float64]
Map = Callable[[Array], Array]
SPANS = 16  # between knots, along each direction of a face and along an edge
WELD = 1e-4  # [mm] that corners of a mesh may be apart
NEAR_EDGE = 0.5  # [mm] that an edge and its faces may be apart


def bent(shape: TopoDS_Shape, move: Map) -> TopoDS_Shape:
    """Solids [mm] whose points were moved by a map of points (n, 3) [m].

    Moving the poles of a spline is exact for affine maps; else the error falls with the square of the spans (Farin
    2002, on knot insertion). Each face is bent alone, and they are sewn again.

    Raises:
        ValueError: they do not close any more, as spheres about a pole.
    """
    sewing = BRepBuilderAPI_Sewing(NEAR_EDGE)
    for face in faces(shape):
        sewing.Add(_bent(face, move))
    sewing.Perform()
    found = _solids(sewing.SewedShape())
    if not is_sound(found):
        raise ValueError("the bent faces do not close")
    return found


def faceted(vertices: Array, triangles: NDArray[np.integer]) -> TopoDS_Shape:
    """The solid [mm] of a closed mesh, its vertices (n, 3) [m] and triangles (m, 3): as many plane faces."""
    points = [gp_Pnt(*p) for p in (MM * vertices).tolist()]
    sewing = BRepBuilderAPI_Sewing(WELD)
    for a, b, c in triangles.tolist():
        made = BRepBuilderAPI_MakeFace(BRepBuilderAPI_MakePolygon(points[a], points[b], points[c], True).Wire(), True)
        if made.IsDone():
            sewing.Add(made.Face())
    sewing.Perform()
    return _solids(sewing.SewedShape())


def _solids(shape: TopoDS_Shape) -> TopoDS_Shape:
    """A compound of the solids that the closed shells of a shape bound."""
    explorer, found = TopExp_Explorer(shape, TopAbs_SHELL), []
    while explorer.More():
        solid = BRepBuilderAPI_MakeSolid(TopoDS.Shell_s(explorer.Current())).Solid()
        BRepLib.OrientClosedSolid_s(solid)
        found.append(solid)
        explorer.Next()
    return together(found)


def _bent(face: TopoDS_Face, move: Map) -> TopoDS_Shape:
    """One face: its surface is bent, its edges are drawn on that again by their curves in its parameters."""
    plain = TopoDS.Face_s(BRepBuilderAPI_NurbsConvert(face, True).Shape())
    place = TopLoc_Location()
    surface: Any = BRep_Tool.Surface_s(plain, place)
    surface = surface.Transformed(place.Transformation())
    _refine(surface)
    poles = [(i, j) for i in range(1, surface.NbUPoles() + 1) for j in range(1, surface.NbVPoles() + 1)]
    for (i, j), point in zip(poles, _moved([surface.Pole(i, j) for i, j in poles], move), strict=True):
        surface.SetPole(i, j, point)
    explorer, made = TopExp_Explorer(plain.Oriented(TopAbs_FORWARD), TopAbs_WIRE), None
    while explorer.More():
        wire = _wire(TopoDS.Wire_s(explorer.Current()), plain, surface)
        if made is None:
            made = BRepBuilderAPI_MakeFace(surface, wire, True)
        else:
            made.Add(wire)
        explorer.Next()
    if made is None or not made.IsDone():
        raise ValueError("a face cannot be bent; take less skew")
    return made.Face().Oriented(plain.Orientation())


def _wire(wire: TopoDS_Wire, face: TopoDS_Face, surface: Any) -> TopoDS_Wire:
    made, explorer = (
        BRepBuilderAPI_MakeWire(),
        BRepTools_WireExplorer(wire, TopoDS.Face_s(face.Oriented(TopAbs_FORWARD))),
    )
    while explorer.More():
        edge = explorer.Current()
        first, last = BRep_Tool.Range_s(edge)
        drawn = BRepBuilderAPI_MakeEdge(BRep_Tool.CurveOnSurface_s(edge, face, 0.0, 0.0), surface, first, last).Edge()
        BRepLib.BuildCurves3d_s(drawn)
        made.Add(TopoDS.Edge_s(drawn.Oriented(edge.Orientation())))
        explorer.Next()
    if not made.IsDone():
        raise ValueError("the edges of a bent face do not meet")
    return made.Wire()


def _refine(surface: Any) -> None:
    u0, u1, v0, v1 = surface.Bounds()
    _insert(u0, u1, lambda *knots: surface.InsertUKnots(*knots, True))
    _insert(v0, v1, lambda *knots: surface.InsertVKnots(*knots, True))


def _insert(first: float, last: float, insert: Callable[..., None]) -> None:
    """`SPANS` - 1 knots between two parameters."""
    knots, times = TColStd_Array1OfReal(1, SPANS - 1), TColStd_Array1OfInteger(1, SPANS - 1)
    for k, value in enumerate(np.linspace(first, last, SPANS + 1)[1:-1].tolist(), 1):
        knots.SetValue(k, value)
        times.SetValue(k, 1)
    insert(knots, times, 1e-9)


def _moved(points: list[gp_Pnt], move: Map) -> list[gp_Pnt]:
    there = MM * move(np.array([(p.X(), p.Y(), p.Z()) for p in points]) / MM)
    return [gp_Pnt(*p) for p in there.tolist()]
