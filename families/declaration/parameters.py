"""Parameters declared once: range, unit and meaning stand at the field of the dataclass."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, TypeVar, get_args, get_origin, get_type_hints

from families.declaration.once import Once

Shape = TypeVar("Shape", bound="Parametric")


@dataclass(frozen=True)
class Range:
    """Closed interval of a parameter with its unit ("m", "rad", "1") and meaning."""

    low: float
    high: float
    unit: str
    meaning: str


@dataclass(frozen=True)
class Parameter:
    """One number of a family: its flat name, where it sits in nested fields, and its declaration."""

    name: str
    path: tuple[str, ...]
    range: Range
    integer: bool


class Derived(Once[float]):
    """A read-only property that is reported: a length or angle that follows from the parameters, worked out once."""

    def __init__(self, method: Callable[[Any], float], unit: str, meaning: str) -> None:
        super().__init__(method)
        self.unit, self.meaning = unit, meaning


def derived(unit: str, meaning: str) -> Callable[[Callable[[Any], float]], Derived]:
    """Decorator that turns a method into a `Derived` property with its unit and meaning."""
    return lambda method: Derived(method, unit, meaning)


class Parametric:
    """Base of frozen dataclasses whose float fields are `Annotated[float, Range(...)]`; fields may nest."""

    def __post_init__(self) -> None:
        """Refuse values outside their ranges.

        Raises:
            ValueError: names the parameter, the value and the range.
        """
        for name, limits, integer in _known(type(self)).own:
            value = getattr(self, name)
            if not limits.low <= value <= limits.high:  # not a number either
                raise ValueError(f"{name} = {value:g} lies outside [{limits.low:g}, {limits.high:g}] {limits.unit}")
            if integer and value != int(value):
                raise ValueError(f"{name} = {value:g} must be a whole number from {limits.low:g} to {limits.high:g}")

    def __getstate__(self) -> dict[str, Any]:
        """Its fields: what was worked out is worked out again where it is sent to."""
        return {name: vars(self)[name] for name in _known(type(self)).fields}

    def parameters(self) -> tuple[Parameter, ...]:
        """Flat list of all parameters; those of a nested `profile_x` are named like `rise_ratio_x`."""
        return tuple(_declared(self).values())

    def values(self) -> dict[str, float]:
        """Flat name -> value [m, rad or 1]."""
        return {name: float(_get(self, p.path)) for name, p in _declared(self).items()}

    def derived_values(self) -> dict[str, float]:
        """Name -> value of every `Derived` property."""
        return {name: float(getattr(self, name)) for name in derived_declarations(type(self))}

    def replaced(self: Shape, values: Mapping[str, float]) -> Shape:
        """A copy with some flat parameters changed.

        Raises:
            ValueError: an unknown name, or a value outside its range.

        >>> from families import Barrel, Pointed
        >>> Barrel(profile=Pointed()).replaced({"span": 4, "rise_ratio": 0.8}).rise
        3.2
        """
        known = _declared(self)
        tree: dict[str, Any] = {}
        for name, value in values.items():
            if name not in known:
                raise ValueError(f"no parameter {name!r} here; there are {', '.join(known)}")
            node = tree
            *heads, last = known[name].path
            for head in heads:
                node = node.setdefault(head, {})
            node[last] = int(value) if known[name].integer and value == int(value) else value
        return _rebuild(self, tree)


_DERIVED: dict[type, dict[str, Derived]] = {}


def derived_declarations(cls: type) -> dict[str, Derived]:
    """Name -> declaration of the reported properties of a class, base classes first."""
    if cls not in _DERIVED:
        found: dict[str, Derived] = {}
        for base in reversed(cls.__mro__):
            found.update({k: v for k, v in vars(base).items() if isinstance(v, Derived)})
        _DERIVED[cls] = found
    return _DERIVED[cls]


def flat_name(field: str, name: str) -> str:
    """How a parameter of what a field holds is called: `rise_ratio` of `profile_x` is `rise_ratio_x`."""
    return field.replace("profile", name) if "profile" in field else name


@dataclass(frozen=True)
class _Known:
    """What a class declares. fields: the names of all. holders: of those that may hold further parameters."""

    own: tuple[tuple[str, Range, bool], ...]
    fields: tuple[str, ...]
    holders: tuple[str, ...]


_KNOWN: dict[type, _Known] = {}


def _known(cls: type) -> _Known:
    if cls not in _KNOWN:  # reading annotations is slow, and an optimiser makes thousands of instances
        own, fields = tuple(_read_declarations(cls)), tuple(field.name for field in dataclasses.fields(cls))
        numbers = {name for name, _, _ in own}
        _KNOWN[cls] = _Known(own, fields, tuple(name for name in fields if name not in numbers))
    return _KNOWN[cls]


def _read_declarations(cls: type) -> Iterator[tuple[str, Range, bool]]:
    hints = get_type_hints(cls, include_extras=True)
    for field in dataclasses.fields(cls):
        hint = hints[field.name]
        if get_origin(hint) is Annotated:
            base, limits = get_args(hint)[:2]
            yield field.name, limits, base is int


DECLARED = "_declared"  # where an instance keeps what it declares
_FLAT: dict[tuple[Any, ...], dict[str, Parameter]] = {}


def _declared(shape: Parametric) -> dict[str, Parameter]:
    """Flat name -> parameter; the same for all of these classes."""
    kept: dict[str, Parameter] | None = vars(shape).get(DECLARED)
    if kept is None:
        kinds = _kinds(shape)
        if kinds not in _FLAT:
            _FLAT[kinds] = {p.name: p for p in _flatten(shape)}
        kept = vars(shape)[DECLARED] = _FLAT[kinds]
    return kept


def _kinds(shape: Parametric) -> tuple[Any, ...]:
    """Its class, and the names of fields that hold further parameters with the classes of what they hold."""
    cls, own = type(shape), vars(shape)
    held = [(name, own[name]) for name in _known(cls).holders]
    return (cls, *[(name, _kinds(inner)) for name, inner in held if isinstance(inner, Parametric)])


def _flatten(shape: Parametric) -> Iterator[Parameter]:
    own = {name: (limits, integer) for name, limits, integer in _known(type(shape)).own}
    for field in dataclasses.fields(shape):  # type: ignore[arg-type]  # Parametric classes are dataclasses
        if field.name in own:
            yield Parameter(field.name, (field.name,), *own[field.name])
        elif isinstance(inner := getattr(shape, field.name), Parametric):
            for p in inner.parameters():
                yield dataclasses.replace(p, name=flat_name(field.name, p.name), path=(field.name, *p.path))


def _get(shape: Any, path: tuple[str, ...]) -> Any:
    for name in path:
        shape = getattr(shape, name)
    return shape


def _rebuild(shape: Shape, tree: Mapping[str, Any]) -> Shape:
    """What `dataclasses.replace` makes, in a third of its time; what an instance declares stays with other numbers."""
    cls, own = type(shape), vars(shape)
    made = object.__new__(cls)
    fields = vars(made)
    for name in _known(cls).fields:
        fields[name] = own[name]
    if DECLARED in own:
        fields[DECLARED] = own[DECLARED]
    for name, new in tree.items():
        fields[name] = _rebuild(own[name], new) if isinstance(new, dict) else new
    made.__post_init__()
    return made
