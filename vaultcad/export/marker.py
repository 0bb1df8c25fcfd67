"""Which files of a result's folder are ours, and which of them a person has changed: a marker tells it by their sums.

Files in folders within it are named with these, as unrolled/vault-1.dxf.
"""

from __future__ import annotations

import json
import os
from collections.abc import Collection, Iterator, Set
from contextlib import suppress
from hashlib import file_digest
from pathlib import Path

MARKER = ".vaultcad.json"
UNFINISHED = ".unfinished"  # in a folder that has never been a result's; names the computer that writes it
REPORT = "report.json"
UNMARKED = (REPORT, "report.html", "model.step", "model.ifc", "model.glb", "model.wld", "segments.laz")
"""What is ours in results from the time before the marker, which are known by their report."""
Sums = dict[str, str | None]  # names of our files and their SHA-256; None where no marker tells it


def mark(part: Path) -> None:
    """Say in a folder that all files in it are ours, as they are now."""
    sums = {name: _sum(part / name) for name in names_in(part) if name != UNFINISHED}
    marker = {"about": "files of a result of vaultcad and their SHA-256", "files": sums}
    (part / MARKER).write_text(json.dumps(marker, indent=1) + "\n", encoding="utf-8")


def marked(folder: Path) -> Sums | None:
    """Which files of a folder are ours; None if it is no result."""
    with suppress(OSError, ValueError, KeyError, TypeError, AttributeError):
        files = json.loads((folder / MARKER).read_text(encoding="utf-8"))["files"]
        return {MARKER: None} | {str(name): told and str(told) for name, told in files.items()}
    with suppress(OSError, ValueError, AttributeError):
        if json.loads((folder / REPORT).read_text(encoding="utf-8")).get("schema") == 1:
            return {name: None for name in UNMARKED if (folder / name).exists()}
    return None


def of_another_kind(ours: Set[str], names: Set[str]) -> str | None:
    """A file of an earlier result that tells that it is of another kind than one of files with these names."""
    if REPORT in ours - names:
        return REPORT
    return min(ours) if ours and not ours & names else None


def losses(folder: Path, names: Collection[str]) -> list[tuple[str, str]]:
    """What would be lost if a result of these files took the place of one, each with the reason."""
    ours = (marked(folder) or {}) if folder.is_dir() else {}
    changed = [n for n, told in ours.items() if told and os.path.lexists(folder / n) and _sum(folder / n) != told]
    folders = {name.partition("/")[0] for name in ours}
    strange = [n for n in sorted({*names} - {*ours} - folders) if os.path.lexists(folder / n)]
    return [(n, "was changed since it was written") for n in changed] + [
        (n, "is not of the earlier result") for n in strange
    ]


def names_in(folder: Path, within: str = "") -> list[str]:
    """Of all that is in a folder and in those within it, but for these themselves."""
    names: list[str] = []
    for path in sorted((folder / within).iterdir()):
        names += names_in(folder, f"{within}{path.name}/") if is_folder(path) else [f"{within}{path.name}"]
    return names


def of_others(folder: Path, ours: Set[str], within: str = "") -> Iterator[str]:
    """The names of what is not ours: folders whole that hold nothing of ours, else what is in them."""
    for path in sorted((folder / within).iterdir()):
        name = f"{within}{path.name}"
        if is_folder(path) and any(one.startswith(f"{name}/") for one in ours):
            yield from of_others(folder, ours, f"{name}/")
        elif name not in ours:
            yield name


def is_folder(path: Path) -> bool:
    """Whether it is a folder, and no link to one."""
    return path.is_dir() and not path.is_symlink()


def _sum(path: Path) -> str | None:
    """None for what is no file."""
    if not path.is_file() or path.is_symlink():
        return None
    with path.open("rb") as file:
        return file_digest(file, "sha256").hexdigest()
