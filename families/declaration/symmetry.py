"""Turns of the frame after which a vault is one of its family again."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeVar

Told = TypeVar("Told")


@dataclass(frozen=True)
class Symmetry:
    """What a turn of the frame changes about a vault; nothing by default.

    exchanged: two words that change their places in all names: with ("x", "y") `rise_ratio_x` becomes `rise_ratio_y`.
    negated: the sizes whose sign changes.
    """

    exchanged: tuple[str, str] | None = None
    negated: tuple[str, ...] = ()

    def sizes(self, sizes: Mapping[str, float]) -> dict[str, float]:
        """Sizes by name after the turn."""
        return self.names({name: -value if name in self.negated else value for name, value in sizes.items()})

    def names(self, told: Mapping[str, Told]) -> dict[str, Told]:
        """What is told by name, after the turn."""
        return {self._name(name): value for name, value in told.items()}

    def _name(self, name: str) -> str:
        if self.exchanged is None:
            return name
        one, other = self.exchanged
        pair = {one: other, other: one}
        return "_".join(pair.get(word, word) for word in name.split("_"))
