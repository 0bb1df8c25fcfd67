"""What a fit may move: parameters that are free, sizes that a user fixed, constraints that are kept or let go."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product

from families import PROFILES, Profile, Vault
from families.declaration.constraints import Constraint
from families.declaration.profiles import as_kind

EXACT_SIZE = 1e-6  # of sizes that are fixed
REACHED = 1e-9  # m, of lengths that ties make: far less than the steps of finite differences change them
CHANGES = tuple(sign * k / 50 for k in range(1, 11) for sign in (-1, 1))
"""Shares by which a first guess of a size may be changed for the sake of a length that is fixed: guesses are rough."""
Tie = Callable[[Vault], Mapping[str, float]]

SPRINGING = Constraint("springing", "the springing is no lower than the lowest stone that the scan shows")
"""A constraint that all families share, as it is about the pose."""
RECTANGLE = Constraint("rectangle", "the plan is a rectangle; else its four corners are free", rare=True)
"""One that all families share whose plan has four corners. It holds no parameter: without it there are more of them."""
BAYS = Constraint("bays", "equal bays of a row share their arches, sizes and springing where the scan allows it")
"""One that is about several vaults."""


@dataclass(frozen=True)
class Freedom:
    """names: the parameters that an optimiser moves. values: of others that stay. ties: what others follow from these.

    pose: parts of the pose that stay.
    """

    names: tuple[str, ...]
    values: Mapping[str, float] = field(default_factory=dict)
    ties: tuple[Tie, ...] = ()
    pose: Mapping[str, float] = field(default_factory=dict)

    def settled(self, vault: Vault, moved: Mapping[str, float]) -> Vault:
        """The vault with its free parameters moved, and all others where they belong."""
        vault = vault.replaced({**self.values, **moved})
        for tie in self.ties:
            vault = vault.replaced(tie(vault))
        return vault

    def reaches(self, vault: Vault) -> bool:
        """Whether the lengths of a vault are as they are given: else the other sizes do not allow them."""
        return all(length.made(vault) for length in self.lengths)

    @property
    def lengths(self) -> tuple[_Made, ...]:
        """Those that are given."""
        return tuple(dict.fromkeys(tie for tie in self.ties if isinstance(tie, _Made)))


@dataclass(frozen=True)
class Demands:
    """What a user settles beforehand.

    sizes: values of parameters and of derived lengths [m, rad or 1], by name. pose: of x, y, z [m] in the scan's local
    frame and of the yaw [rad]. freed: names of constraints that are not to be kept. arches: kinds, by the names of the
    fields of a vault. rectangular: whether plans are rectangles whatever the scan says.
    """

    sizes: Mapping[str, float] = field(default_factory=dict)
    pose: Mapping[str, float] = field(default_factory=dict)
    freed: frozenset[str] = frozenset()
    arches: Mapping[str, type[Profile]] = field(default_factory=dict)
    rectangular: bool = False

    @property
    def of_vault(self) -> bool:
        """Whether anything of the vault itself is settled."""
        return bool(self.sizes or self.arches)

    def of(self, family: type[Vault]) -> dict[str, float]:
        """The sizes in terms that each hang on one parameter of a family."""
        found: dict[str, float] = {}
        for name, value in self.sizes.items():
            found |= family.stands_for[name](value) if name in family.stands_for else {name: value}
        return found

    def suits(self, vault: Vault) -> bool:
        """Whether a vault can have all sizes that are fixed, its whole numbers and arches are as they should be."""
        arches = vault.profiles
        if any(name not in arches or type(arches[name]) is not kind for name, kind in self.arches.items()):
            return False
        values, lengths, own = vault.values(), decides(type(vault)), {p.name: p for p in vault.parameters()}

        def can(name: str, value: float) -> bool:
            if name not in own:
                return lengths.get(name) in own
            p = own[name]
            return value == values[name] if p.integer else p.range.low <= value <= p.range.high

        return all(can(name, value) for name, value in self.of(type(vault)).items())

    def suited(self, vault: Vault) -> Vault | None:
        """The vault, or the first with other profiles that has all sizes; None if none has."""
        own = vault.profiles
        if any(kind not in vault.kinds_for(name) for name, kind in self.arches.items() if name in own):
            return None
        fixed = {name: as_kind(kind, own[name]) or kind() for name, kind in self.arches.items() if name in own}
        vault = vault.with_arches(fixed)
        if self.suits(vault) and self.met(self.begun(vault)):
            return vault
        places = [name for name in own if name not in fixed]
        others = (vault.with_arches({name: kind()}) for name in places for kind in vault.kinds_for(name))
        common = (kind for kind in PROFILES if all(kind in vault.kinds_for(name) for name in places))
        every = (vault.with_arches({name: kind() for name in places}) for kind in common)
        suiting = [other for other in (vault, *others, *every) if self.suits(other)]
        within = (other for other in suiting if self.met(self.begun(other)))  # not only its ratio, the size too
        return next(within, suiting[0] if suiting else None)

    def begun(self, vault: Vault) -> Vault:
        """The vault with the sizes that are fixed, as near as it can be."""
        return self.freedom(vault).settled(vault, {})

    def met(self, vault: Vault) -> bool:
        """Whether the sizes of a vault are those that are fixed."""
        made = {**vault.derived_values(), **vault.values()}
        return all(abs(made[name] - value) < EXACT_SIZE for name, value in self.sizes.items())

    def within_reach(self, vault: Vault) -> Vault | None:
        """The vault with the sizes that are fixed, others changed as little as allows it; None where that is much."""
        free, ranges = self.freedom(vault), {p.name: p.range for p in vault.parameters()}

        def changed(one: Vault) -> Iterator[Vault]:
            values = one.values()
            for change, name in product(CHANGES, free.names):
                value = min(max(values[name] * (1 + change), ranges[name].low), ranges[name].high)
                yield free.settled(one, {name: value})

        found = free.settled(vault, {})
        for length in free.lengths:
            if not length.made(found):
                found = next(filter(length.made, changed(found)), found)
        return found if self.met(found) else None

    def freedom(self, vault: Vault, kept: Sequence[Constraint] = ()) -> Freedom:
        """All that may move while the constraints are kept."""
        own, lengths, sizes = vault.values(), decides(type(vault)), self.of(type(vault))
        values = {name: value for name, value in sizes.items() if name in own}
        made = [name for name in lengths if name in sizes and name not in own]
        given: list[Tie] = [_Made(name, sizes[name]) for name in made]
        following: list[Tie] = []
        taken = {*values, *(lengths[name] for name in made)}
        for constraint in kept:
            decided = constraint.holds(vault)
            if decided and not taken & set(decided):
                taken |= set(decided)
                values |= constraint.values
                following += [constraint.follows] if constraint.follows else []
        names = tuple(p.name for p in vault.parameters() if not p.integer and p.name not in taken)
        # What follows may hang on a length that is given, and that on what follows: coves on the narrower of them.
        ties = (*given, *following, *given) if following else tuple(given)
        return Freedom(names, values, ties, {"yaw": 0.0, **self.pose} if vault.plan.turns else self.pose)

    def keepable(self, vault: Vault) -> tuple[Constraint, ...]:
        """The constraints of a vault that nobody has let go; not the rectangle where nobody may."""
        plan = (RECTANGLE,) if vault.four_corners and not self.rectangular else ()
        return tuple(c for c in (*plan, *vault.constraints) if c.name not in self.freed)

    def begun_with(self, vault: Vault) -> tuple[Constraint, ...]:
        """Those of them that a fit begins with: that seldom fail, and that the vault does not break."""
        own = vault.values()
        return tuple(c for c in self.keepable(vault) if c.rare and all(own[k] == v for k, v in c.values.items()))


NONE = Demands()


def decides(family: type[Vault]) -> Mapping[str, str]:
    """Derived length -> the one parameter that decides it in a fit; each is monotonic in that."""
    return {**family.ratios, **family.held}


@dataclass(frozen=True)
class _Made:
    """The tie that makes a derived length as given [m], or as near as can be with the other sizes."""

    name: str
    length: float

    def made(self, vault: Vault) -> bool:
        """Whether a vault has it."""
        return abs(float(getattr(vault, self.name)) - self.length) < REACHED

    def __call__(self, vault: Vault) -> Mapping[str, float]:
        from scipy.optimize import brentq

        ratio = decides(type(vault))[self.name]
        limits = next(p.range for p in vault.parameters() if p.name == ratio)

        def miss(value: float) -> float:
            return float(getattr(vault.replaced({ratio: value}), self.name)) - self.length

        ends = [(limits.low, miss(limits.low)), (limits.high, miss(limits.high))]
        if ends[0][1] * ends[1][1] > 0:
            return {ratio: min(ends, key=lambda end: abs(end[1]))[0]}
        return {ratio: brentq(miss, limits.low, limits.high, xtol=1e-13)}
