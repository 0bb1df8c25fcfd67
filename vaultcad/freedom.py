"""What a fit may move: parameters that are free, sizes that a user fixed, constraints that are kept or let go."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from families import Vault
from families.constraints import Constraint
from families.lengths import RATIOS, with_lengths

Tie = Callable[[Vault], Mapping[str, float]]

SPRINGING = Constraint("springing", "the springing is no lower than the lowest stone that the scan shows")
"""The one constraint that all families share, as it is about the pose."""


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


@dataclass(frozen=True)
class Demands:
    """What a user settles beforehand.

    sizes: values of parameters and of derived lengths [m, rad or 1], by name. pose: of x, y, z [m] in the scan's local
    frame and of the yaw [rad]. freed: names of constraints that are not to be kept.
    """

    sizes: Mapping[str, float] = field(default_factory=dict)
    pose: Mapping[str, float] = field(default_factory=dict)
    freed: frozenset[str] = frozenset()

    def suits(self, vault: Vault) -> bool:
        """Whether a vault has all the sizes that are fixed, and its whole numbers are as they should be."""
        values, lengths = vault.values(), RATIOS[vault.id]
        whole = {p.name for p in vault.parameters() if p.integer}
        return all(
            (values[name] == value if name in whole else True) if name in values else lengths.get(name) in values
            for name, value in self.sizes.items()
        )

    def begun(self, vault: Vault) -> Vault:
        """The vault with the sizes that are fixed, as near as it can be."""
        return self.freedom(vault).settled(vault, {})

    def freedom(self, vault: Vault, kept: Sequence[Constraint] = ()) -> Freedom:
        """All that may move while the constraints are kept."""
        own, lengths = vault.values(), RATIOS[vault.id]
        values = {name: value for name, value in self.sizes.items() if name in own}
        made = [name for name in self.sizes if name not in own]
        ties: list[Tie] = [_made(name, self.sizes[name]) for name in made]
        taken = {*values, *(lengths[name] for name in made)}
        for constraint in kept:
            decided = constraint.holds(vault)
            if decided and not taken & set(decided):
                taken |= set(decided)
                values |= constraint.values
                ties += [constraint.follows] if constraint.follows else []
        names = tuple(p.name for p in vault.parameters() if not p.integer and p.name not in taken)
        return Freedom(names, values, tuple(ties), self.pose)

    def keepable(self, vault: Vault) -> tuple[Constraint, ...]:
        """The constraints of a vault that nobody has let go."""
        return tuple(c for c in vault.constraints if c.name not in self.freed)

    def begun_with(self, vault: Vault) -> tuple[Constraint, ...]:
        """Those of them that a fit begins with."""
        return tuple(c for c in self.keepable(vault) if c.rare)


NONE = Demands()


def _made(name: str, length: float) -> Tie:
    """The parameter that makes a derived length as given [m], or as near as can be with the other sizes."""

    def tie(vault: Vault) -> Mapping[str, float]:
        ratio = RATIOS[vault.id][name]
        try:
            return {ratio: with_lengths(vault, {name: length}).values()[ratio]}
        except ValueError:
            limits = next(p.range for p in vault.parameters() if p.name == ratio)
            ends = [(vault.replaced({ratio: end}).derived_values()[name], end) for end in (limits.low, limits.high)]
            return {ratio: min(ends, key=lambda pair: abs(pair[0] - length))[1]}

    return tie
