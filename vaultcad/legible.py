"""Names of files, which on Linux are bytes, as text that can be written anywhere."""

from __future__ import annotations

from pathlib import Path


def legible(path: Path) -> Path:
    """The path with a replacement character for each byte that is not UTF-8; to be shown, not to be opened."""
    return Path(str(path).encode("utf-8", "surrogateescape").decode("utf-8", "replace"))
