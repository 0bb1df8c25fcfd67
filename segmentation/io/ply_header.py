"""What the header of a PLY file says: the elements, their properties, where the vertices lie."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from segmentation.errors import ReadError
from segmentation.io.facts import Facts
from segmentation.io.numbers import whole_of
from segmentation.io.records import XYZ, tell_order, unique
from segmentation.io.rest import truncated

TYPES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4",
    "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4",
    "float": "f4", "double": "f8", "float32": "f4", "float64": "f8",
}  # fmt: skip
ORDERS = {"ascii": "=", "binary_little_endian": "<", "binary_big_endian": ">"}
MOST_RECORDS = 1 << 40
"""Records that no file holds."""
LINES = 10_000
"""Lines that a header may have, and bytes that a line may have."""
WORD = 2
"""Bytes of a number in a text, at least, with the space after it."""
WAY_OUT = "export the scan again as PLY, E57 or LAZ"


@dataclass(frozen=True)
class Property:
    """One property of an element: the type of its values and, of a list, that of the number before them."""

    name: str
    kind: np.dtype[np.generic]
    length: np.dtype[np.generic] | None = None


@dataclass(frozen=True)
class Element:
    """One element of a file: so many records of these properties."""

    name: str
    count: int
    properties: tuple[Property, ...]

    @property
    def dtype(self) -> np.dtype[np.void]:
        """Of a record without its lists, names in small letters."""
        plain = [p for p in self.properties if p.length is None]
        return np.dtype(list(zip(unique(p.name for p in plain), (p.kind for p in plain), strict=True)))

    @property
    def has_lists(self) -> bool:
        """Whether its records differ in length."""
        return any(p.length is not None for p in self.properties)

    def shortest(self, encoding: str) -> int:
        """Bytes of a record, at least: its lists are empty, its numbers of one digit."""
        if encoding == "ascii":
            return WORD * len(self.properties)
        return sum((p.length or p.kind).itemsize for p in self.properties)


@dataclass(frozen=True)
class PlyLayout:
    """Where the vertices lie in a file, and how.

    start: bytes of the header. before, after: other elements that have records, before the vertices and after them.
    """

    encoding: str
    start: int
    before: tuple[Element, ...]
    vertex: Element
    after: tuple[Element, ...]

    @property
    def dtype(self) -> np.dtype[np.void]:
        """Of a vertex without its lists."""
        return self.vertex.dtype


def layout_of(path: Path, facts: Facts) -> PlyLayout:
    """What the header says of the vertices.

    Raises ReadError if it makes no sense, or promises more vertices, or more before them, than the file has room for.
    """
    with path.open("rb") as file:
        lines: list[list[str]] = []
        while ["end_header"] not in lines[-1:]:
            line = file.readline(LINES)
            if not line or len(lines) > LINES:
                raise ReadError(path, "has no whole PLY header", WAY_OUT)
            lines.append(line.decode("latin-1").split())
        start = file.tell()
    try:
        encoding, elements = _understood(lines, facts)
    except (KeyError, ValueError, IndexError) as error:
        raise ReadError(path, f"its PLY header makes no sense ({error})", WAY_OUT) from error
    k = next((k for k, e in enumerate(elements) if e.name == "vertex"), None)
    if k is None or not set(XYZ) <= set(elements[k].dtype.names or ()):
        raise ReadError(path, "has no vertices with x, y and z", WAY_OUT)
    tell_order(facts, elements[k].dtype.names or ())
    before, after = ([e for e in those if e.count and e.properties] for those in (elements[:k], elements[k + 1 :]))
    layout = PlyLayout(encoding, start, tuple(before), elements[k], tuple(after))
    room = path.stat().st_size - start + 1  # the last line of a text may lack its end
    room -= sum(e.count * e.shortest(encoding) for e in before)
    if layout.vertex.count * layout.vertex.shortest(encoding) > room:
        raise truncated(path, layout.vertex.count, max(room, 0) // layout.vertex.shortest(encoding))
    return layout


def _understood(lines: list[list[str]], facts: Facts) -> tuple[str, list[Element]]:
    """Encoding and elements of a header in words. Raises ValueError or KeyError, with what makes no sense."""
    encoding, order = "", ""
    found: list[tuple[str, int, list[Property]]] = []
    for words in lines[1:-1]:
        match words:
            case [] | ["obj_info"] | ["comment"]:
                pass
            case ["comment" | "obj_info", *said]:
                facts.listen(" ".join(said))
            case ["format", kind, *_] if not encoding and not found:
                encoding, order = kind, ORDERS[kind]
            case ["element", name, number] if encoding:
                found.append((name.lower(), _count(number), []))
            case ["property", "list", length, kind, name]:
                found[-1][2].append(Property(name, np.dtype(order + TYPES[kind]), _whole(order + TYPES[length])))
            case ["property", kind, name]:
                found[-1][2].append(Property(name, np.dtype(order + TYPES[kind])))
            case ["element", *_] if not encoding:
                raise ValueError("no line 'format' before its elements")
            case _:
                raise ValueError(f"a line {' '.join(words)[:40]!r}")
    elements = [Element(name, count, tuple(properties)) for name, count, properties in found]
    if sum(e.name == "vertex" for e in elements) > 1:
        raise ValueError("two elements 'vertex'")
    for element in elements:
        names = [p.name.lower() for p in element.properties]
        twice = next((axis for axis in XYZ if element.name == "vertex" and names.count(axis) > 1), None)
        if twice:
            raise ValueError(f"two properties {twice!r}")
    return encoding, elements


def _count(text: str) -> int:
    number = whole_of(text)
    if number >= MOST_RECORDS:
        raise ValueError(f"{text} records")
    return number


def _whole(kind: str) -> np.dtype[np.generic]:
    if kind[1] == "f":
        raise ValueError("the length of a list is no whole number")
    return np.dtype(kind)
