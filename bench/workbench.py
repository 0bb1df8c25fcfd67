"""Rebuilds of a vault in FreeCAD: from the request to the file that FreeCAD reads, by a worker that is warm.

Edits of one length of the defaults, and vaults drawn over all sizes and profiles, each of which is new to the worker.
"""

from __future__ import annotations

import argparse
import importlib.util
import itertools
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from families import FAMILIES, Vault
from vaultcad.scanner.draw import draw
from vaultcad.workbench.install import ADD_ON

EDITS, DRAWN = 12, 40
LIMIT = 150  # ms that a rebuild may take
THICKNESS = 0.15  # m
SEED = 6999


def run(chosen: argparse.Namespace) -> None:
    """A row for each family and kind of vaults: median, 95th percentile and slowest rebuild of intrados and solid."""
    worker = _client().Worker(sys.executable)
    start = time.perf_counter()
    worker.ask("ping")
    print(f"\nrebuilds in FreeCAD, ms; the worker starts in {time.perf_counter() - start:.1f} s")
    columns = f"{'median':>7} {'95 %':>5} {'most':>5}"
    print(f"{'vault':8} {'intrados':>23} {'solid':>23}\n{'':8} {columns:>23} {columns:>23}   (at most {LIMIT})")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "shape.brep"
        for title, vaults in ((f"{EDITS} edits", _edits), (f"{DRAWN} vaults drawn", _drawn)):
            print(title)
            for cls in FAMILIES:
                rows = [
                    [1000 * _rebuild(worker, vault, thickness, path) for vault in vaults(cls)]
                    for thickness in (0.0, THICKNESS)
                ]
                print(f"{cls.id:8} {' '.join(_told(row[1:]) for row in rows)}", flush=True)
    worker.stop()


def _told(taken: list[float]) -> str:
    return f"{np.median(taken):9.0f} {np.percentile(taken, 95):7.0f} {max(taken):5.0f}"


def _rebuild(worker: Any, vault: Vault, thickness: float, path: Path) -> float:
    """Seconds of one rebuild."""
    asked = {"family": vault.id, "profiles": vault.kinds, "parameters": vault.values()}
    start = time.perf_counter()
    worker.ask("build", **asked, thickness=thickness, path=str(path))
    return time.perf_counter() - start


def _edits(cls: type[Vault]) -> list[Vault]:
    """The defaults with one length changed by a little, another each time; one more, which warms up."""
    return [cls().replaced(_edited(cls, k)) for k in range(EDITS + 1)]


def _drawn(cls: type[Vault]) -> list[Vault]:
    """Vaults as builders made them, of all profiles; one more, which warms up."""
    return [draw(cls, np.random.default_rng(SEED + k))[0] for k in range(DRAWN + 1)]


def _edited(cls: type[Vault], k: int) -> dict[str, float]:
    """The defaults with one length changed by a little, another each time."""
    values = cls().values()
    lengths = itertools.cycle(p.name for p in cls().parameters() if p.range.unit == "m")
    name = next(itertools.islice(lengths, k, None))
    return {**values, name: values[name] * (1 + 0.01 * (k + 1))}


def _client() -> Any:
    """The client in the add-on, which is no package of ours."""
    spec = importlib.util.spec_from_file_location("client", ADD_ON / "freecad" / "vaultcad_wb" / "client.py")
    if spec is None or spec.loader is None:
        raise ImportError(f"{ADD_ON} holds no client")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
