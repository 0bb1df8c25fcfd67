"""The families by name, in any of their languages."""

from __future__ import annotations

import unicodedata

from families.barrel import Barrel
from families.dome import Dome
from families.groin import Groin
from families.lunette import Lunette
from families.mirror import Mirror
from families.profiles import PROFILES, Profile
from families.sail import Sail
from families.trough import Trough
from families.vault import Vault

FAMILIES: tuple[type[Vault], ...] = (Sail, Barrel, Lunette, Trough, Mirror, Groin, Dome)


def family(name: str) -> type[Vault]:
    """The family of an id or of an Italian, French, German or Spanish name; case and accents do not matter.

    Raises:
        ValueError: no such family; names the ids.
    """
    for cls in FAMILIES:
        names = (cls.id, cls.title, *(alias for group in cls.aliases.values() for alias in group))
        if _plain(name) in map(_plain, names):
            return cls
    raise ValueError(f"no vault family is called {name!r}; there are {', '.join(c.id for c in FAMILIES)}")


def profile(name: str) -> type[Profile]:
    """The profile of an id or alias.

    Raises:
        ValueError: no such profile; names the ids.
    """
    for cls in PROFILES:
        if _plain(name) in map(_plain, (cls.id, *cls.aliases)):
            return cls
    raise ValueError(f"no profile is called {name!r}; there are {', '.join(c.id for c in PROFILES)}")


def _plain(name: str) -> str:
    bare = unicodedata.normalize("NFKD", name.casefold())
    return "".join(c for c in bare if c.isalnum())
