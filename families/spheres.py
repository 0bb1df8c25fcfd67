"""Faces of spheres that were turned about the plumb line, laid on one sphere.

OpenCASCADE crashes where it is to join such faces, as CAD programs do after each step.
"""

from __future__ import annotations

from math import atan2, pi

from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy
from OCP.BRepTools import BRepTools
from OCP.Geom import Geom_SphericalSurface
from OCP.GeomAbs import GeomAbs_Sphere
from OCP.gp import gp_Ax3, gp_Dir, gp_Vec2d
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FORWARD, TopAbs_WIRE
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Face

SMALL = 1e-12  # [rad]


def unturned(face: TopoDS_Face) -> TopoDS_Face:
    """The same face on the sphere whose longitudes begin at x; any other face, and one that is there, as it is."""
    surface = BRepAdaptor_Surface(face)
    if surface.GetType() != GeomAbs_Sphere:
        return face
    sphere = surface.Sphere()
    start = sphere.Position().XDirection()
    angle = atan2(start.Y(), start.X())
    if abs(angle) < SMALL:
        return face
    # A copy, for edges are shared with faces that stay.
    old = TopoDS.Face_s(BRepBuilderAPI_Copy(face).Shape().Oriented(TopAbs_FORWARD))
    axes = gp_Ax3(sphere.Location(), gp_Dir(0, 0, 1), gp_Dir(1, 0, 0))
    fresh, here = Geom_SphericalSurface(axes, sphere.Radius()), TopLoc_Location()
    low, high, _, _ = BRepTools.UVBounds_s(old)
    turns = round(((low + high) / 2 + angle - pi) / (2 * pi))  # longitudes run from 0 to 2 pi
    shift = gp_Vec2d(angle - 2 * pi * turns, 0.0)
    builder, new = BRep_Builder(), TopoDS_Face()
    builder.MakeFace(new, fresh, here, BRep_Tool.Tolerance_s(old))
    wires = TopExp_Explorer(old, TopAbs_WIRE)
    while wires.More():
        edges = TopExp_Explorer(wires.Current(), TopAbs_EDGE)
        while edges.More():
            edge = TopoDS.Edge_s(edges.Current())
            first, last = BRep_Tool.Range_s(edge)
            curve = BRep_Tool.CurveOnSurface_s(edge, old, first, last)
            builder.UpdateEdge(edge, curve.Translated(shift), fresh, here, BRep_Tool.Tolerance_s(edge))
            builder.Range(edge, fresh, here, first, last)
            edges.Next()
        builder.Add(new, wires.Current())
        wires.Next()
    return TopoDS.Face_s(new.Oriented(face.Orientation()))
