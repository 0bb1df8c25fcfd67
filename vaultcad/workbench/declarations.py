"""What a family of vaults can be told, as tables: the families' own declarations, so that nothing is typed again."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from families import Profile, Vault
    from families.declaration.parameters import Parameter
    from vaultcad.workbench.protocol import Request

GROUPS = {"vault": "Dimensions", "profile": "Arches", "size": "Sizes"}


def families(request: Request) -> dict[str, Any]:
    """All families with their parameters in order, lengths in metres, angles in radians; and how deviations look."""
    from families import FAMILIES

    return {"families": [declared(cls) for cls in FAMILIES], "deviations": deviation_scale()}


def deviation_scale() -> dict[str, Any]:
    """The colours of deviations: `stops`, pairs of a share of the limit and red, green, blue from 0 to 1; `unknown`,
    where there is none; the usual `limit` [mm].
    """
    from families.drawing.deviation_colours import STOPS, UNKNOWN, USUAL_LIMIT

    stops = [[share, list(colour.unit)] for share, colour in STOPS]
    return {"stops": stops, "unknown": list(UNKNOWN.unit), "limit": 1000 * USUAL_LIMIT}


def declared(cls: type[Vault]) -> dict[str, Any]:
    """One family: names, components, `parameters`, and `sizes` that follow from them or, some, decide on one of them.

    A parameter has name, kind, unit, low, high, meaning, group, default. One of kind "choice" is a profile: instead of
    a range it has `choices`, profile id -> the parameters that this profile adds.
    """
    from families.declaration.parameters import derived_declarations

    vault = cls()
    own, values, arches = {p.path[0]: p for p in vault.parameters()}, vault.values(), vault.profiles
    parameters = []
    for name in (field.name for field in fields(cls)):
        if name in arches:
            parameters.append(_choice(vault, name, arches[name]))
        elif name in own:
            parameters.append(_number(own[name], values[name], GROUPS["vault"]))
    sizes = [
        {
            "name": name,
            "kind": _kind(size.unit),
            "unit": size.unit,
            "meaning": size.meaning,
            "group": GROUPS["size"],
            "decides": name in cls.ratios,
        }
        for name, size in derived_declarations(cls).items()
    ]
    return {
        "id": cls.id,
        "title": cls.title,
        "aliases": {language: list(names) for language, names in cls.aliases.items()},
        "components": list(vault.components),
        "parameters": parameters,
        "sizes": sizes,
    }


def _choice(vault: Vault, name: str, default: Profile) -> dict[str, Any]:
    choices = {}
    for kind in vault.kinds_for(name):
        # The family's own default keeps its own numbers, as in a lunette vault of 0.45.
        one = default if kind is type(default) else kind()
        within = vault.with_arches({name: one})
        values = within.values()
        choices[kind.id] = [
            _number(p, values[p.name], GROUPS["profile"]) for p in within.parameters() if p.path[0] == name
        ]
    return {
        "name": name,
        "kind": "choice",
        "meaning": "kind of arch",
        "group": GROUPS["profile"],
        "default": default.id,
        "choices": choices,
    }


def _number(parameter: Parameter, default: float, group: str) -> dict[str, Any]:
    limits = parameter.range
    return {
        "name": parameter.name,
        "kind": "integer" if parameter.integer else _kind(limits.unit),
        "unit": limits.unit,
        "low": limits.low,
        "high": limits.high,
        "meaning": limits.meaning,
        "group": group,
        "default": int(default) if parameter.integer else default,
    }


def _kind(unit: str) -> str:
    return {"m": "length", "rad": "angle", "1": "number"}[unit]
