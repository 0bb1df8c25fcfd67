"""Libraries that take seconds to import, imported while something else is waited for."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from threading import Thread

SOLIDS = ("scipy.spatial", "scipy.ndimage", "families.solid.brep", "manifold3d", "ifcopenshell.api")
"""What a fit needs, in that order."""


def importing(names: tuple[str, ...], then: Callable[[float], None]) -> Callable[[float], None]:
    """A callback for shares 0..1 of some work, which starts to import at the first of them and passes all on.

    Nothing is imported for work that fails at once. A library that is missing is told where it is needed. No process
    forks meanwhile: in that, what was being imported would never end.
    """
    thread = Thread(target=_import, args=(names,))

    def share(done: float) -> None:
        if thread.ident is None:
            thread.start()
            if hasattr(os, "register_at_fork"):
                os.register_at_fork(before=thread.join)
        then(done)

    return share


def _import(names: tuple[str, ...]) -> None:
    for name in names:
        with suppress(ImportError, OSError):
            import_module(name)
