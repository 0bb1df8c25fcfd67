"""What comes with an extra is not needed for a fit, and is asked for by name where it is missing."""

import subprocess
import sys
from pathlib import Path

WITHOUT = """
import sys
class Missing:
    def find_spec(self, name, path, target=None):
        if name.partition(".")[0] in ("open3d", "cadquery", "vtk", "vtkmodules", "plotly", "pytest", "mypy"):
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
sys.meta_path.insert(0, Missing())
from vaultcad.cli import main
sys.exit(main())
"""


def run(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", WITHOUT, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_a_fit_needs_no_extra(tmp_path, room):
    ran = run("fit", room, "-o", tmp_path / "out", "--review")
    assert ran.returncode == 0, ran.stderr
    assert len(list((tmp_path / "out").iterdir())) == 11


def test_the_scanner_says_which_extra_it_needs(tmp_path):
    ran = run("scan", "groin", "-o", tmp_path / "scan.laz")
    assert ran.returncode == 2
    assert ran.stderr == 'vaultcad: vaultcad scan needs open3d: pip install "vaultcad[scanner]"\n'
