"""Versions of what a result hangs on."""

from __future__ import annotations

import platform
from importlib.metadata import PackageNotFoundError, version

# The proxy is what OCP with VTK and OCP without it have in common, and is of their version.
NAMED = ("vaultcad", "numpy", "scipy", "numba", "build123d", "cadquery-ocp-proxy", "ifcopenshell", "laspy")


def versions() -> dict[str, str]:
    """Package -> version of those that are installed, and Python's."""
    found = {"python": platform.python_version()}
    for name in NAMED:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found
