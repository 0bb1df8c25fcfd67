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
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from bench.figures import Figure, Table, clock, label
from families import FAMILIES, Vault
from vaultcad.scanner.draw import draw
from vaultcad.workbench.install import ADD_ON

EDITS, DRAWN = 12, 40
LIMIT = 150  # ms that a rebuild may take
THICKNESS = 0.15  # m
SEED = 6999
BODIES = {"intrados": 0.0, "solid": THICKNESS}
COLUMNS = (
    label("vaults"),
    label("family"),
    label("body"),
    clock("median", "ms", 0),
    clock("95 %", "ms", 0),
    clock("most", "ms", 0),
)


def run(chosen: argparse.Namespace) -> Iterator[Table]:
    """A row for each family and kind of vaults: median, 95th percentile and slowest rebuild of intrados and solid."""
    worker = _client().Worker(sys.executable)
    start = time.perf_counter()
    worker.ask("ping")
    started = f"the worker starts in {time.perf_counter() - start:.1f} s; at most {LIMIT} ms are wanted"
    with tempfile.TemporaryDirectory() as folder:
        yield Table(
            "rebuilds",
            "rebuilds in FreeCAD, from the request to the file that it reads",
            {"edits": EDITS, "drawn": DRAWN, "first seed": SEED},
            COLUMNS,
            _rows(worker, Path(folder) / "shape.brep"),
            [started],
        )
    worker.stop()


def _rows(worker: Any, path: Path) -> Iterator[tuple[Figure, ...]]:
    for title, vaults in (("edited", _edits), ("drawn", _drawn)):
        for cls in FAMILIES:
            for body, thickness in BODIES.items():
                times = [1000 * _rebuild(worker, vault, thickness, path) for vault in vaults(cls)][1:]
                yield title, cls.id, body, float(np.median(times)), float(np.percentile(times, 95)), max(times)


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
