"""The families by name, in any of their languages."""

from __future__ import annotations

import unicodedata
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from families.declaration.corners import Skew
from families.declaration.facts import check_facts
from families.declaration.lengths import with_lengths
from families.declaration.profiles import PROFILES, Profile
from families.declaration.vault import SCHEMA, Vault
from families.kinds.annular import Annular
from families.kinds.barrel import Barrel
from families.kinds.cloister import Cloister
from families.kinds.conch import Conch
from families.kinds.dome import Dome
from families.kinds.groin import Groin
from families.kinds.lunette import Lunette
from families.kinds.mirror import Mirror
from families.kinds.rib import Rib
from families.kinds.rotunda import Rotunda
from families.kinds.sail import Sail
from families.kinds.trough import Trough
from families.kinds.umbrella import Umbrella

SKEWS = tuple(Skew().values())
FAMILIES: list[type[Vault]] = []
"""All families, in the order in which they are listed and tried; read it when it is needed, for it may grow."""


def register(cls: type[Vault]) -> type[Vault]:
    """Make a family known by its names everywhere; `FAMILIES.remove` makes it unknown again.

    Raises:
        ValueError: what it says names what there is not, or another family has one of its names.
    """
    check_facts(cls)
    taken = {_plain(name): other for other in FAMILIES for name in _names(other)}
    for name in _names(cls):
        if (other := taken.get(_plain(name))) is not None:
            raise ValueError(f"family {cls.__name__}: {name!r} is a name of {other.__name__} already")
    FAMILIES.append(cls)
    return cls


def family(name: str) -> type[Vault]:
    """The family of an id or of an Italian, French, German or Spanish name; case and accents do not matter.

    Raises:
        ValueError: no such family; names the ids.

    >>> family("crociera").id
    'groin'
    """
    for cls in FAMILIES:
        if _plain(name) in map(_plain, _names(cls)):
            return cls
    raise ValueError(f"no vault family is called {name!r}; there are {', '.join(c.id for c in FAMILIES)}")


def profile(name: str) -> type[Profile]:
    """The profile of an id or alias.

    Raises:
        ValueError: no such profile; names the ids.

    >>> profile("Spitzbogen").id
    'pointed'
    """
    for cls in PROFILES:
        if _plain(name) in map(_plain, (cls.id, *cls.aliases)):
            return cls
    raise ValueError(f"no profile is called {name!r}; there are {', '.join(c.id for c in PROFILES)}")


def ideal(name: str, /, **parameters: Any) -> Vault:
    """The vault of a family's name and parameters.

    Profiles go by their names in any language or are given as they are, numbers by their flat names [m, rad or 1];
    lengths that follow from ratios may stand for these (`rise_y`: see `families.declaration.lengths`).

    Raises:
        ValueError: an unknown name, or a value that cannot be.

    >>> vault = ideal("crociera", span_x=6, profile_x="pointed", rise_x=4)
    >>> vault.id, vault.kinds, round(vault.rise, 6)
    ('groin', {'profile_x': 'pointed', 'profile_y': 'semicircular'}, 4.0)
    """
    vault = family(name)()
    kinds = list(vault.profiles)
    arches = {kind: _arch(kind, parameters.pop(kind)) for kind in kinds if kind in parameters}
    vault, ratios = vault.with_arches(arches), vault.ratios
    known = [*kinds, *vault.values(), *ratios]
    for key, value in parameters.items():
        if key not in known:
            raise ValueError(f"{vault.called} has no {key!r}; it has {', '.join(known)}")
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise ValueError(f"{key} = {value!r} is no number")
        if ratios.get(key) in parameters:
            raise ValueError(f"{key} and {ratios[key]} say the same; leave one out")
    vault = vault.replaced({key: value for key, value in parameters.items() if key not in ratios})
    lengths = {key: value for key, value in parameters.items() if key in ratios}
    return with_lengths(vault, lengths) if lengths else vault


def from_plain(told: Mapping[str, Any]) -> Vault:
    """The vault that `Vault.plain` tells of.

    Raises:
        ValueError: an unknown name, or a value of another kind or outside its range; names it, and what there is.
    """
    if told.get("schema", SCHEMA) != SCHEMA:
        raise ValueError(f"schema = {told['schema']!r} of a vault is not known; this version writes {SCHEMA}")
    if not isinstance(told.get("family"), str):
        raise ValueError(f"family = {told.get('family')!r} is no name; there are {', '.join(c.id for c in FAMILIES)}")
    vault = family(told["family"])()
    known = vault.kinds
    for name, kind in _table(told, "profiles").items():
        if name not in known:
            raise ValueError(f"{vault.called} has no profile {name!r}; it has {', '.join(known) or 'none'}")
        if known[name] != kind:  # the family's own keeps its own numbers
            vault = vault.with_arches({name: _arch(name, kind)})
    parameters = _table(told, "parameters")
    if any(name in parameters for name in SKEWS):
        vault = replace(vault, skew=Skew())
    for name, value in parameters.items():
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise ValueError(f"{name} = {value!r} is no number")
    return vault.replaced(parameters)


def _table(told: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    found = told.get(name, {})
    if not isinstance(found, Mapping):
        raise ValueError(f"{name} = {found!r} is no table of names and values")
    return found


def _arch(field: str, kind: object) -> Profile:
    if isinstance(kind, Profile):
        return kind
    if isinstance(kind, str):
        return profile(kind)()
    raise ValueError(f"{field} = {kind!r} is no profile; there are {', '.join(c.id for c in PROFILES)}")


def _names(cls: type[Vault]) -> tuple[str, ...]:
    return (cls.id, cls.title, *(alias for group in cls.aliases.values() for alias in group))


def _plain(name: str) -> str:
    bare = unicodedata.normalize("NFKD", name.casefold())
    return "".join(c for c in bare if c.isalnum())


for _kind in (Sail, Barrel, Lunette, Trough, Mirror, Groin, Dome, Cloister, Conch, Annular, Rotunda, Rib, Umbrella):
    register(_kind)
