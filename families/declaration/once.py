"""What follows from a frozen value, worked out once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Generic, Self, TypeVar, overload

Value = TypeVar("Value")


class Once(Generic[Value]):
    """Decorator of a method: a read-only property that is worked out when it is first asked for, and then kept.

    `functools.cached_property` takes a lock for that (until Python 3.12), and a fit asks for millions.
    """

    def __init__(self, method: Callable[[Any], Value]) -> None:
        self.method = method
        self.__doc__ = method.__doc__

    def __set_name__(self, cls: type, name: str) -> None:
        """Learn under which name an instance keeps the value: found there first, as this is no data descriptor."""
        self.name = name

    @overload
    def __get__(self, owner: None, cls: type) -> Self: ...
    @overload
    def __get__(self, owner: object, cls: type) -> Value: ...
    def __get__(self, owner: object, cls: type) -> Self | Value:
        """The value at an instance, the declaration at its class."""
        if owner is None:
            return self
        value: Value = self.method(owner)
        vars(owner)[self.name] = value
        return value
