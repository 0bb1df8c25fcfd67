"""report.html: what was found, drawn and explained, in one file that needs nothing from outside.

Scripts do nothing in it but the 3D view, which is unpacked when it is asked for.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from html import escape
from math import degrees
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from families import family
from families.drawing.deviation_colours import CONVENTION
from families.drawing.section import PLANES
from vaultcad.export.charts import histogram
from vaultcad.export.drawing import deviations, plan, section
from vaultcad.export.page import drawn, html_table, metres, percent, std_of, value_of
from vaultcad.export.palette import colour
from vaultcad.export.report_building import building_page
from vaultcad.export.report_deformation import deformation_section
from vaultcad.export.report_json import in_shown_unit, plain
from vaultcad.export.report_routes import routes_table
from vaultcad.export.report_text import FILES, STYLE, TERMS
from vaultcad.export.seen import Seen, seen
from vaultcad.export.unrolled_map import unrolled_map
from vaultcad.export.viewer.embed import viewer_section, viewer_style
from vaultcad.measure.building import building_of
from vaultcad.model import Component, FittedVault, Model
from vaultcad.uncertain import FLAGS, Deviation, Estimate

SHOWN = 0.02  # chance from which on a kind of arch is shown


def write_report_html(
    model: Model,
    path: Path,
    points: NDArray[np.floating] | None = None,
    component: NDArray[np.integer] | None = None,
    deviation: NDArray[np.floating] | None = None,
    vault: NDArray[np.integer] | None = None,
) -> None:
    """Write the report of a model.

    Args:
        model: what was found.
        path: the file.
        points: (n, 3) thinned points of the scan in its local frame [m], shown in the sections.
        component: (n,) their components; where given, only points with one are counted in the histogram.
        deviation: (n,) their signed distances to the model [m], NaN off the vault, for the histogram.
        vault: (n,) number of the vault that each belongs to, 0 for none; without it all belong to the first.
    """
    found = seen(model, points, component, deviation, vault)
    several = len(found) > 1
    building = building_of(model)
    names = [f"{k} · {building.name(k)}: {one.vault.title}" for k, one in enumerate(found, 1)]
    heads = names if several else [found[0].vault.title.capitalize()]
    view = viewer_section(model, names if several else heads, points, component, deviation, vault)
    whole = building_page(model, building, found, view) if several or model.arches else ""
    parts = [_vault(one, model, k, heads[k - 1], view * (not whole)) for k, one in enumerate(found, 1)]
    what = f"{len(found)} vaults" if several else found[0].vault.title
    title = escape(f"{what} · {model.scan.name}")
    head = (
        f'<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{title}</title><style>{STYLE}{viewer_style()}</style>"
    )
    body = whole + "".join(parts) + _notes(model) + _files() + _glossary(model) + _origin(model)
    path.write_text(f'<!doctype html><html lang="en"><head>{head}</head><body>{body}</body></html>\n', encoding="utf-8")


def _vault(one: Seen, model: Model, number: int, head: str, view: str) -> str:
    fitted, vault, d = one.fitted, one.vault, one.fitted.deviation
    across, along = (high - low for low, high in (plane.clear(vault) for plane in PLANES))
    size = f"{across:.2f} × {along:.2f}\u00a0m"
    facts = [
        (size, "plan"),
        (metres(vault.derived_values().get("rise")), "rise"),
        (percent(fitted.confidence), "confidence"),
        (f"{100 * d.p95:.1f} cm", "95 % of the points are nearer"),
        (d.loa, "level of accuracy"),
        (percent(fitted.coverage), "of the surface scanned"),
    ]
    figures = "".join(f"<div><b>{escape(value)}</b><span>{escape(label)}</span></div>" for value, label in facts)
    return (
        f'<header id="vault-{number}"><h1>{escape(head)}</h1>'
        f'<p class="soft">{escape(model.scan.name)} · {model.points:,} points</p></header>'
        f"{_summary(fitted)}"
        f'<div class="figures">{figures}</div>'
        f"{drawn([plan(one), *(section(one, plane) for plane in PLANES)])}{view}"
        f"<section><h2>Deviation</h2>{_deviation(one)}</section>"
        f"{deformation_section(fitted)}"
        f"<section><h2>Sizes and parameters</h2>{_parameters(fitted, model.origin)}</section>"
        f"<section><h2>Components</h2>{_components(fitted.components)}</section>"
    )


def _summary(fitted: FittedVault) -> str:
    d = fitted.deviation
    text = (
        f"A {fitted.vault.title}, found with a confidence of {percent(fitted.confidence)}. The stone is "
        f"{100 * d.mean:.1f} cm from the ideal model on average, and 95 % of it within {100 * d.p95:.1f} cm."
    )
    others = [f"{family(name).title} {percent(score)}" for name, score in fitted.alternatives[:3] if score >= 0.001]
    more = f"<p>Next likeliest: {escape(', '.join(others))}.</p>" if others else ""
    if fitted.doubt:
        more += f'<p class="warning">{escape(fitted.unlike)}</p>'
    if not fitted.converged:
        more += '<p class="warning">The fit had not come to rest when it was stopped: take the figures with care.</p>'
    return f'<p class="lead">{escape(text)}</p>{more}'


def _deviation(one: Seen) -> str:
    shown = ""
    if one.on.any():
        caption = f"Distances of the vault's points to the ideal model: {CONVENTION}"
        chart = histogram(one.deviation[one.on], one.limit)
        shown = f"<figure>{chart}<figcaption>{escape(caption)}</figcaption></figure>"
        shown += f"<div class='map'>{drawn([deviations(one), unrolled_map(one)])}</div>"
    return f"{routes_table(one.fitted)}<p></p>{shown}"


def _parameters(fitted: FittedVault, origin: NDArray[np.float64]) -> str:
    pose = fitted.pose
    x, y, z = np.array([pose.x, pose.y, pose.z]) + origin
    fit = {name: e for name, e in fitted.parameters.items() if not e.derived}
    sizes = {name: e for name, e in fitted.parameters.items() if e.derived}
    arches = "".join(_arch(name, kinds, fitted) for name, kinds in fitted.arches.items())
    lean = f" All of it leans by {degrees(pose.tilt):.2f}° with the scan." if pose.tilt else ""
    return (
        f"{arches}{_rivals(fitted, float(origin[2]))}{_estimates('size', sizes)}<p></p>"
        f"{_estimates('fitted parameter', fit)}"
        f"<p class='soft'>The vault's origin, the centre of its plan on the springing, lies at x {x:.3f}, y {y:.3f}, "
        f"z {z:.3f} m of the scan's coordinates; its x axis is turned by {degrees(pose.yaw):.2f}° about z.{lean}</p>"
        f"{_legend(fitted.parameters.values())}"
    )


def _arch(name: str, kinds: str, fitted: FittedVault) -> str:
    """What is known of an arch, and how likely each kind is."""
    odds = ", ".join(f"{kind} {chance:.0%}" for kind, chance in fitted.odds.get(name, {}).items() if chance >= SHOWN)
    drawn = f"; drawn {fitted.vault.profiles[name].id}" if " or " in kinds else ""
    more = f" <span class='soft'>({odds}{drawn})</span>" if odds else ""
    return f"<p>{escape(name.replace('_', ' '))}: <b>{escape(kinds)}</b>{more}</p>"


def _rivals(fitted: FittedVault, up: float) -> str:
    """The ways in which the vault may have been built, if there are several; up: of the scan's origin [m]."""
    likely = [rival for rival in fitted.rivals if rival.chance >= SHOWN]
    if len(likely) < 2:
        return ""
    rows = []
    for rival in likely:
        arches = ", ".join(f"{name.replace('_', ' ')} {kind}" for name, kind in rival.profiles.items())
        held = ", ".join(rival.constraints)
        z = fitted.pose.z + rival.springing + up
        cells = [percent(rival.chance), escape("; ".join(filter(None, (arches, held)))), metres(rival.sizes["rise"])]
        rows.append([*cells, f"{z:.2f} m"])
    table = html_table(["chance", "built with", "rise", "springing"], rows, numbers=slice(2, 4), long=(1,))
    return (
        f"<p></p>{table}<p class='soft'>"
        "Vaults settle by more than some arches differ: these are likely too, each with the sizes that it had before "
        "it settled. The deviations below allow for them.</p>"
    )


def _legend(estimates: Iterable[Estimate]) -> str:
    """What the marks say, if there are any."""
    flags = {flag for e in estimates for flag in e.flags}
    lines = [f"<b>{sign}</b> {escape(text)}" for flag, (sign, text) in FLAGS.items() if flag in flags]
    return f'<p class="warning">{"; ".join(lines)}.</p>' if lines else ""


def _estimates(kind: str, estimates: Mapping[str, Estimate]) -> str:
    cells = []
    for name, e in ((name, in_shown_unit(estimate)) for name, estimate in estimates.items()):
        meaning = escape("; ".join([e.meaning, *(FLAGS[flag][1] for flag in e.flags)]))
        seen = "–" if e.seen is None else percent(e.seen)
        cells.append([f"<b>{escape(name.replace('_', ' '))}</b>", value_of(e), f"{std_of(e)} {e.marks}", seen, meaning])
    return html_table([kind, "value", "±", "seen", "meaning"], cells, numbers=slice(1, 4), long=(0, 4)) if cells else ""


def _components(components: Iterable[Component]) -> str:
    rows = []
    for c in components:
        swatch = f'<span class="swatch" style="background:{colour(c.id).hex}"></span>{escape(c.name.replace("_", " "))}'
        cells = ["–"] * 5 if c.deviation is None else list(_deviation_cells(c.deviation))
        rows.append([f"{c.id}", swatch, f"{c.points:,}", percent(c.coverage), *cells])
    head = ["id", "component", "points", "coverage", "mean", "RMS", "95 %", "max", "LOA"]
    return html_table(head, rows, numbers=slice(2, 8))


def _deviation_cells(d: Deviation) -> tuple[str, ...]:
    return (*(f"{1000 * v:.1f} mm" for v in (d.mean, d.rms, d.p95, d.max)), escape(d.loa))


def _files() -> str:
    items = "".join(
        f'<dt><a href="{escape(name)}">{escape(name)}</a></dt><dd>{escape(text)}</dd>' for name, text in FILES
    )
    return f"<section><h2>Files</h2><dl>{items}</dl></section>"


def _glossary(model: Model) -> str:
    terms = dict((*TERMS, *(term for fitted in model.vaults for term in fitted.vault.glossary)))
    items = "".join(f"<dt>{escape(term)}</dt><dd>{escape(text)}</dd>" for term, text in terms.items())
    return f"<section><h2>Terms</h2><dl>{items}</dl></section>"


def _notes(model: Model) -> str:
    items = "".join(f"<li>{escape(note.text)}</li>" for note in model.notes)
    return f"<section><h2>Notes on the scan</h2><ul>{items}</ul></section>" if items else ""


def _origin(model: Model) -> str:
    shift = ", ".join(f"{v:.3f}" for v in model.origin)
    settings = _list({name: plain(value) for name, value in model.settings.items()} | {"shift [m]": shift})
    return (
        f'<div class="two"><section><h2>Settings</h2>{settings}</section>'
        f"<section><h2>Versions</h2>{_list(dict(sorted(model.versions.items())))}</section></div>"
    )


def _list(values: Mapping[str, Any]) -> str:
    items = "".join(f"<dt>{escape(str(k))}</dt><dd>{escape(_plainly(v))}</dd>" for k, v in values.items())
    return f"<dl>{items}</dl>"


def _plainly(value: Any) -> str:
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)
