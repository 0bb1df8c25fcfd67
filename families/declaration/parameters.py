"""Parameters declared once: range, unit and meaning stand at the field of the dataclass."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, TypeVar, get_args, get_origin, get_type_hints, overload

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


class Derived:
    """A read-only property that is reported: a length or angle that follows from the parameters, worked out once."""

    def __init__(self, method: Callable[[Any], float], unit: str, meaning: str) -> None:
        self.method, self.unit, self.meaning = method, unit, meaning
        self.__doc__ = method.__doc__

    def __set_name__(self, cls: type, name: str) -> None:
        """Learn under which name an instance keeps the value: found there first, as this is no data descriptor."""
        self.name = name

    @overload
    def __get__(self, owner: None, cls: type) -> Derived: ...
    @overload
    def __get__(self, owner: object, cls: type) -> float: ...
    def __get__(self, owner: object, cls: type) -> Derived | float:
        """The value at an instance, the declaration at its class."""
        if owner is None:
            return self
        value = vars(owner)[self.name] = self.method(owner)
        return value


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
        for name, limits, integer in _own_parameters(type(self)):
            value = getattr(self, name)
            if not limits.low <= value <= limits.high:  # not a number either
                raise ValueError(f"{name} = {value:g} lies outside [{limits.low:g}, {limits.high:g}] {limits.unit}")
            if integer and value != int(value):
                raise ValueError(f"{name} = {value:g} must be a whole number from {limits.low:g} to {limits.high:g}")

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


def derived_declarations(cls: type) -> dict[str, Derived]:
    """Name -> declaration of the reported properties of a class, base classes first."""
    found: dict[str, Derived] = {}
    for base in reversed(cls.__mro__):
        found.update({k: v for k, v in vars(base).items() if isinstance(v, Derived)})
    return found


def flat_name(field: str, name: str) -> str:
    """How a parameter of what a field holds is called: `rise_ratio` of `profile_x` is `rise_ratio_x`."""
    return field.replace("profile", name) if "profile" in field else name


_DECLARED: dict[type, tuple[tuple[str, Range, bool], ...]] = {}


def _own_parameters(cls: type) -> tuple[tuple[str, Range, bool], ...]:
    if cls not in _DECLARED:  # reading annotations is slow, and an optimiser makes thousands of instances
        _DECLARED[cls] = tuple(_read_declarations(cls))
    return _DECLARED[cls]


def _read_declarations(cls: type) -> Iterator[tuple[str, Range, bool]]:
    hints = get_type_hints(cls, include_extras=True)
    for field in dataclasses.fields(cls):
        hint = hints[field.name]
        if get_origin(hint) is Annotated:
            base, limits = get_args(hint)[:2]
            yield field.name, limits, base is int


_FLAT: dict[tuple[Any, ...], dict[str, Parameter]] = {}


def _declared(shape: Parametric) -> dict[str, Parameter]:
    """Flat name -> parameter; the same for all of these classes."""
    kinds = _kinds(shape)
    if kinds not in _FLAT:
        _FLAT[kinds] = {p.name: p for p in _flatten(shape)}
    return _FLAT[kinds]


def _kinds(shape: Parametric) -> tuple[Any, ...]:
    """Its class, and the names of fields that hold further parameters with the classes of what they hold."""
    held = ((name, inner) for name, inner in vars(shape).items() if isinstance(inner, Parametric))
    return (type(shape), *((name, _kinds(inner)) for name, inner in held))


def _flatten(shape: Parametric) -> Iterator[Parameter]:
    own = {name: (limits, integer) for name, limits, integer in _own_parameters(type(shape))}
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
    changed = {
        name: _rebuild(getattr(shape, name), new) if isinstance(new, dict) else new for name, new in tree.items()
    }
    return dataclasses.replace(shape, **changed)  # type: ignore[type-var]  # Parametric classes are dataclasses
