"""Edits of a vault in FreeCAD: from the request to the file that FreeCAD reads, by a worker that is warm."""

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

from families import FAMILIES
from vaultcad.workbench.install import ADD_ON

EDITS = 12
LIMIT = 150  # ms that a rebuild may take
THICKNESS = 0.15  # m


def run(chosen: argparse.Namespace) -> None:
    """One row a family: median and slowest milliseconds of an edit, of the intrados and of the solid."""
    worker = _client().Worker(sys.executable)
    start = time.perf_counter()
    worker.ask("ping")
    print(f"\nrebuilds in FreeCAD, {EDITS} edits each, ms; the worker starts in {time.perf_counter() - start:.1f} s")
    print(f"{'vault':8} {'intrados':>9} {'slowest':>8} {'solid':>9} {'slowest':>8}   (at most {LIMIT})")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "shape.brep"
        for cls in FAMILIES:
            columns = []
            for thickness in (0.0, THICKNESS):
                taken = [1000 * _edit(worker, cls.id, k, thickness, path) for k in range(EDITS + 1)][1:]
                columns.append(f"{np.median(taken):9.0f} {max(taken):8.0f}")
            print(f"{cls.id:8} {' '.join(columns)}", flush=True)
    worker.stop()


def _edit(worker: Any, family: str, k: int, thickness: float, path: Path) -> float:
    """Seconds of one edit: a parameter takes a value that it never had."""
    start = time.perf_counter()
    worker.ask("build", family=family, parameters=_edited(family, k), thickness=thickness, path=str(path))
    return time.perf_counter() - start


def _edited(family: str, k: int) -> dict[str, float]:
    """The defaults with one length changed by a little, another each time."""
    cls = next(cls for cls in FAMILIES if cls.id == family)
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
