"""Runs scripts in the FreeCAD of this machine, with the add-on in a home of its own."""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from vaultcad.workbench.install import by_rule, install

INSIDE = Path(__file__).parent / "inside"
ROOT = Path(__file__).parents[3]
PACKAGES = "apt-get install --no-install-recommends freecad-python3 xvfb xauth"
PATIENCE = 300  # [s]
PICTURES = "VAULTCAD_PICTURES"  # environment variable: a folder to which pictures of the window are copied


def _needed(*names: str) -> str:
    """The program by the first of its names that is there; skips the test where none is."""
    found = next(filter(None, map(shutil.which, names)), None)
    if found is None:
        pytest.skip(f"{names[0]} is not installed: {PACKAGES}")
    return found


@pytest.fixture(scope="session")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A home in whose FreeCAD the add-on is installed."""
    home = tmp_path_factory.mktemp("home")
    install(by_rule({}, sys.platform, home))
    return home


Run = Callable[..., dict[str, Any]]


@pytest.fixture
def in_freecad(home: Path, tmp_path: Path) -> Run:
    """Run a script of inside/ in FreeCAD without a window: what it found, and `said`, all that was printed."""
    program = _needed("freecadcmd", "FreeCADCmd")

    def run(script: str, home: Path = home, **given: object) -> dict[str, Any]:
        return _run([program], script, home, tmp_path, given)

    return run


@pytest.fixture
def in_window(home: Path, tmp_path: Path) -> Run:
    """The same in FreeCAD's window, on a screen that nobody sees."""
    screen, program = _needed("xvfb-run"), _needed("freecad", "FreeCAD")
    _needed("xauth")

    def run(script: str, **given: object) -> dict[str, Any]:
        command = [screen, "-a", "-s", "-screen 0 1400x900x24", program]
        found = _run(command, script, home, tmp_path, given)
        if folder := os.environ.get(PICTURES):
            for picture in tmp_path.glob("*.png"):
                small = Image.open(picture).convert("RGB").quantize(256, kmeans=1)
                small.save(Path(folder) / picture.name, optimize=True)
        return found

    return run


def _run(command: list[str], script: str, home: Path, folder: Path, given: dict[str, object]) -> dict[str, Any]:
    given = {"folder": str(folder), "root": str(ROOT), **given}
    result = folder / f"{script}.json"
    env = {name: value for name, value in os.environ.items() if not name.startswith(("XDG_", "FREECAD_"))}
    env |= {
        "HOME": str(home),
        "VAULTCAD_GIVEN": json.dumps(given),
        "VAULTCAD_RESULT": str(result),
        "PYTHONPATH": str(INSIDE),
        "QTWEBENGINE_DISABLE_SANDBOX": "1",  # its start page refuses to run as root otherwise
    }
    done = subprocess.run(
        [*command, str(INSIDE / f"{script}.py")],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        env=env,
        cwd=folder,
        timeout=PATIENCE,
        check=False,
    )
    assert result.exists(), done.stdout[-5000:]
    found = json.loads(result.read_text(encoding="utf-8"))
    assert "failed" not in found, found["failed"] + done.stdout[-3000:]
    return {**found, "said": done.stdout}
