"""The deviations of a vault in report.html: its models side by side, whole and by component."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from math import isfinite

from vaultcad.export.page import html_table, percent
from vaultcad.measure.deviation import LIMITS
from vaultcad.measure.routes import routes
from vaultcad.model import Component, FittedVault
from vaultcad.uncertain import Deviation

ROUTES = {"ideal": "ideal model", "as_built": "as-built surface", "nurbs": "free surfaces"}
"""What people call the models of a vault, by the names of `routes`."""
WHOLE = "all"


def routes_table(fitted: FittedVault) -> str:
    """Distances of the points to each model, of the whole vault and, where it has several, of each component."""
    head = ["component", "distance to the", "mean", "mean of |d|", "RMS", "median", "95 %", "max"]
    head += [f"within {100 * limit:g} cm" for limit in LIMITS] + ["LOA"]
    rows = list(_rows(WHOLE, fitted))
    if len(fitted.components) > 1:
        rows += [row for component in fitted.components for row in _rows(component.name.replace("_", " "), component)]
    return html_table(head, rows, numbers=slice(2, 8), long=(0, 1))


def _rows(name: str, measured: FittedVault | Component) -> Iterator[list[str]]:
    for route, d in routes(measured).items():
        yield [escape(name), escape(ROUTES.get(route, route)), *_lengths(d), *_shares(d), escape(d.loa)]
        name = ""


def _lengths(d: Deviation) -> Iterator[str]:
    for value in (d.signed_mean, d.mean, d.rms, d.median, d.p95, d.max):
        yield f"{1000 * value:.1f} mm" if isfinite(value) else "–"


def _shares(d: Deviation) -> Iterator[str]:
    for limit in LIMITS:
        value = d.within.get(limit, 0.0)
        yield f'<span class="bar" style="width:{3.2 * value:.2f}em"></span> {percent(value)}'
