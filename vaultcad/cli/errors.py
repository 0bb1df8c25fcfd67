"""What the user gave wrongly, as an exception of the command line's own."""

from collections.abc import Iterator
from contextlib import contextmanager


class InputError(Exception):
    """An argument or option that cannot be served; the message names it, its value and the way out."""


@contextmanager
def refusing() -> Iterator[None]:
    """A ValueError in here is about what the user gave. Put nothing in it but the making of that very value."""
    try:
        yield
    except ValueError as error:
        raise InputError(str(error)) from error
