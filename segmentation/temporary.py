"""Names of what is not whole yet, told before it is there to whoever cleans up should this process be killed."""

from collections.abc import Callable
from pathlib import Path

_listeners: list[Callable[[Path], None]] = []


def listen(tell: Callable[[Path], None]) -> None:
    """From now on `tell` gets each such name."""
    _listeners.append(tell)


def announce(path: Path) -> None:
    """A file or folder of that name is about to be made, and is nothing to keep unless this process ends well."""
    for tell in _listeners:
        tell(path.absolute())
