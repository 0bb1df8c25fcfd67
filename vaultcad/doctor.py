"""What of the stack is missing or broken here, and the command that mends it.

Standard library only: it must run where nothing else does, and `tools/system.py` reads LIBRARIES from it before the
set-up.
"""

import importlib.metadata
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

State = Literal["ok", "missing", "broken"]

# Shared libraries of the operating system that the wheels load but do not bring, and the Debian package of each.
LIBRARIES = {
    "libusb-1.0.so.0": "libusb-1.0-0",  # open3d
    "libGL.so.1": "libgl1",  # open3d, OCP, ifcopenshell
    "libEGL.so.1": "libegl1",  # open3d, ifcopenshell
    "libX11.so.6": "libx11-6",  # open3d, OCP
    "libudev.so.1": "libudev1",  # open3d
    "libidn2.so.0": "libidn2-0",  # open3d
    "libexpat.so.1": "libexpat1",  # OCP's fontconfig
    "libsqlite3.so.0": "libsqlite3-0",  # ifcopenshell
    "libgomp.so.1": "libgomp1",  # numba's thread pool that several threads may enter
}


@dataclass(frozen=True)
class Probe:
    """A Python library that vaultcad stands on."""

    name: str
    distribution: str  # as the package index calls it
    imports: str  # statement that fails if the library does not work
    purpose: str
    rival: str = ""  # distribution that overwrites this one's files
    optional: bool = False


@dataclass(frozen=True)
class Program:
    """A program that vaultcad can work with but does not need."""

    name: str
    commands: tuple[str, ...]  # the names it goes by, first found first taken
    package: str  # of Debian
    purpose: str
    script: str = ""  # Python that it runs and that prints its version, where --version is no sign of health


@dataclass(frozen=True)
class Finding:
    """What was found out about one library or program."""

    name: str
    version: str  # empty where unknown
    state: State
    detail: str  # what it is for, or what is wrong with it
    remedy: str  # command that mends it; empty where nothing is to be done
    optional: bool = False  # vaultcad's main job runs without it


# Slowest first, so that the last to finish is a quick one.
PROBES = (
    Probe("build123d", "build123d", "import build123d", "solids"),
    Probe("cadquery", "cadquery", "import cadquery", "CadQuery objects", optional=True),
    Probe("OCP", "cadquery-ocp-novtk", "import OCP.BRepPrimAPI", "the geometry kernel"),
    Probe("open3d", "open3d", "import open3d", "the virtual scanner", optional=True),
    Probe("plotly", "plotly", "import plotly.graph_objects", "3D views in notebooks", optional=True),
    Probe("trimesh", "trimesh", "import trimesh", "meshes and GLB"),
    Probe("manifold3d", "manifold3d", "import manifold3d", "one body a component"),
    Probe("numba", "numba", "import numba", "compiled loops"),
    Probe("scipy", "scipy", "import scipy.optimize, scipy.spatial", "fitting"),
    Probe("ifcopenshell", "ifcopenshell", "import ifcopenshell.geom", "IFC"),
    Probe("ezdxf", "ezdxf", "import ezdxf", "DXF"),
    Probe("laspy", "laspy", "import laspy", "LAS files"),
    Probe("lazrs", "lazrs", "import lazrs", "compressed LAS (LAZ) files"),
    Probe("pye57", "pye57", "import pye57", "E57 files"),
    Probe("numpy", "numpy", "import numpy.linalg", "arrays"),
    Probe("small-gicp", "small-gicp", "import small_gicp", "normals"),
    Probe("typer", "typer", "import typer", "the command line"),
    Probe("rich", "rich", "import rich.progress", "tables and progress bars"),
    Probe("pytest", "pytest", "import pytest", "IFC validation with express rules", optional=True),
)

# In place of OCP where cadquery is, which does not work without.
WITH_VTK = Probe(
    "OCP",
    "cadquery-ocp",
    "import OCP.BRepPrimAPI, OCP.IVtkOCC, vtkmodules.vtkCommonCore",
    "the geometry kernel, with VTK",
    rival="cadquery-ocp-novtk",
)

PROGRAMS = (
    Program(
        "FreeCAD",
        ("freecadcmd", "FreeCADCmd"),
        "freecad",
        "parametric vaults in FreeCAD",
        # 0.20 crashes on --version without a locale, and works all the same
        "import FreeCAD; print('.'.join(FreeCAD.Version()[:3]), flush=True)",
    ),
    Program("Chromium", ("chromium", "chromium-browser", "google-chrome"), "chromium", "pictures of the viewer"),
)


def examine(
    probes: Sequence[Probe] = PROBES, programs: Sequence[Program] = PROGRAMS, *, timeout: float = 60.0
) -> list[Finding]:
    """Try everything that vaultcad uses, each in a process of its own, as an import may crash.

    `timeout` [s] bounds each trial; one that takes longer counts as broken. Findings come in the order of the tables,
    libraries first. Raises nothing: what goes wrong is a finding.
    """
    with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
        vtk = _installed("cadquery") or _installed(WITH_VTK.distribution)
        wanted = [WITH_VTK if vtk and probe.name == WITH_VTK.name else probe for probe in probes]
        libraries = pool.map(lambda probe: examine_library(probe, timeout), wanted)
        found = pool.map(lambda program: examine_program(program, timeout), programs)
        return [*libraries, *found]


def examine_library(probe: Probe, timeout: float) -> Finding:
    """Import one library in a child process, for at most `timeout` [s]."""

    def finding(state: State, detail: str, remedy: str = "") -> Finding:
        return Finding(probe.name, version, state, detail, remedy, probe.optional)

    try:
        version = importlib.metadata.version(probe.distribution)
    except importlib.metadata.PackageNotFoundError:
        version = ""
        return finding("missing", f"not installed; for {probe.purpose}", _pip(probe.distribution))
    # -P: a file of the user's that is called typer.py is not the library.
    failure, said = _failure([sys.executable, "-P", "-c", probe.imports], timeout)
    if not failure:
        return finding("ok", probe.purpose)
    return finding("broken", failure, _remedy(probe, said))


def examine_program(program: Program, timeout: float) -> Finding:
    """Ask one program for its version, for at most `timeout` [s]."""

    def finding(version: str, state: State, detail: str, remedy: str = "") -> Finding:
        return Finding(program.name, version, state, detail, remedy, optional=True)

    path = next(filter(None, map(shutil.which, program.commands)), None)
    if path is None:
        return finding("", "missing", f"not installed; for {program.purpose}", _apt(program.package))
    with tempfile.TemporaryDirectory() as folder:
        script = Path(folder) / "version.py"
        script.write_text(program.script + "\n", encoding="utf-8")
        failure, said = _failure([path, str(script) if program.script else "--version"], timeout)
    if failure:
        return finding("", "broken", failure, _apt("--reinstall", program.package))
    number = re.search(r"\d+(\.\d+)+", said)
    return finding(number[0] if number else "", "ok", program.purpose)


def _failure(command: Sequence[str], timeout: float) -> tuple[str, str]:
    """Why a command failed, in one line ("" where it did not), and all that it said."""
    try:
        run = subprocess.run(
            command,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=timeout,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return f"no answer within {timeout:g} s", ""
    except OSError as error:
        return str(error), ""
    if run.returncode == 0:
        return "", run.stdout
    if run.returncode < 0:
        return f"crashes ({signal.Signals(-run.returncode).name})", run.stderr
    lines = run.stderr.strip().splitlines() or [f"exit status {run.returncode}"]
    return lines[-1][:300], run.stderr


def _remedy(probe: Probe, said: str) -> str:
    """The command for a library that is installed and cannot be imported, from what the import said."""
    if library := re.search(r"(lib[\w.+-]+\.so[.\d]*): cannot open shared object", said):
        return _apt(LIBRARIES.get(library[1], library[1]))
    if probe.rival and _installed(probe.rival):
        return f"{sys.executable} -m pip uninstall -y {probe.rival} && {_pip(probe.distribution, '--force-reinstall')}"
    if module := re.search(r"No module named '([^'.]+)'", said):
        owner = importlib.metadata.packages_distributions().get(module[1], [module[1]])[0]
        return _pip(owner, "--force-reinstall")
    return _pip(probe.distribution, "--force-reinstall")


def _installed(distribution: str) -> bool:
    try:
        importlib.metadata.version(distribution)
    except importlib.metadata.PackageNotFoundError:
        return False
    return True


def _pip(distribution: str, *options: str) -> str:
    """--no-deps, since beside cadquery build123d would bring the OCP without VTK, which overwrites the one with it."""
    return " ".join([sys.executable, "-m pip install --no-deps", *options, f"'{_requirement(distribution)}'"])


def _requirement(distribution: str) -> str:
    """What is asked for, for example "build123d==0.12.0"; the bare name where nobody says."""
    for asking in ("vaultcad", "build123d", "cadquery"):  # the latter ask for OCP
        for requirement in _requires(asking):
            if re.split(r"[^\w.-]", requirement, maxsplit=1)[0] == distribution:
                return requirement.partition(";")[0].strip()
    return distribution


def _requires(distribution: str) -> list[str]:
    try:
        return importlib.metadata.requires(distribution) or []
    except importlib.metadata.PackageNotFoundError:
        return []


def _apt(*arguments: str) -> str:
    if shutil.which("apt-get") is None:
        return f"install {arguments[-1]} with this system's package manager"
    sudo = "" if os.geteuid() == 0 else "sudo "
    return f"{sudo}apt-get install --no-install-recommends {' '.join(arguments)}"
