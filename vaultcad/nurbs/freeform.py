"""The free-form route: from the labelled points of a vault to one watertight sheet of free surfaces."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from families import Vault
from vaultcad.errors import NoSurfaceError
from vaultcad.nurbs.charts import Chart
from vaultcad.nurbs.cusps import alike, kept_apart
from vaultcad.nurbs.field import Cells, Domain, fitted
from vaultcad.nurbs.meeting import FreeSurface, crossing, met
from vaultcad.nurbs.outline import Outline
from vaultcad.nurbs.outline_reader import outline_of

Array = NDArray[np.float64]
BESIDE = 0.03  # m, about edges between components: whose points these are is not known
BEYOND = 0.15  # m, by which surfaces run on past their outline
KNOWN = 0.12  # m, from the nearest points, within which a surface is known
FEW = 30  # cells, below which a region was not seen
NEAREST = 0.08  # m, about edges: distances of points there are to the nearer of the surfaces


@dataclass(frozen=True, eq=False)
class FreeForm:
    """Free surfaces of one vault in its frame.

    outline: its net, whose nodes are where they meet. surfaces: one a region. crossing: of each edge the share of its
    nodes at which the surfaces cross at an angle; elsewhere they were led through a common edge. unseen: regions, by
    their index, without points, whose surface follows from its edges alone.
    """

    vault: Vault
    outline: Outline
    surfaces: tuple[FreeSurface, ...]
    crossing: tuple[float, ...]
    unseen: tuple[int, ...]
    led: bool = False  # whether all edges are common ones through which surfaces were led

    @property
    def gaps(self) -> Array:
        """Of each node how far it is off the farthest of its surfaces (n,) [m]."""
        found = np.zeros(len(self.outline.nodes))
        for surface, mine in zip(self.surfaces, self.outline.of_region, strict=True):
            found[mine] = np.maximum(found[mine], np.abs(surface.off(self.outline.nodes[mine])[0]))
        return found

    def distance(self, xyz: Array, component: NDArray[np.integer]) -> Array:
        """Signed distances (n,) [m] of points with their components, positive into the stone."""
        found = np.full(len(xyz), np.nan)
        for k, region in enumerate(self.outline.regions):
            mine = np.flatnonzero(component == region.component)
            off = self.surfaces[k].distance(xyz[mine])
            nearer = ~(np.abs(found[mine]) <= np.abs(off))
            found[mine[nearer]] = off[nearer]
        return self._beside_edges(xyz, component, found)

    def _beside_edges(self, xyz: Array, component: NDArray[np.integer], found: Array) -> Array:
        """Of points near an edge the distance to the nearest of the surfaces that meet there."""
        from scipy.spatial import cKDTree

        outline = self.outline
        shared = [edge for edge in outline.edges if len(edge.sides) == 2]
        if not shared:
            return found
        near = _Near(np.concatenate([outline.nodes[list(edge.nodes)] for edge in shared]), NEAREST)
        which = near.of(xyz)
        for k, surface in enumerate(self.surfaces):
            nodes = {
                n for edge in shared for n in edge.nodes if k in {outline.faces[face].field for face, _ in edge.sides}
            }
            if not nodes:
                continue
            mine = which[component[which] != outline.regions[k].component]
            reach, _ = cKDTree(outline.nodes[sorted(nodes)]).query(xyz[mine], distance_upper_bound=NEAREST)
            mine = mine[np.isfinite(reach)]
            off = surface.distance(xyz[mine])
            nearer = np.abs(off) < np.abs(found[mine])
            found[mine[nearer]] = off[nearer]
        return found


class _Near:
    """Whether points are near some places, by cubes of that size."""

    def __init__(self, places: Array, size: float) -> None:
        self.size, self.low = size, places.min(axis=0) - 2 * size
        shape = np.ceil((places.max(axis=0) + 2 * size - self.low) / size).astype(int) + 1
        self.near = np.zeros(tuple(shape.tolist()), bool)
        cell = ((places - self.low) / size).astype(int)
        for step in np.ndindex(3, 3, 3):
            self.near[tuple((cell + np.array(step) - 1).T)] = True

    def of(self, xyz: Array) -> NDArray[np.int64]:
        """Indices of points that may be."""
        cell = np.floor((xyz - self.low) / self.size).astype(np.int64)
        inside = ((cell >= 0) & (cell < self.near.shape)).all(axis=1)
        at = np.flatnonzero(inside)
        found: NDArray[np.int64] = at[self.near[tuple(cell[at].T)]]
        return found


def free_form(vault: Vault, xyz: Array, component: NDArray[np.integer], *, led: bool = False) -> FreeForm:
    """The free surfaces through points (n, 3) [m] in the vault's frame with their components (n,).

    led: whether surfaces are led through common edges, moved smoothly from the ideal, instead of being intersected.

    Raises:
        NoSurfaceError: OpenCASCADE cannot build the vault's outline, or no component has points.
    """
    outline = outline_of(vault)
    domains = [_domain(outline, k) for k in range(len(outline.regions))]
    cells = _shared_out(outline, xyz, component)
    unseen = tuple(k for k, mine in enumerate(cells) if len(mine.u) < FEW)
    if len(unseen) == len(cells):
        raise NoSurfaceError("no component has points enough for a surface; give a scan with its labels")
    free = [
        FreeSurface(region.chart, fitted(domain, mine))
        for region, domain, mine in zip(outline.regions, domains, cells, strict=True)
    ]
    seen = [
        _seen(region.chart, mine, outline.nodes[of])
        for region, mine, of in zip(outline.regions, cells, outline.of_region, strict=True)
    ]
    nodes = met(outline, free, vault.plan, outline.nodes, seen)
    shares = [
        0.0 if led and len(edge.sides) == 2 else share
        for edge, share in zip(outline.edges, crossing(outline, free, nodes), strict=True)
    ]
    if led:
        nodes = alike(outline, nodes)
    ended = [
        _through(region.chart, domain, mine, nodes[of])
        for region, domain, mine, of in zip(outline.regions, domains, cells, outline.of_region, strict=True)
    ]
    if led:
        return FreeForm(vault, replace(outline, nodes=nodes), tuple(ended), tuple(shares), unseen, led)
    everywhere = [np.ones(len(mine), bool) for mine in outline.of_region]
    nodes = kept_apart(outline, met(outline, ended, vault.plan, nodes, everywhere), tuple(ended))
    return FreeForm(vault, replace(outline, nodes=nodes), tuple(ended), tuple(shares), unseen)


def _seen(chart: Chart, cells: Cells, nodes: Array) -> NDArray[np.bool_]:
    """Whether a surface has points near its nodes (n, 3)."""
    from scipy.spatial import cKDTree

    if len(cells.u) < FEW:
        return np.zeros(len(nodes), bool)
    u, v, _ = chart.chart(nodes)
    tree = cKDTree(np.column_stack([cells.u, cells.v]))
    reach, _ = tree.query(np.column_stack([u, v]), distance_upper_bound=KNOWN)
    return np.isfinite(reach)


def _through(chart: Chart, domain: Domain, cells: Cells, nodes: Array) -> FreeSurface:
    u, v, reach = chart.chart(nodes)
    return FreeSurface(chart, fitted(domain, cells, Cells(u, v, reach, np.ones(len(u)))))


def _domain(outline: Outline, k: int) -> Domain:
    chart = outline.regions[k].chart
    u, v, _ = chart.chart(outline.nodes[outline.of_region[k]])
    low, high = np.array([u.min(), v.min()]) - BEYOND, np.array([u.max(), v.max()]) + BEYOND
    if chart.turn:
        low[0], high[0] = 0.0, chart.turn
    return Domain(low, high, chart.turn)


def _shared_out(outline: Outline, xyz: Array, component: NDArray[np.integer]) -> list[Cells]:
    """The points of each region, over its chart, but for those beside edges to others."""
    from matplotlib.path import Path
    from scipy.spatial import cKDTree

    shared = [edge for edge in outline.edges if len(edge.sides) == 2]
    beside = np.zeros(len(xyz), bool)
    if shared:
        places = np.concatenate([outline.nodes[list(edge.nodes)] for edge in shared])
        which = _Near(places, BESIDE + 0.03).of(xyz)
        reach, _ = cKDTree(places).query(xyz[which], distance_upper_bound=BESIDE)
        beside[which[np.isfinite(reach)]] = True
    alone = {region.component: 0 for region in outline.regions}
    for region in outline.regions:
        alone[region.component] += 1
    found = []
    for k, region in enumerate(outline.regions):
        mine = (component == region.component) & ~beside
        u, v, reach = region.chart.chart(xyz[mine])
        if alone[region.component] > 1:
            inside = np.zeros(len(u), bool)
            for ring in outline.rings(k, outline.nodes):
                a, b, _ = region.chart.chart(ring)
                inside |= Path(np.column_stack([a, b])).contains_points(np.column_stack([u, v]))
            u, v, reach = u[inside], v[inside], reach[inside]
        found.append(Cells.of(u, v, reach) if len(u) else Cells(*(np.empty(0),) * 4))
    return found
