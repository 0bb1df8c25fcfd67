"""The line of names above columns of numbers: what each column holds, in the languages that surveyors write.

A header is understood whole or not at all: coordinates that are guessed past one come out mirrored, or are no
coordinates.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

from segmentation.io.column_names import COORDINATES, GEOGRAPHIC, NAMES, NORTHERN
from segmentation.units import plain_words, unit_named

UNKNOWN = "?"
"""What stands for a unit that is not known."""
DATUMS = {
    *("nn", "nhn", "msl", "asl", "navd88", "nap", "egm96", "egm2008", "ellipsoid", "m u nn", "m asl"),
    *("local", "world", "up", "wgs84", "utm"),
}
"""What else stands in brackets after a coordinate."""
SCALAR = "scalar "
"""CloudCompare puts this in front of the names of its scalar fields."""


@dataclass(frozen=True)
class Header:
    """A line of names that is understood.

    kinds: what each column holds, "" for what is of no use; x, y and z are among them. units: of x, y and z by their
    names, where said. line: as it stands there. words: the names in plain words.
    """

    kinds: tuple[str, ...]
    units: dict[str, str]
    line: str
    words: tuple[str, ...] = ()

    @property
    def bare(self) -> bool:
        """Whether its y is no more than that, and may point east where x points north."""
        return bool(self.words) and self.words[self.at["y"]] not in NORTHERN

    @property
    def at(self) -> dict[str, int]:
        """Column of each thing that is there."""
        return {kind: k for k, kind in enumerate(self.kinds) if kind}

    @property
    def order(self) -> str:
        """How the columns are taken: "y x z -"."""
        return " ".join(kind or "-" for kind in self.kinds)


class NotUnderstoodError(ValueError):
    """A header that names columns in a way that leaves open what is where; the message says why.

    coordinates: how many of x, y and z it names all the same.
    """

    def __init__(self, why: str, coordinates: int = len(COORDINATES)) -> None:
        super().__init__(why)
        self.coordinates = coordinates


def understood(line: str, width: int, delimiter: str) -> Header | None:
    """The header that a line is above rows of `width` columns; None if it names no coordinates at all.

    Raises NotUnderstoodError if it does, or is no comment, but not all three are there and plain.
    """
    comment = line.lstrip().startswith(("#", "//"))
    bare = line.strip().lstrip("#/;%! ").strip()
    problem = ""
    for names in _splits(bare, width, delimiter):
        try:
            found = _meant(names, bare)
        except NotUnderstoodError as error:
            # A comment may have such words by chance.
            strange = sum(plain_words(name) not in NAMES for name in names)
            chance = comment and (error.coordinates < 2 or strange >= error.coordinates)
            problem = problem or ("" if chance else str(error))
            continue
        if found is not None:
            return found
        problem = problem or ("" if comment else "it names no x, y and z")
    words = [plain_words(word) for word in re.split(r"[\s,;|]+", bare)]
    words = [word for word in words if word]
    known = all(word in NAMES or word in GEOGRAPHIC for word in words)
    if sum(word in GEOGRAPHIC for word in words) > 1 and (known or not comment):
        raise NotUnderstoodError("it names longitude and latitude, which are degrees")
    if problem:
        raise NotUnderstoodError(problem)
    meant = [NAMES[word] for word in words if NAMES.get(word) in COORDINATES]
    # A comment may have such words by chance; one that has nothing else names columns.
    if len(set(meant)) > 1 and (known or not comment) and meant[:3] != list(COORDINATES):
        raise NotUnderstoodError(f"it names another number of columns than the {width} that there are")
    return None


def names_of(columns: str) -> Header:
    """The header that a user says with `--columns`, as "y,x,z,-,r,g,b".

    Raises NotUnderstoodError if a name is unknown, or x, y and z are not all there.
    """
    names = [name.strip() for name in re.split(r"[,;\s]+", columns.strip())]
    unknown = [n for n in names if n not in ("-", "_") and plain_words(n) not in NAMES]
    if unknown:
        known = "x y z r g b nx ny nz intensity classification"
        raise NotUnderstoodError(f"{unknown[0]!r} names no column; name each of them by one of {known}, or -")
    found = _meant(["" if n in ("-", "_") else n for n in names], columns)
    if found is None:
        raise NotUnderstoodError("x, y and z are not all named")
    return found


def _splits(line: str, width: int, delimiter: str) -> Iterator[list[str]]:
    """Ways to cut a line into so many names."""
    for mark in dict.fromkeys((delimiter, "\t", ";", ",", "|")):
        if mark.strip() or mark == "\t":
            cells = [cell.strip().strip("\"'") for cell in _cells(line, mark)]
            if len(cells) == width + 1 and not cells[-1]:
                cells.pop()
            if len(cells) == width:
                yield cells
                return
    words = [word.strip("\"',;") for word in re.findall(r"\"[^\"]*\"|\S+", line)]
    joined = _with_units(words)
    if len(joined) == width:
        yield joined
    elif len(joined) > width:
        runs = (list(run) for run in _runs(joined, width))
        yield from (run for run in runs if all(plain_words(name) in NAMES for name in run))


def _cells(line: str, mark: str) -> list[str]:
    """Cut at a mark outside quotes."""
    return re.findall(rf"(?:^|{re.escape(mark)})((?:\"[^\"]*\"|[^{re.escape(mark)}])*)", line)


def _with_units(words: Sequence[str]) -> list[str]:
    """Words with the units in brackets that follow them: "x", "[m]" -> "x [m]"; and names of two or three words."""
    out: list[str] = []
    k = 0
    while k < len(words):
        for length in (3, 2):
            name = " ".join(words[k : k + length])
            if k + length <= len(words) and plain_words(name) in NAMES:
                out.append(name)
                k += length
                break
        else:
            out.append(words[k])
            k += 1
        if k < len(words) and re.fullmatch(r"[\[(].*[\])]", words[k]):
            out[-1] += " " + words[k]
            k += 1
    return out


def _runs(words: Sequence[str], width: int) -> Iterator[Sequence[str]]:
    """The last, then the first so many words: "order: N E Z", "x y z in metres"."""
    yield words[-width:]
    yield words[:width]


def _meant(names: Sequence[str], line: str) -> Header | None:
    """What columns of these names hold; None if none of them is a coordinate."""
    plain, units = [], []
    for name in names:
        word, unit = _name_and_unit(name)
        plain.append(word)
        units.append(unit)
    if any(word in GEOGRAPHIC for word in plain):
        raise NotUnderstoodError("it names longitude and latitude, which are degrees")
    kinds = [NAMES.get(word) for word in plain]
    kinds = _in_context(plain, kinds)
    if not any(kind in COORDINATES for kind in kinds):
        return None
    at: dict[str, int] = {}
    for k, kind in enumerate(kinds):
        if kind and kind in at:
            if kind in COORDINATES:
                raise NotUnderstoodError(f"both {names[at[kind]]!r} and {names[k]!r} may be {kind}")
        elif kind:
            at[kind] = k
    missing = [axis for axis in COORDINATES if axis not in at]
    if missing:
        raise NotUnderstoodError(f"no column is known to be {' or '.join(missing)}", 3 - len(missing))
    said = {axis: unit for axis in COORDINATES if (unit := units[at[axis]]) is not None}
    own = tuple(kind if kind and at[kind] == k else "" for k, kind in enumerate(kinds))
    for axis in COORDINATES:
        if units[at[axis]] == UNKNOWN:
            raise NotUnderstoodError(f"{names[at[axis]]!r} has a unit that is not known")
    return Header(own, said, line, tuple(plain))


def _in_context(plain: Sequence[str], kinds: Sequence[str | None]) -> list[str | None]:
    """Letters that mean one thing beside some names and another beside others.

    R is red where G and B are, else Rechtswert; H is Hochwert beside it, else a height; N is a number where y is.
    """
    found, have = list(kinds), set(plain)
    if "r" in have and not {"g", "b"} <= have and "x" not in kinds:
        found[plain.index("r")] = "x"
        if ("h" in have and kinds.count("z") > 1) or ("h" in have and "y" not in kinds):
            found[plain.index("h")] = "y"
    for letter, axis in (("n", "y"), ("e", "x")):
        if letter in have and kinds.count(axis) > 1:
            found[plain.index(letter)] = ""
    return found


def _name_and_unit(name: str) -> tuple[str, str | None]:
    """A column's name in plain words, and its unit: "Northing (ft)" -> "northing", "ft"."""
    bracket = re.search(r"[\[(]([^\])]*)[\])]", name)
    word = plain_words(name[: bracket.start()] + name[bracket.end() :] if bracket else name)
    unit = _unit_in(bracket[1], word) if bracket else None
    if word.startswith(SCALAR) and word not in NAMES:
        word = word.removeprefix(SCALAR)
    if word not in NAMES and unit is None and " " in word:
        head, _, last = word.rpartition(" ")
        if head in NAMES and unit_named(last):
            return head, unit_named(last)
    return word, unit


def _unit_in(text: str, word: str) -> str | None:
    """The unit in brackets after a coordinate's name; UNKNOWN if it may be one that is not known.

    Raises NotUnderstoodError if the brackets name another coordinate than the word before them.
    """
    unit = unit_named(text) or unit_named((text.split() or [""])[0])
    if unit or NAMES.get(word) not in COORDINATES:
        return unit
    meant = NAMES.get(plain_words(text))
    if meant in COORDINATES and meant != NAMES[word]:
        raise NotUnderstoodError(f"'{word} ({text})' names two coordinates")
    return None if meant in COORDINATES or plain_words(text) in DATUMS else UNKNOWN


def units_of(line: str, delimiter: str) -> list[str | None] | None:
    """The units that a line of nothing else names, as some put under the names: "[m];[m];[m]"; else None.

    None among them is for columns that have none: "-;mm;mm;mm", ";[ft];[ft];[ft]".
    """
    bare = line.strip().lstrip("#/%!")
    cells = [cell.strip().strip("[]()\"'") for cell in (bare.split(delimiter) if delimiter.strip() else bare.split())]
    units = [unit_named(cell) for cell in cells]
    fine = all(unit or cell in ("", "-", "1") for unit, cell in zip(units, cells, strict=True))
    return units if fine and any(units) else None


def swapped(at: dict[str, int]) -> bool:
    """Whether y stands right before x, as geodesists of some countries put it, whose x points north."""
    return any(first == at["y"] and second == at["x"] for first, second in pairwise(sorted(at.values())))
