"""What a user asks of a fit, by names: sizes to be fixed and constraints to be let go."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from difflib import get_close_matches
from itertools import chain
from math import inf, isfinite, pi

from families import Vault, profile
from families.declaration.constraints import Constraint
from families.declaration.parameters import Range, derived_declarations
from vaultcad.fit.freedom import BAYS, RECTANGLE, SPRINGING, Demands, decides

PLACE = {
    "x": Range(-inf, inf, "m", "middle of the plan, in the scan's coordinates"),
    "y": Range(-inf, inf, "m", "middle of the plan, in the scan's coordinates"),
    "springing": Range(-inf, inf, "m", "height of the springing, in the scan's coordinates"),
    "yaw": Range(-2 * pi, 2 * pi, "rad", "turn of the vault's x axis"),
}
"""Parts of the pose that can be fixed."""
MANY = 25
"""Names that nobody reads through."""


def demand(
    families: Sequence[type[Vault]],
    fix: Mapping[str, float | str],
    free: Iterable[str],
    origin: Sequence[float] = (0.0, 0.0, 0.0),
) -> tuple[tuple[type[Vault], ...], Demands]:
    """The families that have all sizes to be fixed, and what is then asked of each.

    Args:
        families: to choose from.
        fix: value [m, rad or 1] by the name of a parameter, of a length that follows, or of a part of the pose; kind of
            arch by the name of a profile.
        free: names of constraints.
        origin: (3,) of the local frame, in the scan's coordinates [m].

    Raises:
        ValueError: a name that is none, or a value that cannot be; names the value, and what exists.
    """
    arches = {name: profile(kind) for name, kind in fix.items() if isinstance(kind, str)}
    places = dict.fromkeys(name for cls in families for name in cls().profiles)
    for name in arches:
        if name not in places:
            raise ValueError(f"no arch {name!r} to fix; there are {', '.join(places) or 'none'}")
    sizes = {cls: sizes_of(cls) for cls in families}
    numbers = {name: value for name, value in fix.items() if not isinstance(value, str)}
    for name, value in numbers.items():
        ranges = [own[name] for own in (PLACE, *sizes.values()) if name in own]
        if not ranges:
            known = dict.fromkeys(chain(*sizes.values(), PLACE, places))
            raise ValueError(f"no size {name!r} to fix; {_instead(name, list(known))}")
        low, high = min(r.low for r in ranges), max(r.high for r in ranges)
        if not isfinite(value) or not low <= value <= high:
            raise ValueError(f"{name} = {value:g} cannot be; it is {low:g} to {high:g} {ranges[0].unit}")
    known = dict.fromkeys(c.name for cls in families for c in constraints_of(cls))
    freed = frozenset(name.strip().replace(" ", "-").replace("_", "-") for name in free)
    for name in sorted(freed - set(known)):
        raise ValueError(f"no constraint {name!r} to let go; there are {', '.join(known)}")

    own = {name: value for name, value in numbers.items() if name not in PLACE}
    chosen = tuple(cls for cls in families if set(own) <= set(sizes[cls]) and set(arches) <= set(cls().profiles))
    if not chosen:
        asked = ", ".join([*own, *arches])
        raise ValueError(f"no family has all of {asked}; fix sizes of one family, see vaultcad families")
    local = dict(zip(("x", "y", "springing"), origin, strict=True))
    pose = {{"springing": "z"}.get(k, k): v - local.get(k, 0.0) for k, v in numbers.items() if k in PLACE}
    return chosen, Demands(own, pose, freed, arches)


def _instead(name: str, known: Sequence[str]) -> str:
    """What may have been meant, and what there is, unless that is too much to read."""
    close = get_close_matches(name, known, n=3)
    meant = f"did you mean {' or '.join(close)}?" if close else ""
    there = f"there are {', '.join(known)}" if len(known) <= MANY else "vaultcad families NAME lists those of a family"
    return f"{there}; {meant}" if meant and len(known) <= MANY else f"{meant} {there}".strip()


def sizes_of(cls: type[Vault]) -> dict[str, Range]:
    """All sizes of a family that can be fixed, whatever its profiles are: parameters, then lengths that follow."""
    vault = cls()
    vaults = [vault]
    for name in vault.profiles:
        vaults += [vault.with_arches({name: kind()}) for kind in vault.kinds_for(name)]
    derived = derived_declarations(cls)
    lengths = [*decides(cls), *cls.stands_for]
    found = {p.name: p.range for one in vaults for p in one.parameters()}
    return found | {name: Range(-inf, inf, "m", derived[name].meaning) for name in lengths}


def constraints_of(cls: type[Vault]) -> tuple[Constraint, ...]:
    """All constraints of a family that can be let go."""
    return (SPRINGING, BAYS, *((RECTANGLE,) if cls.four_corners else ()), *cls.constraints)
