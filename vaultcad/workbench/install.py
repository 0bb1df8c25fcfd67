"""The add-on in FreeCAD's folder for add-ons, with the path of this environment's interpreter."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

from vaultcad.errors import VaultcadError

ADD_ON = Path(__file__).parent / "Mod" / "VaultCad"
INTERPRETER = Path("freecad") / "vaultcad_wb" / "interpreter.txt"
PROGRAMS = ("freecadcmd", "FreeCADCmd")
ASK = "import FreeCAD; print('user data:' + FreeCAD.getUserAppDataDir())"


class InstallError(VaultcadError):
    """The add-on cannot be put into or taken out of a folder."""


def install(mod: Path) -> Path:
    """Put the add-on into a folder for add-ons, in the place of an earlier one; the folder that it is in.

    Raises:
        InstallError: something else is there.
        OSError: it cannot be written.
    """
    target = mod / ADD_ON.name
    if target.exists() and not is_ours(target):
        raise InstallError(f"{target} is something else; move it away, or name another folder with --mod-folder")
    mod.mkdir(parents=True, exist_ok=True)
    part = mod / f".{ADD_ON.name}.{os.getpid()}"
    try:
        shutil.copytree(ADD_ON, part, ignore=shutil.ignore_patterns("__pycache__", INTERPRETER.name))
        (part / INTERPRETER).write_text(sys.executable + "\n", encoding="utf-8")
        if target.exists():
            shutil.rmtree(target)
        part.rename(target)
    finally:
        shutil.rmtree(part, ignore_errors=True)
    return target


def uninstall(mod: Path) -> Path:
    """Take the add-on out again; the folder that it was in.

    Raises:
        InstallError: it is not there.
    """
    target = mod / ADD_ON.name
    if not target.exists() or not is_ours(target):
        raise InstallError(f"{target} holds no add-on of vaultcad's; name the folder with --mod-folder")
    shutil.rmtree(target)
    return target


def is_ours(folder: Path) -> bool:
    """Whether a folder holds this add-on."""
    return (folder / "freecad" / "vaultcad_wb" / "__init__.py").is_file()


def mod_folder() -> Path:
    """The folder for add-ons of the FreeCAD on the path, else of this user by FreeCAD's rules."""
    program = next(filter(None, map(shutil.which, PROGRAMS)), None)
    return (asked(program) if program else None) or by_rule(os.environ, sys.platform, Path.home())


def asked(program: str) -> Path | None:
    """What FreeCAD itself says; None if it does not answer."""
    try:
        run = subprocess.run(
            [program, "-c", ASK], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=30, check=False
        )
    except (OSError, subprocess.TimeoutExpired):
        return None
    said = [line for line in run.stdout.splitlines() if line.startswith("user data:")]
    return Path(said[0].removeprefix("user data:")) / "Mod" if said else None


def by_rule(environment: Mapping[str, str], platform: str, home: Path) -> Path:
    """FreeCAD's rules since 0.20: FREECAD_USER_DATA, FREECAD_USER_HOME, then the system's place for data of programs.

    From 1.1 on there is a folder for each version in it, such as v1-1; the newest is taken.
    """
    if folder := environment.get("FREECAD_USER_DATA"):
        return Path(folder) / "Mod"
    if folder := environment.get("FREECAD_USER_HOME"):
        home = Path(folder)
    match platform:
        case "darwin":
            data = home / "Library" / "Application Support" / "FreeCAD"
        case "win32":
            data = Path(environment.get("APPDATA", home / "AppData" / "Roaming")) / "FreeCAD"
        case _:
            data = Path(environment.get("XDG_DATA_HOME", home / ".local" / "share")) / "FreeCAD"
    versions = sorted(
        (path for path in data.glob("v*-*") if path.is_dir()),
        key=lambda path: [int(part) for part in path.name[1:].split("-") if part.isdigit()],
    )
    return (versions[-1] if versions else data) / "Mod"
