"""How a vault shows itself in a notebook: sections and a table of sizes, and a 3D view where plotly is installed.

The view goes along as plotly's own figure (application/vnd.plotly.v1+json): JupyterLab and VS Code draw it if they can,
and the page in HTML otherwise.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache
from html import escape
from importlib.util import find_spec
from math import degrees
from typing import Any

import numpy as np
from numpy.typing import NDArray

from families.declaration.palette import colour
from families.declaration.parameters import derived_declarations
from families.declaration.vault import IDENTITY, Vault
from families.drawing.section import PLANES, section
from families.drawing.svg import svg
from families.solid.mesh import Mesh, mesh

Floats = NDArray[np.float64]
Row = tuple[str, str, str]  # name, value, meaning
Trace = dict[str, Any]

HTML, PLOTLY = "text/html", "application/vnd.plotly.v1+json"
SECTION_WIDTH = 360.0  # of the wider section, in pixels
TOLERANCE = 0.01  # [m] between the triangles of the view and the surface
DECIMALS = 4  # of a metre in the view
CAMERA = {"eye": {"x": 1.3, "y": -1.5, "z": 0.6}}


def bundle(vault: Vault) -> dict[str, Any]:
    """What a vault shows, by MIME type."""
    rows = sizes(vault)
    page = titled(vault.title.capitalize(), sections(vault) + table(rows))
    return mime_bundle(page, lambda: surfaces(vault, IDENTITY), rows)


def mime_bundle(page: str, traces: Callable[[], Sequence[Trace]], rows: Iterable[Sequence[str]]) -> dict[str, Any]:
    """A page in HTML, with plotly's figure of traces and rows beside it where that can be drawn and there is any."""
    drawn = traces() if find_spec("plotly") is not None else []
    return {HTML: page} | ({PLOTLY: figure(drawn, rows)} if drawn else {})


def sizes(vault: Vault) -> list[Row]:
    """Profiles, parameters and derived sizes in units that people read."""
    kinds = [(name, kind, "kind of arch") for name, kind in vault.kinds.items()]
    values, derived = vault.values(), derived_declarations(type(vault))
    given = [(p.name, told(values[p.name], p.range.unit), p.range.meaning) for p in vault.parameters()]
    follow = [(name, told(v, derived[name].unit), derived[name].meaning) for name, v in vault.derived_values().items()]
    return kinds + given + follow


def told(value: float, unit: str) -> str:
    """A number with its unit: metres, degrees, or none."""
    return {"m": f"{value:.3f} m", "rad": f"{degrees(value):.2f}°", "1": f"{value:.4g}"}[unit]


def titled(title: str, inside: str) -> str:
    """A block of a page under its title."""
    return f'<div style="max-width:900px"><b style="font-size:1.2em">{escape(title)}</b><br>{inside}</div>'


def table(rows: Iterable[Sequence[str]]) -> str:
    """Rows of a name, values and a meaning."""

    def cells(row: Sequence[str]) -> str:
        name, *values, meaning = map(escape, row)
        middle = "".join(f'<td style="text-align:right;padding-right:1em">{value}</td>' for value in values)
        return (
            f'<td style="text-align:left;padding-right:1em"><b>{name.replace("_", " ")}</b></td>{middle}'
            f'<td style="text-align:left">{meaning}</td>'
        )

    return f"<table>{''.join(f'<tr>{cells(row)}</tr>' for row in rows)}</table>"


def sections(vault: Vault, points: Floats | None = None) -> str:
    """Both sections through the middle as SVG, at one scale; the points (n, 3) [m] in the vault's frame near them."""
    drawings = [section(vault, plane, points) for plane in PLANES]
    scale = SECTION_WIDTH / max(drawing.size[0] for drawing in drawings)
    return "".join(svg(drawing, scale) for drawing in drawings)


@lru_cache(maxsize=8)
def triangles(vault: Vault) -> Mesh | None:
    """The intrados as triangles; None where OpenCASCADE cannot build it."""
    try:
        return mesh(vault, TOLERANCE)
    except ValueError:
        return None


def surfaces(vault: Vault, placement: Floats) -> list[Trace]:
    """The components as plotly's traces, brought by a placement (3, 4) to where they stand; none if not built."""
    shape = triangles(vault)
    if shape is None:
        return []
    points = shape.vertices @ placement[:, :3].T + placement[:, 3]
    traces: list[Trace] = []
    for k, name in enumerate(vault.components, 1):
        own = shape.triangles[shape.component == k]
        used, index = np.unique(own, return_inverse=True)
        corners = index.reshape(-1, 3)
        traces.append(
            {
                "type": "mesh3d",
                "name": name.replace("_", " "),
                "showlegend": True,
                "color": colour(k).hex,
                "flatshading": True,
                "hoverinfo": "name",
            }
            | {axis: points[used, c].round(DECIMALS).tolist() for c, axis in enumerate("xyz")}
            | {axis: corners[:, c].tolist() for c, axis in enumerate("ijk")}
        )
    return traces


def figure(traces: Sequence[Trace], rows: Iterable[Sequence[str]]) -> dict[str, Any]:
    """Plotly's figure of traces in space beside a table of rows without their meanings."""
    columns = [list(column) for column in zip(*(row[:-1] for row in rows), strict=True)]
    columns[0] = [name.replace("_", " ") for name in columns[0]]
    words = {
        "type": "table",
        "domain": {"x": [0.62, 1.0], "y": [0.0, 0.92]},  # below the view's buttons
        "columnwidth": [1.3, *[1.0] * (len(columns) - 1)],
        "header": {"values": [""] * len(columns), "height": 0},
        "cells": {
            "values": columns,
            "align": ["left", *["right"] * (len(columns) - 1)],
            "height": 22,
            "font": {"size": 11},
        },
    }
    bare = {"visible": False}
    layout = {
        "scene": {
            "domain": {"x": [0.0, 0.6], "y": [0.0, 1.0]},
            "aspectmode": "data",
            "camera": CAMERA,
            **dict.fromkeys(("xaxis", "yaxis", "zaxis"), bare),
        },
        "legend": {"x": 0.0, "y": 1.0},
        "margin": dict.fromkeys("lrtb", 10),
        "height": 460,
    }
    return {"data": [*traces, words], "layout": layout}
