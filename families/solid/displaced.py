"""A body [mm] moved by a smooth displacement of space: the same faces, edges and vertices, drawn as splines.

Edges are drawn once and shared, and faces keep their boundaries in their own parameters: what was closed stays closed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepTools import BRepTools
from OCP.Geom import Geom_BSplineCurve, Geom_BSplineSurface, Geom_Curve, Geom_Surface
from OCP.GeomAbs import GeomAbs_C2
from OCP.GeomAdaptor import GeomAdaptor_Surface
from OCP.gp import gp_Pnt, gp_Pnt2d
from OCP.TColgp import TColgp_Array1OfPnt
from OCP.TColStd import TColStd_Array1OfReal
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FORWARD, TopAbs_SOLID, TopAbs_VERTEX
from OCP.TopExp import TopExp
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import (
    TopoDS,
    TopoDS_Edge,
    TopoDS_Face,
    TopoDS_Iterator,
    TopoDS_Shape,
    TopoDS_Shell,
    TopoDS_Solid,
    TopoDS_Vertex,
    TopoDS_Wire,
)
from OCP.TopTools import TopTools_IndexedMapOfShape

from families.declaration.units import MM
from families.solid.curves import shares
from families.solid.occ.shapes import is_sound, together
from families.solid.occ.splines import bspline_surface, spline_data
from families.solid.splines import DEGREE, evaluated, interpolated

Array = NDArray[np.float64]
Field = Callable[[Array], Array]

ACCURACY = 2e-3  # [mm] to which curves and surfaces are drawn
FEWEST, MOST = 8, 90  # places of a smooth stretch through which it is drawn
GROWTH = 1.5  # of their number, until that is exact enough
LOOKS = 41  # places along an edge at which it is compared with its faces
LEAST = 1e-3  # [mm], tolerance of edges
SLACK = 2.0  # of a tolerance over the gap that was measured, which may be wider in between
HERE = TopLoc_Location()
BUILDER = BRep_Builder()


def displaced(shape: TopoDS_Shape, displacement: Field) -> TopoDS_Shape:
    """A body [mm] moved by a displacement: a function of points (n, 3) [m] that gives displacements (n, 3) [m].

    Its faces, in the order of those of `shape`, are B-spline surfaces that are not rational, its edges B-spline curves.

    Raises:
        ValueError: OpenCASCADE finds a fault in it; a displacement that folds it is not always found to.
    """
    whole = _Moved(shape, lambda points: points + MM * displacement(points / MM)).whole()
    if not is_sound(whole):
        raise ValueError("OpenCASCADE finds a fault in the displaced body of this vault")
    return whole


class _Moved:
    """The vertices and edges of a body [mm] where they are moved to, each made once."""

    def __init__(self, shape: TopoDS_Shape, move: Field) -> None:
        self.shape, self.move = shape, move
        self.places, self.edges = _each(shape, TopAbs_VERTEX), _each(shape, TopAbs_EDGE)
        self.made_places = [
            self._vertex(TopoDS.Vertex_s(self.places.FindKey(k + 1))) for k in range(self.places.Size())
        ]
        self.made_edges = [self._edge(TopoDS.Edge_s(self.edges.FindKey(k + 1))) for k in range(self.edges.Size())]

    def whole(self) -> TopoDS_Shape:
        """A compound of its solids."""
        solids = _each(self.shape, TopAbs_SOLID)
        return together(self._solid(solids.FindKey(k + 1)) for k in range(solids.Size()))

    def _solid(self, solid: TopoDS_Shape) -> TopoDS_Solid:
        made = TopoDS_Solid()
        BUILDER.MakeSolid(made)
        for shell in _inside(solid):
            shown = TopoDS_Shell()
            BUILDER.MakeShell(shown)
            for face in _inside(shell):
                BUILDER.Add(shown, self._face(TopoDS.Face_s(face)))
            shown.Closed(shell.Closed())
            BUILDER.Add(made, shown.Oriented(shell.Orientation()))
        return made

    def _vertex(self, vertex: TopoDS_Vertex) -> TopoDS_Vertex:
        made, (point,) = TopoDS_Vertex(), self.move(np.array([_xyz(BRep_Tool.Pnt_s(vertex))]))
        BUILDER.MakeVertex(made, gp_Pnt(*point.tolist()), 2 * max(BRep_Tool.Tolerance_s(vertex), LEAST))
        return made

    def _edge(self, edge: TopoDS_Edge) -> TopoDS_Edge:
        made = TopoDS_Edge()
        if BRep_Tool.Degenerated_s(edge):
            BUILDER.MakeEdge(made)
        else:
            BUILDER.MakeEdge(made, self._curve(BRepAdaptor_Curve(edge)), LEAST)
        for vertex in _inside(edge.Oriented(TopAbs_FORWARD)):
            BUILDER.Add(made, self.made_places[self.places.FindIndex(vertex) - 1].Oriented(vertex.Orientation()))
        BUILDER.Range(made, *BRep_Tool.Range_s(edge))
        BUILDER.Degenerated(made, BRep_Tool.Degenerated_s(edge))
        return made

    def _curve(self, curve: BRepAdaptor_Curve) -> Geom_Curve:
        def at(t: Array) -> Array:
            return self.move(np.array([_xyz(curve.Value(value)) for value in t.tolist()]))

        breaks = _breaks(curve.NbIntervals, curve.Intervals)
        count = FEWEST
        while True:
            nodes = _nodes(breaks, count)
            knots, poles = _laid(nodes, at(np.unique(nodes)))
            between = _between(nodes)
            if count >= MOST or np.abs(evaluated(knots, poles, between) - at(between)).max() < ACCURACY:
                return Geom_BSplineCurve(*spline_data(knots, poles, DEGREE, TColgp_Array1OfPnt, gp_Pnt))
            count = ceil(GROWTH * count)

    def _face(self, face: TopoDS_Face) -> TopoDS_Face:
        made, bare = TopoDS_Face(), TopoDS.Face_s(face.Oriented(TopAbs_FORWARD))
        surface = self._surface(bare)
        BUILDER.MakeFace(made, surface, HERE, LEAST)
        for loop in _inside(bare):
            wire = TopoDS_Wire()
            BUILDER.MakeWire(wire)
            for edge in _inside(loop):
                shown = self.made_edges[self.edges.FindIndex(edge) - 1]
                self._lay(TopoDS.Edge_s(edge), shown, bare, surface)
                BUILDER.Add(wire, shown.Oriented(edge.Orientation()))
            wire.Closed(loop.Closed())
            BUILDER.Add(made, wire.Oriented(loop.Orientation()))
        return TopoDS.Face_s(made.Oriented(face.Orientation()))

    def _lay(self, edge: TopoDS_Edge, made: TopoDS_Edge, face: TopoDS_Face, surface: Geom_Surface) -> None:
        """Enter where an edge runs on a face, and widen its tolerance to what they are apart."""
        first, last = BRep_Tool.Range_s(edge, face)
        curve = BRep_Tool.CurveOnSurface_s(edge, face, first, last)
        gap = 0.0
        if not BRep_Tool.Degenerated_s(edge):
            space = BRep_Tool.Curve_s(made, first, last)
            for t in np.linspace(first, last, LOOKS).tolist():
                gap = max(gap, space.Value(t).Distance(surface.Value(*_uv(curve.Value(t)))))
        tolerance = max(LEAST, SLACK * gap)
        BUILDER.UpdateEdge(made, curve, surface, HERE, tolerance)
        BUILDER.Range(made, surface, HERE, first, last)
        for vertex in _inside(made):
            BUILDER.UpdateVertex(TopoDS.Vertex_s(vertex), 2 * tolerance)

    def _surface(self, face: TopoDS_Face) -> Geom_BSplineSurface:
        """Over what the face takes of the surface's parameters."""
        surface = BRep_Tool.Surface_s(face)
        low, high = np.reshape(BRepTools.UVBounds_s(face), (2, 2)).T
        # At poles it must end where the surface does; what is periodic has no end.
        ends = np.reshape(surface.Bounds(), (2, 2)).T
        ends[:, [surface.IsUPeriodic(), surface.IsVPeriodic()]] = [[-np.inf], [np.inf]]
        low, high = np.maximum(low, ends[0]), np.minimum(high, ends[1])
        adaptor = GeomAdaptor_Surface(surface, low[0], high[0], low[1], high[1])

        def at(u: Array, v: Array) -> Array:
            rows, columns = u.tolist(), v.tolist()
            points = np.array([_xyz(surface.Value(a, b)) for a in rows for b in columns])
            return self.move(points).reshape(len(u), len(v), 3)

        breaks = _breaks(adaptor.NbUIntervals, adaptor.UIntervals), _breaks(adaptor.NbVIntervals, adaptor.VIntervals)
        (along_u, along_v), poles = _net(at, breaks)
        return bspline_surface(along_u, along_v, poles, DEGREE)


def _net(at: Callable[[Array, Array], Array], breaks: tuple[Array, Array]) -> tuple[tuple[Array, Array], Array]:
    """Knots along u and v, and poles (nu, nv, 3), of a surface: `at` gives its points (nu, nv, 3) over a grid."""
    counts = [FEWEST, FEWEST]
    while True:
        nodes = [_nodes(stretch, count) for stretch, count in zip(breaks, counts, strict=True)]
        u, v = map(np.unique, nodes)
        points = at(u, v)
        knots_u, rows = _laid(nodes[0], points.reshape(len(u), -1))
        knots_v, columns = _laid(nodes[1], points.swapaxes(0, 1).reshape(len(v), -1))
        past_u, past_v = _between(nodes[0]), _between(nodes[1])
        off_u = evaluated(knots_u, rows, past_u) - at(past_u, v).reshape(len(past_u), -1)
        off_v = evaluated(knots_v, columns, past_v) - at(u, past_v).swapaxes(0, 1).reshape(len(past_v), -1)
        rough = [
            np.abs(off).max() > ACCURACY and count < MOST for off, count in zip((off_u, off_v), counts, strict=True)
        ]
        if not any(rough):
            across = rows.reshape(-1, len(v), 3).swapaxes(0, 1)
            _, poles = _laid(nodes[1], across.reshape(len(v), -1))
            return (knots_u, knots_v), poles.reshape(len(poles), -1, 3).swapaxes(0, 1)
        counts = [ceil(GROWTH * count) if more else count for count, more in zip(counts, rough, strict=True)]


def _breaks(count: Callable[[Any], int], intervals: Callable[[TColStd_Array1OfReal, Any], None]) -> Array:
    """Parameters from the first to the last between which a curve, or a surface one way, is smooth."""
    last = count(GeomAbs_C2) + 1
    ends = TColStd_Array1OfReal(1, last)
    intervals(ends, GeomAbs_C2)
    return np.array([ends.Value(k) for k in range(1, last + 1)])  # to iterate over it takes 100 times as long


def _nodes(breaks: Array, count: int) -> Array:
    """Parameters (k, `count`) of each smooth stretch, the denser towards its ends, where splines are less accurate."""
    at = (np.linspace(0, 1, count) + shares(count)) / 2
    nodes = breaks[:-1, None] + np.diff(breaks)[:, None] * at
    nodes[:, -1] = breaks[1:]
    return nodes


def _between(nodes: Array) -> Array:
    """Parameters halfway between those of each stretch."""
    return ((nodes[:, 1:] + nodes[:, :-1]) / 2).ravel()


def _laid(nodes: Array, values: Array) -> tuple[Array, Array]:
    """Knots and poles (n, k) of the spline with values (m, k) at nodes, as smooth as need be where stretches meet."""
    count = nodes.shape[1]
    knots, poles = [], []
    for k, row in enumerate(nodes):
        own, found = interpolated(row, np.ascontiguousarray(values[k * (count - 1) : (k + 1) * (count - 1) + 1]))
        last = k == len(nodes) - 1
        knots.append(own[DEGREE + 1 if k else 0 : None if last else -1])  # one less where two meet than at an end
        poles.append(found[1 if k else 0 :])
    return np.concatenate(knots), np.concatenate(poles)


def _each(shape: TopoDS_Shape, kind: Any) -> TopTools_IndexedMapOfShape:
    """The vertices, or edges, of a shape, each once."""
    found = TopTools_IndexedMapOfShape()
    TopExp.MapShapes_s(shape, kind, found)
    return found


def _inside(shape: TopoDS_Shape) -> Iterator[TopoDS_Shape]:
    """What a shape is put together of, with its orientation in there."""
    parts = TopoDS_Iterator(shape, False)  # not turned by the whole
    while parts.More():
        yield parts.Value()
        parts.Next()


def _uv(point: gp_Pnt2d) -> tuple[float, float]:
    return point.X(), point.Y()


def _xyz(point: gp_Pnt) -> tuple[float, float, float]:
    return point.X(), point.Y(), point.Z()
