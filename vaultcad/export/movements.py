"""Movements in millimetres, as files and pages tell them."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape
from math import isfinite
from typing import Any

from vaultcad.deformation import Deformation, Movement
from vaultcad.export.page import html_table, percent

DECIMALS = 2  # of millimetres
UNITS = {"m": "mm", "m/m": "mm/m"}


def plain_movement(one: Movement) -> dict[str, Any]:
    """A movement as plain values, in millimetres or millimetres a metre, with its 95 % limit."""
    return {
        "name": one.name,
        "value": millimetres(one.value),
        "limit95": millimetres(one.limit),
        "unit": UNITS[one.unit],
        "direction": one.direction,
        "azimuth_deg": None if one.azimuth is None else round(one.azimuth, 1),
        "certain": one.certain,
    }


def plain_deformation(deformation: Deformation | None) -> dict[str, Any] | None:
    """A reading as plain values."""
    if deformation is None:
        return None
    return {
        "verdict": deformation.verdict,
        "references": [
            {"id": one.id, "reference": one.reference, "movements": [plain_movement(m) for m in one.movements]}
            for one in deformation.against
        ],
        "resembles": [
            {"mechanism": one.mechanism, "odds": round(one.odds, 4), "share": round(one.share, 4), "says": one.says}
            for one in deformation.resembles
        ],
        "caution": list(deformation.caution),
    }


def movement_table(movements: Iterable[Movement]) -> str:
    """As HTML; what is larger than its limit stands out."""
    rows = []
    for one in movements:
        value = f"{1000 * one.value:.1f} {UNITS[one.unit]}"
        bearing = "" if one.azimuth is None else f"{one.azimuth:.0f}°"
        cells = [escape(one.name), f"<b>{value}</b>" if one.certain else value, f"± {1000 * one.limit:.1f}"]
        rows.append([*cells, escape(one.direction) if one.certain else "not certain", bearing])
    return html_table(["movement", "value", "95 % limit", "direction", "azimuth"], rows, slice(1, 3), long=(0, 3))


def resemblance_table(deformation: Deformation) -> str:
    """As HTML; nothing where it resembles none."""
    if not deformation.resembles:
        return ""
    rows = [[escape(r.mechanism), r.told_odds, percent(r.share), escape(r.says)] for r in deformation.resembles]
    return html_table(["mechanism", "odds", "of what moved", "how it shows"], rows, slice(1, 3), long=(0, 3))


def millimetres(value: float) -> float | None:
    """A length [m] as files have it; None for what is no number. Never -0.0."""
    return round(1000 * float(value), DECIMALS) + 0.0 if isfinite(value) else None
