"""What a file holds short of, or beyond, what its header promises."""

from pathlib import Path

from segmentation.errors import ReadError
from segmentation.io.facts import Facts
from segmentation.notes import count

PADDING = 2
"""Bytes of white space at the end of a file that some programs write, and that can hold no point."""


def truncated(path: Path, promised: int, have: int) -> ReadError:
    """The error for a file with fewer points than promised."""
    return ReadError(path, f"is truncated: {have} of {promised} points are there", "copy it again from where it comes")


def tell_damaged(facts: Facts, what: str) -> None:
    """Say what in the file contradicts itself."""
    facts.tell("damaged", f"the file may be damaged: {what}")


def tell_unended(facts: Facts) -> None:
    """Say that the last line of a text has no end, so that nobody can know whether its last number has."""
    facts.tell("unended", "the last line of the file has no end: if the file was cut there, its last number was too")


def tell_lines(facts: Facts, have: int, promised: int, after: str = "the last point") -> None:
    """Compare the lines that follow the last point with those promised."""
    if have != promised:
        tell_damaged(facts, f"after {after} come {count(have, 'line')}, its header promises {promised:,}")


def tell_bytes(path: Path, facts: Facts, at: int, zeros: int = 0) -> None:
    """Say what follows byte `at` of a binary file, where it should end; so many zero bytes may."""
    extra = path.stat().st_size - at
    if extra <= max(PADDING, zeros):
        with path.open("rb") as file:
            file.seek(at)
            rest = file.read(extra)
            if (extra <= PADDING and not rest.strip()) or (extra <= zeros and not any(rest)):
                return
    tell_damaged(facts, f"{count(extra, 'byte')} follow what its header promises")
