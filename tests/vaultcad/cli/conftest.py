"""Runs the program in this process, and a small scan for it."""

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from segmentation.io import write_cloud
from vaultcad.cli import main


@dataclass(frozen=True)
class Outcome:
    """What a run of the program came to."""

    code: int
    out: str
    err: str

    @property
    def complaint(self) -> str:
        """The one line on standard error of a run that was refused."""
        assert self.code == 2, self
        assert self.err.count("\n") == 1, self.err
        assert self.err.startswith("vaultcad: "), self.err
        assert "Traceback" not in self.out + self.err
        assert self.out == ""
        return self.err.rstrip("\n")


Run = Callable[..., Outcome]


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Run:
    """Run the program with those arguments."""
    monkeypatch.delenv("VAULTCAD_DEBUG", raising=False)
    monkeypatch.setenv("COLUMNS", "200")

    def run(*arguments: object) -> Outcome:
        capsys.readouterr()
        code = main([str(a) for a in arguments])
        said = capsys.readouterr()
        return Outcome(code, said.out, said.err)

    return run


@pytest.fixture(scope="session")
def assumed() -> str:
    """What is said of a scan that states no unit."""
    return "vaultcad: unit: metre, which is assumed, for the file states none; --unit says otherwise\n"


@pytest.fixture
def cube(tmp_path: Path) -> Path:
    """Points on the six sides of a room without a vault."""
    rng = np.random.default_rng(1)
    xyz = rng.random((6, 5_000, 3))
    for side in range(6):
        xyz[side, :, side // 2] = side % 2
    path = tmp_path / "cube.ply"
    write_cloud(path, (xyz * [6.0, 5.0, 4.0] + rng.normal(0, 0.002, xyz.shape)).reshape(-1, 3))
    return path


def tree(folder: Path) -> dict[str, tuple[int, int]]:
    """All that is under a folder: what is left behind shows as a difference."""
    found = {}
    for at, folders, files in os.walk(folder):
        for name in (*folders, *files):
            stat = (Path(at) / name).lstat()
            found[str(Path(at) / name)] = (
                stat.st_mtime_ns if name in files else 0,
                stat.st_size if name in files else 0,
            )
    return found


@pytest.fixture
def untouched(tmp_path: Path) -> Callable[[], bool]:
    """Whether all is as it was when first asked."""
    before: list[dict[str, tuple[int, int]]] = []

    def same() -> bool:
        before.append(tree(tmp_path))
        return before[0] == before[-1]

    return same
