"""What reading and writing a cloud can raise."""

from __future__ import annotations

from pathlib import Path

COPY_AGAIN = "copy it again from where it comes from, or export the scan again"
"""The way out of a file that is damaged."""


class ReadError(ValueError):
    """A file that cannot be read as a point cloud. The message is one line: the file, what is wrong, the way out."""

    def __init__(self, path: Path | str, wrong: str, way_out: str) -> None:
        super().__init__(" ".join(f"{path}: {wrong}; {way_out}".split()))
        self.path = Path(path)


class WriteError(OSError):
    """A file that the system, or a library, could not write. The message is one line: the file, why, the way out."""

    def __init__(self, path: Path | str, reason: str) -> None:
        super().__init__(" ".join(f"{path}: could not be written ({reason}); free space on the disk".split()))
        self.path = Path(path)
        self.reason = reason

    def __reduce__(self) -> tuple[type[WriteError], tuple[Path, str]]:
        """What another process makes it of again."""
        return type(self), (self.path, self.reason)
