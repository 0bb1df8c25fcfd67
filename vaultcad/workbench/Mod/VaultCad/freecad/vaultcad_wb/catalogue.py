"""What the worker declares of the families, asked once a session; and names, units and kinds in FreeCAD's terms."""

from __future__ import annotations

from math import degrees, pi
from typing import Any, NamedTuple

from .client import BUILDER

Declaration = dict[str, Any]  # of JSON: see vaultcad/workbench/declarations.py


class Kind(NamedTuple):
    """How FreeCAD holds a declared number: its type of property, and the factor from the declared unit to its own."""

    property: str
    factor: float
    unit: str


KINDS = {
    "length": Kind("App::PropertyLength", 1000.0, "mm"),
    "angle": Kind("App::PropertyAngle", 180.0 / pi, "°"),
    "number": Kind("App::PropertyFloat", 1.0, ""),
    "integer": Kind("App::PropertyInteger", 1, ""),
    "choice": Kind("App::PropertyEnumeration", 1.0, ""),
}
SIGNED = "App::PropertyDistance"  # for lengths that may be negative

_told: dict[str, Any] = {}  # what the worker answered


def families() -> dict[str, Declaration]:
    """Family id -> declaration, in the catalogue's order.

    Raises:
        client.GoneError: the worker cannot be had.
    """
    found: dict[str, Declaration] = _asked()["families"]
    return found


def scale() -> dict[str, Any]:
    """How deviations are coloured: `stops`, pairs of a share of the limit and a colour; `unknown`; usual `limit` [mm].

    Raises:
        client.GoneError: the worker cannot be had.
    """
    found: dict[str, Any] = _asked()["deviations"]
    return found


def _asked() -> dict[str, Any]:
    if not _told:
        told = BUILDER.ask("families")
        _told.update(told, families={family["id"]: family for family in told["families"]})
    return _told


def title(name: str) -> str:
    """A declared name as FreeCAD names properties: span_x -> SpanX."""
    return "".join(part.capitalize() for part in name.split("_"))


def shown(value: float, unit: str) -> str:
    """A declared number as people read it: 4.608 m, 17.1°, 0.42."""
    if unit == "rad":
        return f"{degrees(value):.5g}°"
    return f"{value:.4f} m" if unit == "m" else f"{value:.5g}"


def numbers(declaration: Declaration, profiles: dict[str, str]) -> list[dict[str, Any]]:
    """The declared numbers that a vault with these profiles has, in order."""
    found: list[dict[str, Any]] = []
    for parameter in declaration["parameters"]:
        if parameter["kind"] == "choice":
            found += parameter["choices"][profiles[parameter["name"]]]
        else:
            found.append(parameter)
    return found
