"""A run of benchmarks as plain values: its figures, and what they were measured with; JSON to and fro."""

from __future__ import annotations

import json
import os
import platform
import subprocess
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field
from datetime import date
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from bench.figures import Column, Table

SCHEMA = 1
PACKAGES = ("vaultcad", "numpy", "scipy", "numba", "build123d", "laspy")
ROOT = Path(__file__).parents[1]


@dataclass(frozen=True)
class Record:
    """One run. machine: cores, memory, processor and system, and no name. benchmarks: name -> tables.

    load: how many processes wanted the processor in the minute before, those of others with them.
    """

    date: str
    machine: dict[str, str | int]
    versions: dict[str, str]
    revision: str
    load: float
    benchmarks: dict[str, tuple[Table, ...]] = field(default_factory=dict)

    @classmethod
    def here(cls) -> Record:
        """Of today and of this machine, still empty."""
        return cls(date.today().isoformat(), _machine(), _versions(), _revision(), round(os.getloadavg()[0], 1))

    def write(self, path: Path) -> None:
        """Leave it as JSON."""
        path.write_text(json.dumps({"schema": SCHEMA, **asdict(self)}, indent=1) + "\n", encoding="utf-8")

    @classmethod
    def read(cls, path: Path) -> Record:
        """What `write` left.

        Raises:
            ValueError: the file holds something else; names it.
        """
        try:
            told = json.loads(path.read_text(encoding="utf-8"))
            if told.pop("schema") != SCHEMA:
                raise ValueError(f"{path} has another schema than {SCHEMA}")
            benchmarks = {name: tuple(map(_table, tables)) for name, tables in told.pop("benchmarks").items()}
            return cls(**told, benchmarks=benchmarks)
        except (OSError, json.JSONDecodeError, KeyError, TypeError, AttributeError) as error:
            raise ValueError(f"{path} holds no figures of `python -m bench --json`: {error}") from error

    @property
    def told(self) -> str:
        """Date, machine and code in one line."""
        machine = "{cores} cores, {memory_gib} GiB, {processor}, {system}".format(**self.machine)
        code = f"Python {self.versions['python']}, revision {self.revision}"
        return f"{self.date}, {machine}, load {self.load:g} before, {code}"


def _table(told: dict[str, Any]) -> Table:
    columns = tuple(Column(**column) for column in told.pop("columns"))
    rows: Iterable[list[Any]] = told.pop("rows")
    return Table(**told, columns=columns, rows=tuple(map(tuple, rows)))


def _machine() -> dict[str, str | int]:
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    return {
        "cores": os.cpu_count() or 1,
        "memory_gib": round(memory),
        "processor": _processor(),
        "system": f"{platform.system()} {platform.machine()}",
    }


def _processor() -> str:
    """The processor's model as Linux tells it."""
    try:
        told = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        told = []
    names = (line.partition(":")[2].strip() for line in told if line.startswith("model name"))
    return next(names, platform.processor() or "unknown processor")


def _versions() -> dict[str, str]:
    found = {"python": platform.python_version()}
    for name in PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "not installed"
    return found


def _revision() -> str:
    """The commit, with a plus if files were changed since; "unknown" outside a clone."""
    command = ["git", "-C", str(ROOT), "describe", "--always", "--dirty=+", "--exclude=*"]
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
