"""What a benchmark hands over: tables of plain figures, each column with its unit, its good direction and its noise.

How far a figure moves from run to run is declared here, once for each kind of column; `bench.regressions` goes by it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Literal

Figure = str | int | float | None  # None where there is nothing to tell
Better = Literal["more", "less", ""]

CLOCK, PROCESSOR, MEMORY = 0.25, 0.15, 0.10  # relative noise of times on a machine that is not alone, and of memory
IOU = 0.002
LENGTH = 0.15  # of medians of errors and deviations


@dataclass(frozen=True)
class Column:
    """One column. decimals: None for text. names: whether the text tells this row from the others.

    noise: relative change that tells nothing. of: the column with the number of cases, where the figure is a share of
    them, or how many of them; its noise is then that of drawing cases. width: of text, in characters; longer text is
    shown whole.
    """

    name: str
    unit: str = ""
    decimals: int | None = None
    better: Better = ""
    noise: float = 0.0
    of: str = ""
    names: bool = False
    width: int = 14


@dataclass(frozen=True)
class Table:
    """Rows that may come one by one while they are measured, and the notes on them, of which there may be more then.

    settings: what another run must share to be compared: numbers of points and cases, seeds. detail: many rows, which
    are shown and kept but not written into the documentation.
    """

    name: str
    title: str
    settings: Mapping[str, Figure]
    columns: tuple[Column, ...]
    rows: Iterable[tuple[Figure, ...]]
    notes: list[str] = field(default_factory=list)
    detail: bool = False


def label(name: str, width: int = 14) -> Column:
    """Words that tell the row from the others, together with the other labels."""
    return Column(name, names=True, width=width)


def text(name: str) -> Column:
    """Words that were found."""
    return Column(name)


def number(name: str, unit: str = "", decimals: int = 0) -> Column:
    """A figure that is neither good nor bad."""
    return Column(name, unit, decimals)


def clock(name: str, unit: str = "s", decimals: int = 2) -> Column:
    """Time by the clock."""
    return Column(name, unit, decimals, "less", CLOCK)


def processor(name: str, unit: str = "s", decimals: int = 2) -> Column:
    """The processor's time."""
    return Column(name, unit, decimals, "less", PROCESSOR)


def memory(name: str, unit: str = "MiB", decimals: int = 0) -> Column:
    """Memory."""
    return Column(name, unit, decimals, "less", MEMORY)


def iou(name: str, decimals: int = 4) -> Column:
    """Intersection over union."""
    return Column(name, "", decimals, "more", IOU)


def error(name: str, unit: str = "m", decimals: int = 3) -> Column:
    """How far something is off, or may be."""
    return Column(name, unit, decimals, "less", LENGTH)


def share(name: str, of: str, better: Better = "more") -> Column:
    """A share of the cases that another column counts, from 0 to 1."""
    return Column(name, "%", 1, better, of=of)


def count(name: str, of: str, better: Better) -> Column:
    """How many of the cases that another column counts."""
    return Column(name, "", 0, better, of=of)
