"""Constraints: what builders mostly did, so what a fit takes for true until the scan says otherwise."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Constraint:
    """A relation between a family's parameters that may be kept or let go.

    name: stable English id. meaning: in the family's words. values: parameters that it holds at a value. follows: what
    others it makes follow, and their values for a vault; none where that vault's profiles leave it nothing to decide.
    begins: where to start from once it is let go, by the vault, if not from where the vault is.
    rare: whether it so seldom fails that a fit begins with it kept; the others are kept in the end, if that costs
    little.
    """

    name: str
    meaning: str
    values: Mapping[str, float] = field(default_factory=dict)
    follows: Callable[[Any], Mapping[str, float]] | None = None
    begins: Callable[[Any], Mapping[str, float]] | None = None
    rare: bool = False

    def holds(self, vault: Any) -> Mapping[str, float]:
        """The parameters that it decides, and their values for a vault."""
        return self.values if self.follows is None else self.follows(vault)

    def let_go(self, vault: Any) -> Mapping[str, float]:
        """Parameters, and the values within their ranges from which they are to be looked for without it."""
        begun = {} if self.begins is None else self.begins(vault)
        ranges = {p.name: p.range for p in vault.parameters()}
        return {name: min(max(value, ranges[name].low), ranges[name].high) for name, value in begun.items()}
