"""A barrel on a curved axis as an OpenCASCADE body [mm]: rational B-splines that are exact, for it is a translation."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakeSolid,
    BRepBuilderAPI_MakeWire,
    BRepBuilderAPI_Sewing,
)
from OCP.BRepLib import BRepLib
from OCP.Geom import Geom_BezierCurve, Geom_BSplineSurface, Geom_TrimmedCurve
from OCP.GeomConvert import GeomConvert
from OCP.gp import gp_Pnt, gp_Vec
from OCP.TColgp import TColgp_Array1OfPnt, TColgp_Array2OfPnt
from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal, TColStd_Array2OfReal
from OCP.TopoDS import TopoDS, TopoDS_Edge, TopoDS_Face, TopoDS_Shape

from families.outline import Bow
from families.parts import Barrel
from families.sketch import MM, TOUCH, Upright

SEAM = 1e-3  # [mm]


def domical(
    part: Barrel, sign: int, bows: Sequence[Bow], near: float, low: float, reach: tuple[float, float]
) -> TopoDS_Shape:
    """The body under arcs moved along the parabola of a barrel's axis, on one side of it.

    Args:
        part: the barrel.
        sign: side of its axis.
        bows: the arcs of its profile there, from the wall to u = `near` [m].
        near: where the body ends towards the axis [m].
        low: where it ends below [m].
        reach: from where to where along the axis [m].
    """
    start, end = reach
    fall = -2 * part.crown_rise * start / part.half_length**2
    corner = part.lift(start) + fall * (end - start) / 2
    axis = ((start, part.lift(start)), ((start + end) / 2, corner), (end, part.lift(end)))

    def place(u: float, z: float, along: float, lift: float) -> gp_Pnt:
        return Upright(part.across, part.centre, along, part.base + lift, sign).point(u, z)

    def ground(u: float, along: float) -> gp_Pnt:
        return Upright(part.across, part.centre, along, 0.0, sign).point(u, low)

    def parabola(u: float, z: float) -> TopoDS_Edge:
        poles = TColgp_Array1OfPnt(1, 3)
        for k, (along, lift) in enumerate(axis, 1):
            poles.SetValue(k, place(u, z, along, lift))
        return BRepBuilderAPI_MakeEdge(Geom_BezierCurve(poles)).Edge()

    foot, crown = bows[0].at(bows[0].start), bows[-1].at(bows[-1].end)
    sewing = BRepBuilderAPI_Sewing(SEAM)
    for u, z in (foot, (near, crown[1])):
        ends = [place(u, z, *axis[0]), ground(u, start), ground(u, end), place(u, z, *axis[2])]
        sewing.Add(_planar([*_lines(ends), parabola(u, z)]))
    corners = [ground(u, along) for u, along in ((near, start), (foot[0], start), (foot[0], end), (near, end))]
    sewing.Add(_planar(_lines([*corners, corners[0]])))
    for along, lift in (axis[0], axis[2]):
        plane = Upright(part.across, part.centre, along, part.base + lift, sign)
        frame = [place(*crown, along, lift), place(near, crown[1], along, lift), ground(near, along)]
        frame += [ground(foot[0], along), place(*foot, along, lift)]
        sewing.Add(_planar([*_lines(frame), *(plane.edge(bow) for bow in bows)]))
    for bow in bows:
        sewing.Add(_translated(Upright(part.across, part.centre, 0.0, part.base, sign).edge(bow), part, axis))
    sewing.Perform()
    solid = BRepBuilderAPI_MakeSolid(TopoDS.Shell_s(sewing.SewedShape())).Solid()
    BRepLib.OrientClosedSolid_s(solid)
    return solid


def _lines(points: Sequence[gp_Pnt]) -> list[TopoDS_Edge]:
    return [BRepBuilderAPI_MakeEdge(a, b).Edge() for a, b in pairwise(points) if a.Distance(b) > MM * TOUCH]


def _planar(edges: Sequence[TopoDS_Edge]) -> TopoDS_Face:
    wire = BRepBuilderAPI_MakeWire()
    for edge in edges:
        wire.Add(edge)
    return BRepBuilderAPI_MakeFace(wire.Wire(), True).Face()


def _translated(edge: TopoDS_Edge, part: Barrel, axis: Sequence[tuple[float, float]]) -> TopoDS_Face:
    """An edge moved along a parabola given by its Bézier points (along, lift) [m]."""
    ends = BRepAdaptor_Curve(edge)
    piece = Geom_TrimmedCurve(BRep_Tool.Curve_s(edge, 0.0, 1.0), ends.FirstParameter(), ends.LastParameter())
    curve = GeomConvert.CurveToBSplineCurve_s(piece)
    n, knots = curve.NbPoles(), curve.NbKnots()
    poles, weights = TColgp_Array2OfPnt(1, n, 1, 3), TColStd_Array2OfReal(1, n, 1, 3)
    for j, (along, lift) in enumerate(axis, 1):
        x, y = (0.0, along) if part.across == "x" else (along, 0.0)
        for i in range(1, n + 1):
            poles.SetValue(i, j, curve.Pole(i).Translated(gp_Vec(MM * x, MM * y, MM * lift)))
            weights.SetValue(i, j, curve.Weight(i))
    u_knots, u_counts = TColStd_Array1OfReal(1, knots), TColStd_Array1OfInteger(1, knots)
    for k in range(1, knots + 1):
        u_knots.SetValue(k, curve.Knot(k))
        u_counts.SetValue(k, curve.Multiplicity(k))
    v_knots, v_counts = TColStd_Array1OfReal(1, 2), TColStd_Array1OfInteger(1, 2)
    for k in (1, 2):
        v_knots.SetValue(k, float(k - 1))
        v_counts.SetValue(k, 3)
    surface = Geom_BSplineSurface(poles, weights, u_knots, v_knots, u_counts, v_counts, curve.Degree(), 2)
    return BRepBuilderAPI_MakeFace(surface, SEAM).Face()
