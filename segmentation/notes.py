"""What was assumed, left out or changed on the way, for people to read: one line each."""

from typing import NamedTuple


class Note(NamedTuple):
    """One such thing. code: what kind it is, for programs; text: one line, for people."""

    code: str
    text: str


def count(number: int, what: str) -> str:
    """A number of things in words: "1 point", "1,200 points"."""
    return f"{number:,} {what}{'' if number == 1 else 's'}"
