"""Outlines of profiles drawn in upright planes as OpenCASCADE edges and faces [mm]."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot, pi

from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeWire
from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Elips, gp_Pnt
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face

from families.outline import Bow, Point
from families.parts import Direction

MM = 1000.0  # parameters are in metres, B-Rep in millimetres
TOUCH = 1e-9  # [m], two ends nearer than that are one point


@dataclass(frozen=True)
class Upright:
    """Vertical plane in which an outline is drawn: u along `across` from `centre` to one side, at a place along it."""

    across: Direction
    centre: float
    along: float
    base: float
    sign: int

    def point(self, u: float, z: float) -> gp_Pnt:
        """Point [mm] of the outline's (u, z) [m]."""
        across, along = MM * (self.centre + self.sign * u), MM * self.along
        x, y = (across, along) if self.across == "x" else (along, across)
        return gp_Pnt(x, y, MM * (self.base + z))

    def edge(self, bow: Bow) -> TopoDS_Edge:
        """An arc, as an exact circle or ellipse."""
        u = gp_Dir(self.sign, 0, 0) if self.across == "x" else gp_Dir(0, self.sign, 0)
        up = gp_Dir(0, 0, 1)
        normal, centre = u.Crossed(up), self.point(bow.u, bow.z)
        if bow.a == bow.b:
            circle = gp_Circ(gp_Ax2(centre, normal, u), MM * bow.a)
            return BRepBuilderAPI_MakeEdge(circle, bow.start, bow.end).Edge()
        if bow.a > bow.b:
            ellipse = gp_Elips(gp_Ax2(centre, normal, u), MM * bow.a, MM * bow.b)
            return BRepBuilderAPI_MakeEdge(ellipse, bow.start, bow.end).Edge()
        # OpenCASCADE counts from the long axis, here the upright one.
        ellipse = gp_Elips(gp_Ax2(centre, normal, up), MM * bow.b, MM * bow.a)
        return BRepBuilderAPI_MakeEdge(ellipse, bow.start - pi / 2, bow.end - pi / 2).Edge()


def sketch(outline: Sequence[Point | Bow], plane: Upright) -> TopoDS_Face:
    """Planar face within corners and arcs; straight lines join what does not touch."""
    wire = BRepBuilderAPI_MakeWire()
    ends = [(step.at(step.start), step.at(step.end)) if isinstance(step, Bow) else (step, step) for step in outline]
    for k, step in enumerate(outline):
        if isinstance(step, Bow):
            wire.Add(plane.edge(step))
        here, there = ends[k][1], ends[(k + 1) % len(ends)][0]
        if hypot(there[0] - here[0], there[1] - here[1]) > TOUCH:
            wire.Add(BRepBuilderAPI_MakeEdge(plane.point(*here), plane.point(*there)).Edge())
    return BRepBuilderAPI_MakeFace(wire.Wire(), True).Face()
