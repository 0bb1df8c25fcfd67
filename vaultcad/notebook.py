"""How a fit shows itself in a notebook: sections, sizes with their standard deviations, deviations in a 3D view.

The view is there where plotly is installed, as for the families.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from families.drawing.deviation_colours import ROOM, STONE, STOPS, limit_of
from families.drawing.svg import svg
from families.notebook import Trace, mime_bundle, sections, surfaces, table, titled
from vaultcad.export.building_plan import building_plans
from vaultcad.export.report_json import in_shown_unit
from vaultcad.model import FittedVault, Model
from vaultcad.uncertain import Estimate

if TYPE_CHECKING:
    from vaultcad.pipeline import Result

Floats = NDArray[np.float64]
Row = tuple[str, str, str, str]  # name, value, standard deviation, meaning

VIEW_POINTS = 6000  # points in the 3D view
PLAN_WIDTH = 560.0  # of the plan of a building, in pixels
# By its name plotly draws a scale one way round in Python and the other way round in a browser.
COLOURS = [[(1 + share) / 2, colour.hex] for share, colour in STOPS]


def of_fitted(fitted: FittedVault) -> dict[str, Any]:
    """What one fitted vault shows, by MIME type; the view in its own frame."""
    return mime_bundle(_page(fitted, "", None), lambda: surfaces(fitted.vault, np.eye(3, 4)), _rows(fitted))


def of_model(model: Model, points: Floats | None = None, traces: Sequence[Trace] = ()) -> dict[str, Any]:
    """What a model shows: a plan if it is a building, each vault and arch after the other, all in one view.

    The view is in the scan's local frame; `points` (n, 3) [m] of the scan in that frame go into the sections, further
    `traces` into the view.
    """
    several = len(model.vaults) > 1
    plans = "".join(svg(drawing, PLAN_WIDTH / drawing.size[0]) for drawing in building_plans(model)) if several else ""
    numbers = [f"{k}  " if several else "" for k in range(1, len(model.vaults) + 1)]
    pages = "".join(_page(fitted, number, points) for fitted, number in zip(model.vaults, numbers, strict=True))
    head = f"{model.scan.name}: {model.points:,} points, {len(model.vaults)} vault{'s' * several}"
    head += f", {len(model.arches)} arch{'es' * (len(model.arches) > 1)}" if model.arches else ""

    def drawn() -> list[Trace]:
        found = [surfaces(placed.vault, placed.pose.placement()[:3]) for placed in (*model.vaults, *model.arches)]
        return [*(trace for own in found for trace in own), *traces] if all(found) else []

    rows = [(number + row[0], *row[1:]) for number, f in zip(numbers, model.vaults, strict=True) for row in _rows(f)]
    for k, arch in enumerate(model.arches, 1):
        rows += [(f"arch {k}  {row[0]}", *row[1:]) for row in _rows(arch)]
    return mime_bundle(titled(head, plans + pages + _arches(model)), drawn, rows)


def _arches(model: Model) -> str:
    """Each arch with its rows."""
    return "".join(
        titled(f"arch {k}: {arch.arches['profile']}", table(_rows(arch))) for k, arch in enumerate(model.arches, 1)
    )


def of_result(result: Result) -> dict[str, Any]:
    """What a fitted scan shows: its model with the scan's points on it, coloured by their deviation."""
    return of_model(result.model, result.points, [_deviations(result)])


def _deviations(result: Result) -> Trace:
    on = np.flatnonzero((result.component > 0) & np.isfinite(result.deviation))
    on = on[:: max(1, -(-len(on) // VIEW_POINTS))]
    points, d = result.points[on], 1000 * result.deviation[on]
    reach = 1000 * limit_of(result.deviation[on])
    return {
        "type": "scatter3d",
        "mode": "markers",
        "name": "deviation, mm",
        "showlegend": True,
        "hoverinfo": "text",
        "text": [f"{value:+.1f} mm" for value in d],
        "marker": {
            "size": 2,
            "color": d.round(1).tolist(),
            "colorscale": COLOURS,
            "cmin": -reach,
            "cmax": reach,
            "colorbar": {"title": {"text": f"mm<br>+ {STONE}<br>− {ROOM}"}, "x": 0.54, "len": 0.6, "thickness": 12},
        },
    } | {axis: points[:, c].round(3).tolist() for c, axis in enumerate("xyz")}


def _page(fitted: FittedVault, number: str, points: Floats | None) -> str:
    frame, d = fitted.pose.frame(), fitted.deviation
    local = None if points is None else points @ frame[:, :3].T + frame[:, 3]
    title = f"{number}{fitted.vault.title.capitalize()}, confidence {fitted.confidence:.0%}"
    line = f"deviation rms {1000 * d.rms:.1f} mm, 95 % below {1000 * d.p95:.1f} mm, {d.loa}; {fitted.coverage:.0%} seen"
    if not fitted.converged:
        line += "; the fit had not come to rest: take the figures with care"
    return titled(title, f"<p>{line}</p>{sections(fitted.vault, local)}{table(_rows(fitted))}")


def _rows(fitted: FittedVault) -> list[Row]:
    kinds = [(name, kind, "", "kind of arch") for name, kind in fitted.arches.items()]
    return kinds + [(name, *_told(in_shown_unit(e)), e.meaning) for name, e in fitted.parameters.items()]


def _told(e: Estimate) -> tuple[str, str]:
    """Value and standard deviation of an estimate in readable units."""
    value, std = {
        "m": (f"{e.value:.3f} m", f"± {1000 * (e.std or 0):.1f} mm"),
        "deg": (f"{e.value:.2f}°", f"± {e.std or 0:.2f}°"),
    }.get(e.unit, (f"{e.value:.4g}", f"± {e.std or 0:.2g}"))
    return value, " ".join([std if e.std else "", *e.flags]).strip()
