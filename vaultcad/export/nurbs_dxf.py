"""nurbs.dxf: the network of curves of the free surfaces in space, as B-splines: their nets' lines, and their edges."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import Akima1DInterpolator, make_interp_spline

from vaultcad.dxf_document import Layer, add_layers, dxf_document
from vaultcad.export.nurbs_mesh import named_nets
from vaultcad.nurbs.meeting import FreeSurface
from vaultcad.nurbs.net import QuadNet
from vaultcad.nurbs.route import FreeRoute, FreeVault
from vaultcad.nurbs.spline_surface import DEGREE

if TYPE_CHECKING:
    from ezdxf.layouts import Modelspace

Array = NDArray[np.float64]
EDGES = "EDGES"  # layer of the curves in which surfaces meet and end
LINES = {
    "ROWS": Layer(4, "CONTINUOUS", 18),
    "COLUMNS": Layer(5, "CONTINUOUS", 18),
}
"""Of the lines of a net, on layers named after its component too, as `web north-ROWS`."""
BETWEEN = 4  # spans of a curve between two points of a net
SAME = 1e-6  # m, between neighbours on a line that are one


def write_nurbs_dxf(route: FreeRoute, path: Path) -> None:
    """Write a spline for each line of each net and each edge, in metres relative to the model's origin, z up."""
    with dxf_document(path, route.model.place) as document:
        document.layers.add(EDGES, color=1, lineweight=35)
        space = document.modelspace()
        for name, vault, net, _ in named_nets(route):
            prefix = name.replace("/", " ")
            add_layers(document, {f"{prefix}-{kind}": layer for kind, layer in LINES.items()})
            for kind, line in _lines(net, vault.form.surfaces[net.region]):
                _spline(space, _placed(vault, line), f"{prefix}-{kind}")
        for vault in route.vaults:
            outline = vault.form.outline
            for edge in outline.edges:
                _spline(space, _placed(vault, outline.nodes[list(edge.nodes)]), EDGES)


def _placed(vault: FreeVault, line: Array) -> Array:
    place = vault.fitted.pose.placement()
    out: Array = line @ place[:3, :3].T + place[:3, 3]
    return out


def _lines(net: QuadNet, surface: FreeSurface) -> Iterator[tuple[str, Array]]:
    """Both kinds of lines of a net (n, 3), with places of the surface between its points."""
    chart = surface.chart
    for kind, lines in (("ROWS", net.points), ("COLUMNS", net.points.swapaxes(0, 1))):
        for line in lines:
            u, v, _ = chart.chart(line)
            if chart.turn:
                u = np.unwrap(u, period=chart.turn)
            fine = np.linspace(0, len(line) - 1, BETWEEN * (len(line) - 1) + 1)
            # Round as a ring, yet straight up to where a border leaps.
            u, v = Akima1DInterpolator(np.arange(len(line)), np.column_stack([u, v]), method="makima")(fine).T
            yield kind, chart.place(u, v, surface.field(u, v))


def _spline(space: Modelspace, line: Array, layer: str) -> None:
    """An interpolating B-spline, if the line is none but a point."""
    steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    line = line[np.append(True, steps > SAME)]
    if len(line) < 2:
        return
    t = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    curve = make_interp_spline(t, line, min(DEGREE, len(line) - 1))
    spline = space.add_spline(degree=int(curve.k), dxfattribs={"layer": layer})
    spline.control_points, spline.knots = curve.c.tolist(), curve.t.tolist()
