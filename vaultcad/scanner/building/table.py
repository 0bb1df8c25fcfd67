"""One table of a declaration, whose keys are taken one by one; what is left then is unknown."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import isfinite
from typing import Any, TypeVar

Word = TypeVar("Word", bound=str)


class Table:
    """Keys and values of a table, and what messages call it. Every method but `done` takes a key away.

    All raise ValueError: a sentence with the table, the key, the value and what it may be.
    """

    def __init__(self, told: Mapping[str, Any], called: str) -> None:
        self.left, self.called, self.known = dict(told), called, set[str]()

    def take(self, key: str, default: Any = None) -> Any:
        """The value as it stands."""
        self.known.add(key)
        return self.left.pop(key, default)

    def number(self, key: str, default: float, low: float, high: float) -> float:
        """A number within its limits."""
        value = self.take(key, default)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise ValueError(f"{self.called}: {key} = {value!r} is no number; give {low:g} to {high:g}")
        if not low <= value <= high:
            raise ValueError(f"{self.called}: {key} = {value:g} lies outside [{low:g}, {high:g}]")
        return float(value)

    def whole(self, key: str, default: int, low: int, high: int) -> int:
        """A whole number within its limits."""
        value = self.number(key, default, low, high)
        if value != int(value):
            raise ValueError(f"{self.called}: {key} = {value:g} is no whole number; give {low} to {high}")
        return int(value)

    def flag(self, key: str, default: bool) -> bool:
        """True or false."""
        value = self.take(key, default)
        if not isinstance(value, bool):
            raise ValueError(f"{self.called}: {key} = {value!r} is neither true nor false")
        return value

    def text(self, key: str, default: str) -> str:
        """A text."""
        value = self.take(key, default)
        if not isinstance(value, str):
            raise ValueError(f"{self.called}: {key} = {value!r} is no text; put it in quotes")
        return value

    def choice(self, key: str, default: Word, choices: Sequence[Word]) -> Word:
        """One of some words."""
        value = self.text(key, default)
        for choice in choices:
            if choice == value:
                return choice
        raise ValueError(f"{self.called}: {key} = {value!r} is not one of {', '.join(choices)}")

    def texts(self, key: str, choices: Iterable[str]) -> tuple[str, ...]:
        """Some of some words; none where it is not given."""
        value, known = self.take(key, []), list(choices)
        wrong = [one for one in value if one not in known] if isinstance(value, list) else [value]
        if wrong:
            raise ValueError(f"{self.called}: {key} has {wrong[0]!r}, which is not one of {', '.join(known)}")
        return tuple(value)

    def point(self, key: str, default: tuple[float, ...] | None, far: float) -> Any:
        """Coordinates: as many as the default has, two where there is none, which then must be given."""
        value, size = self.take(key, default), 2 if default is None else len(default)
        if value is None:
            raise ValueError(f"{self.called} has no {key}; give it {size} coordinates")
        return self._coordinates(key, value, size, far)

    def places(self, key: str, far: float) -> tuple[tuple[float, float, float], ...]:
        """A list of points of three coordinates."""
        value = self.take(key, [])
        if not isinstance(value, list):
            raise ValueError(f"{self.called}: {key} = {value!r} is no list of points [x, y, z]")
        return tuple(self._coordinates(key, one, 3, far) for one in value)

    def _coordinates(self, key: str, value: Any, size: int, far: float) -> Any:
        good = isinstance(value, list | tuple) and len(value) == size
        if not good or not all(isinstance(v, int | float) and isfinite(v) and abs(v) <= far for v in value):
            raise ValueError(f"{self.called}: {key} = {value!r} must be {size} numbers within ±{far:g}")
        return tuple(float(v) for v in value)

    def table(self, key: str) -> Table:
        """A table in it, empty where it is not given."""
        value = self.take(key, {})
        if not isinstance(value, dict):
            raise ValueError(f"{self.called}: {key} = {value!r} is no table; write [{key}]")
        return Table(value, key)

    def tables(self, key: str) -> list[Mapping[str, Any]]:
        """The tables of a list of them."""
        value = self.take(key, [])
        if not isinstance(value, list) or not all(isinstance(one, dict) for one in value):
            raise ValueError(f"{self.called}: {key} is no list of tables; write [[{key}]]")
        return value

    def done(self, known: Iterable[str] = ()) -> None:
        """Refuse what nobody has taken; `known` are further keys that it may have."""
        if self.left:
            names = sorted({*self.known, *known})
            raise ValueError(f"{self.called} has no {next(iter(self.left))!r}; it may have {', '.join(names)}")
