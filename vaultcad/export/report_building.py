"""The first part of report.html where there are several vaults: plans of the building, tables of bays and arches."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from vaultcad.export.building_plan import building_plans, family_colours
from vaultcad.export.page import drawn, html_table, metres, percent, std_of
from vaultcad.export.seen import Seen
from vaultcad.measure.arcs import arcs_of, springing_of
from vaultcad.measure.building import Building, letters
from vaultcad.measure.setting_out import setting_out
from vaultcad.model import FittedArch, Model
from vaultcad.uncertain import Estimate

LIKELY = 0.05  # chance from which on a rule is shown
MOST_RULES = 3  # of an arch


def building_page(model: Model, building: Building, found: Sequence[Seen], view: str) -> str:
    """Plans, the 3D view and tables, as HTML."""
    arches = f", {len(model.arches)} arch{'es' * (len(model.arches) > 1)}" if model.arches else ""
    title = f"{len(found)} vault{'s' * (len(found) > 1)}{arches}"
    return (
        f"<header><h1>{title}</h1>"
        f'<p class="soft">{escape(model.scan.name)} · {model.points:,} points · {_summary(building)}</p></header>'
        f"{_plans(model, found) if len(found) > 1 else ''}{view}"
        f"<section><h2>Bays</h2>{_bays(model, building)}</section>"
        f"{f'<section><h2>Arches</h2>{_arches(model)}</section>' if model.arches else ''}"
    )


def _plans(model: Model, found: Sequence[Seen]) -> str:
    return f'<div class="plans">{drawn(building_plans(model, found))}</div>'


def _summary(building: Building) -> str:
    rows = ", ".join(f"{letters(k)} of {len(row)}" for k, row in enumerate(building.rows) if len(row) > 1)
    told = [f"rows {rows}" if rows else "", _counted(len(building.rooms), "room")]
    if len(building.storeys) > 1:
        told.append(_counted(len(building.storeys), "storey"))
    return escape(" · ".join(filter(None, told)))


def _counted(count: int, what: str) -> str:
    return f"{count} {what}{'s' * (count > 1)}"


def _bays(model: Model, building: Building) -> str:
    colours, up = family_colours(model), float(model.origin[2])
    rows = []
    for k in (k for row in building.rows for k in row):
        fitted = model.vaults[k - 1]
        vault = fitted.vault
        row, place = building.bay(k)
        swatch = f'<span class="swatch" style="background:{colours[vault.id].hex}"></span>'
        low, high = vault.plan.box
        rows.append(
            [
                f'<a href="#vault-{k}">{k}</a>',
                f"{row} {place}",
                f"{building.room(k)}",
                *([f"{building.storey(k)}"] if len(building.storeys) > 1 else []),
                f"{swatch}{escape(vault.title)}",
                percent(fitted.confidence),
                " × ".join(f"{side:.2f}" for side in (high - low).tolist()) + "\u00a0m",
                metres(vault.derived_values()["rise"]),
                f"{fitted.pose.z + up:.2f} m",
                f"{1000 * fitted.deviation.rms:.1f} mm",
                percent(fitted.coverage),
            ]
        )
    storey = ["storey"] if len(building.storeys) > 1 else []
    head = ["no", "bay", "room", *storey, "family", "confidence", "plan", "rise", "springing", "RMS", "seen"]
    return html_table(head, rows, numbers=slice(4 + len(storey), None))


def _arches(model: Model) -> str:
    up = float(model.origin[2])
    rows = [[f"{k}", *_arch(arch, up)] for k, arch in enumerate(model.arches, 1)]
    head = ["no", "between", "kind", "set out as", "span", "rise", "springing", "width", "depth", "radii", "RMS"]
    note = (
        "<p class='soft'>Set out as: rules by which masons drew such arches, with the chance that each was followed, "
        "from the rise, the span and how sure they are. Depth: of the ring under the vaults beside it.</p>"
    )
    return html_table(head, rows, numbers=slice(4, None), long=(3,)) + note


def _arch(arch: FittedArch, up: float) -> list[str]:
    rules = [f"{name} {chance:.0%}" for name, chance in setting_out(arch).items() if chance >= LIKELY][:MOST_RULES]
    springing = springing_of(arch)
    return [
        " and ".join(f'<a href="#vault-{k}">{k}</a>' for k in arch.beside if k) or "–",
        escape(arch.arches["profile"]),
        "<br>".join(map(escape, rules)),
        _unsure(arch.parameters["span"]),
        _unsure(arch.parameters["rise"]),
        _unsure(springing, up),
        _unsure(arch.parameters["length"]),
        "–" if arch.ring is None else _unsure(Estimate(arch.ring, "m", arch.ring_std)),
        "<br>".join(_unsure(arc.radius) for arc in arcs_of(arch)) or "–",
        f"{1000 * arch.deviation.rms:.1f} mm",
    ]


def _unsure(estimate: Estimate, by: float = 0.0) -> str:
    """A length and how sure it is."""
    return f"{estimate.value + by:.3f} m" + (f"<br>± {std_of(estimate)}" if estimate.std else "")
