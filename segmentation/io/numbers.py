"""Numbers as they are written in files: plain digits, no more than can be meant, nothing that only Python reads."""

MISSING = {b"nan", b"-nan", b"-nan(ind)", b"nan(ind)", b"1.#qnan", b"-1.#ind", b"na", b"n/a", b"null", b"none", b"-"}
DIGITS = 18
"""Digits that a count may have: what fits into 63 bits."""


def number_of(word: bytes) -> float:
    """The number that a word is, nan for one that stands for a missing number. Raises ValueError if it is none."""
    if word.lower() in MISSING:
        return float("nan")
    if b"_" in word:  # Python's own way to write numbers, and no one else's
        raise ValueError(f"{word.decode('latin-1')!r} is no number")
    return float(word)


def whole_of(word: bytes | str) -> int:
    """The count that a word is: digits and nothing else. Raises ValueError if it is none."""
    if not (word.isascii() and word.isdigit() and len(word) <= DIGITS):
        text = word if isinstance(word, str) else word.decode("latin-1")
        raise ValueError(f"{text[:DIGITS]!r}{' …' if len(text) > DIGITS else ''} is no count")
    return int(word)
