"""The free surfaces as one sheet of B-Rep [mm]: faces clipped at the edges in which they meet, which they share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import make_interp_spline

from families.declaration.units import MM
from vaultcad.nurbs.freeform import FreeForm
from vaultcad.nurbs.outline import Edge, Face
from vaultcad.nurbs.spline_surface import DEGREE, SplineSurface, spline_surface

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Edge, TopoDS_Face, TopoDS_Shell

Array = NDArray[np.float64]
MARGIN = 0.05  # m, by which a surface reaches beyond its face
BETWEEN = 4  # places between two nodes at which an edge is compared with its faces
LEAST_GAP = 1e-6  # m, tolerance of an edge at the least
CORNERS = (0.0, 3e-4, 1e-3, 3e-3, 1e-2)  # m, tolerances of corners, of which the first that will do is taken
SLACK = 1.2  # of a tolerance over the largest gap that was found


@dataclass(frozen=True, eq=False)
class Sheet:
    """Faces with common edges.

    shell: of all faces, turned to the room. faces: each with the region it is of. surfaces: of the faces, in the
    vault's frame. gap: the largest between an edge and one of its faces [m], which is the tolerance of that edge.
    valid: whether OpenCASCADE finds no fault. watertight: whether only the outline's border is free.
    """

    shell: TopoDS_Shell
    faces: tuple[tuple[TopoDS_Face, int], ...]
    surfaces: tuple[SplineSurface, ...]
    gap: float
    valid: bool
    watertight: bool


def sheet_of(form: FreeForm) -> Sheet:
    """The sheet of free surfaces."""
    from OCP.BRep import BRep_Builder
    from OCP.TopAbs import TopAbs_FORWARD, TopAbs_REVERSED
    from OCP.TopoDS import TopoDS, TopoDS_Face, TopoDS_Shell, TopoDS_Wire

    maker = _Maker(form)
    builder = BRep_Builder()
    shell = TopoDS_Shell()
    builder.MakeShell(shell)
    faces: list[tuple[TopoDS_Face, int]] = []
    for k, face in enumerate(form.outline.faces):
        shape = TopoDS_Face()
        builder.MakeFace(shape, maker.geometry[k], LEAST_GAP * MM)
        loops = maker.turned(k)
        for loop in loops:
            wire = TopoDS_Wire()
            builder.MakeWire(wire)
            for edge, forward in loop:
                builder.Add(wire, maker.edges[edge].Oriented(TopAbs_FORWARD if forward else TopAbs_REVERSED))
            wire.Closed(True)
            builder.Add(shape, wire)
        turned = TopoDS.Face_s(shape.Reversed()) if maker.outwards(k) else shape
        builder.Add(shell, turned)
        faces.append((turned, face.field))
    return Sheet(shell, tuple(faces), tuple(maker.surfaces), maker.gap, _made_valid(shell), _is_watertight(form, shell))


def _made_valid(shell: TopoDS_Shell) -> bool:
    """Whether OpenCASCADE finds no fault, once its corners have tolerances as large as they need.

    Where a groin leaves a corner tangent to the arch on the wall, both all but coincide beyond the corner.
    """
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.ShapeFix import ShapeFix_ShapeTolerance
    from OCP.TopAbs import TopAbs_VERTEX

    for tolerance in CORNERS:
        if tolerance:
            ShapeFix_ShapeTolerance().LimitTolerance(shell, tolerance * MM, 0.0, TopAbs_VERTEX)
        if BRepCheck_Analyzer(shell, True, True).IsValid():
            return True
    return False


def _is_watertight(form: FreeForm, shell: TopoDS_Shell) -> bool:
    """Whether as many edges as the outline has between faces have two of them, and only its border has one."""
    from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE
    from OCP.TopExp import TopExp
    from OCP.TopTools import TopTools_IndexedDataMapOfShapeListOfShape

    table = TopTools_IndexedDataMapOfShapeListOfShape()
    TopExp.MapShapesAndAncestors_s(shell, TopAbs_EDGE, TopAbs_FACE, table)
    found = sorted(table.FindFromIndex(k).Size() for k in range(1, table.Extent() + 1))
    return found == sorted(len(edge.sides) for edge in form.outline.edges)


class _Maker:
    """Makes surfaces, then vertices and edges with their curves on the surfaces."""

    def __init__(self, form: FreeForm) -> None:
        from families.solid.occ.splines import bspline_surface

        self.form, self.gap = form, 0.0
        self.on_face = [self._charted(face, form) for face in form.outline.faces]
        self.surfaces = [
            spline_surface(form.surfaces[face.field], *_window(rows))
            for face, rows in zip(form.outline.faces, self.on_face, strict=True)
        ]
        # Parameters [mm], too, so that they run about as fast as places.
        self.geometry = [
            bspline_surface(surface.knots_u * MM, surface.knots_v * MM, surface.points * MM, DEGREE)
            for surface in self.surfaces
        ]
        self.vertices = self._vertices()
        self.edges = [self._edge(k, edge) for k, edge in enumerate(form.outline.edges)]

    @staticmethod
    def _charted(face: Face, form: FreeForm) -> dict[int, Array]:
        """The nodes of a face's edges in its chart, (n, 2) an edge, without a leap where the chart closes."""
        outline, chart = form.outline, form.surfaces[face.field].chart
        found: dict[int, Array] = {}
        centre: float | None = None
        for edge, _ in (step for loop in face.loops for step in loop):
            u, v, _ = chart.chart(outline.nodes[list(outline.edges[edge].nodes)])
            if chart.turn:
                u = np.unwrap(u, period=chart.turn)
                if centre is None:
                    centre = float(u.mean())
                u = u - chart.turn * np.round((u.mean() - centre) / chart.turn)
            found[edge] = np.column_stack([u, v])
        return found

    def turned(self, k: int) -> list[list[tuple[int, bool]]]:
        """The loops of a face, the outer one counterclockwise on its surface."""
        face, rows = self.form.outline.faces[k], self.on_face[k]

        def ring(loop: tuple[tuple[int, bool], ...]) -> Array:
            return np.concatenate([rows[edge][:-1] if forward else rows[edge][:0:-1] for edge, forward in loop])

        loops = [list(loop) for loop in face.loops]
        if _area(ring(face.loops[0])) < 0:
            loops = [[(edge, not forward) for edge, forward in reversed(loop)] for loop in loops]
        return loops

    def outwards(self, k: int) -> bool:
        """Whether the normal of a face's surface points into the stone."""
        rows = np.concatenate(list(self.on_face[k].values()))
        middle = rows.mean(axis=0, keepdims=True)
        step = np.array([[0, 0], [1e-4, 0], [0, 1e-4]])
        a, b, c = self.surfaces[k](*(middle + step).T)
        form = self.form
        return float(np.cross(b - a, c - a) @ form.surfaces[form.outline.faces[k].field].off(a[None])[1][0]) > 0

    def _vertices(self) -> list[Any]:
        from OCP.BRep import BRep_Builder
        from OCP.gp import gp_Pnt
        from OCP.TopoDS import TopoDS_Vertex

        found = []
        for place in self.form.outline.nodes[: self.form.outline.corners] * MM:
            vertex = TopoDS_Vertex()
            BRep_Builder().MakeVertex(vertex, gp_Pnt(*place.tolist()), LEAST_GAP * MM)
            found.append(vertex)
        return found

    def _edge(self, k: int, edge: Edge) -> TopoDS_Edge:
        """An edge through its nodes, with its curve on each face."""
        from OCP.BRep import BRep_Builder
        from OCP.Geom import Geom_BSplineCurve
        from OCP.Geom2d import Geom2d_BSplineCurve
        from OCP.gp import gp_Pnt, gp_Pnt2d
        from OCP.TColgp import TColgp_Array1OfPnt, TColgp_Array1OfPnt2d
        from OCP.TopAbs import TopAbs_FORWARD, TopAbs_REVERSED
        from OCP.TopLoc import TopLoc_Location
        from OCP.TopoDS import TopoDS_Edge

        from families.solid.occ.splines import spline_data

        builder = BRep_Builder()
        nodes = self.form.outline.nodes[list(edge.nodes)]
        t = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(nodes, axis=0), axis=1))])
        curve = make_interp_spline(t, nodes, DEGREE)
        shape = TopoDS_Edge()
        geometry = Geom_BSplineCurve(*spline_data(curve.t * MM, curve.c * MM, DEGREE, TColgp_Array1OfPnt, gp_Pnt))
        gap = LEAST_GAP
        traces = []
        fine = np.interp(np.arange(0, BETWEEN * (len(t) - 1) + 1) / BETWEEN, np.arange(len(t)), t)
        for face, _ in edge.sides:
            trace = make_interp_spline(t, self.on_face[face][k], DEGREE)
            there = self.surfaces[face](*trace(fine).T)
            gap = max(gap, float(np.linalg.norm(there - curve(fine), axis=1).max()))
            flat = spline_data(trace.t * MM, trace.c * MM, DEGREE, TColgp_Array1OfPnt2d, gp_Pnt2d)
            traces.append((face, Geom2d_BSplineCurve(*flat)))
        self.gap = max(self.gap, gap)
        tolerance = SLACK * gap * MM
        builder.MakeEdge(shape, geometry, tolerance)
        for end, way in ((edge.nodes[0], TopAbs_FORWARD), (edge.nodes[-1], TopAbs_REVERSED)):
            builder.Add(shape, self.vertices[end].Oriented(way))
            builder.UpdateVertex(self.vertices[end], SLACK * tolerance)
        builder.Range(shape, 0.0, float(t[-1]) * MM)
        for face, flat in traces:
            builder.UpdateEdge(shape, flat, self.geometry[face], TopLoc_Location(), tolerance)
        builder.SameParameter(shape, True)
        builder.SameRange(shape, True)
        return shape


def _window(rows: dict[int, Array]) -> tuple[Array, Array]:
    places = np.concatenate(list(rows.values()))
    return places.min(axis=0) - MARGIN, places.max(axis=0) + MARGIN


def _area(ring: Array) -> float:
    x, y = ring.T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2
