"""Files made wrong: numbers of headers, bytes, lines, sectors of a disk; each mutant is told by its seed."""

from __future__ import annotations

import re
import struct
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from fuzz.pages import paged, with_xml, xml_of
from fuzz.samples import Sample

WHOLE = (0, 1, -1, 2, 255, 65535, 2**31 - 1, 2**31, 2**32 - 1, 2**62, 2**63 - 1)
REAL = (0.0, -1.0, 1e-300, 1e26, 1e308, float("nan"), float("inf"), -float("inf"), 0.5, 1000.0)
WRITTEN = (
    "0", "1", "-1", "2", "65535", "2147483648", "4294967295", "9223372036854775807", "100000000000000000000000000",
    "1e26", "nan", "inf", "-inf", "1e999", "1_000", "0x10", "9" * 5000, "", "1.5", "x", "\u0663", "--1",
)  # fmt: skip
NUMBER = re.compile(rb"(?<![\w.])[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")
WORD = re.compile(rb"[A-Za-z_]\w*")
SECTORS = (512, 4096)
Rng = np.random.Generator


def mutant(sample: Sample, seed: int, kinds: tuple[str, ...] = ()) -> tuple[str, bytes]:
    """A kind of damage, and the sample with it; kinds: those to choose from, all that it can have by default."""
    rng = np.random.default_rng(seed)
    able = [kind for kind in kinds or KINDS if kind not in FITS or FITS[kind](sample)]
    kind = str(rng.choice(able))
    return kind, KINDS[kind](sample, rng)


def _file(sample: Sample, data: bytes) -> bytes:
    return paged(data) if sample.paged else data


def _field(sample: Sample, rng: Rng) -> bytes:
    """One or two numbers of a binary header."""
    out = bytearray(sample.data)
    for _ in range(int(rng.integers(1, 3))):
        at, layout = sample.fields[int(rng.integers(len(sample.fields)))]
        (value,) = struct.unpack_from(layout, out, at)
        struct.pack_into(layout, out, at, _other(value, layout, rng))
    return _file(sample, bytes(out))


def _other(value: float, layout: str, rng: Rng) -> float:
    if layout[1] == "d":
        choices = (*REAL, -value, 2 * value, value / 2, value + 1, np.nextafter(value, np.inf))
        return float(choices[int(rng.integers(len(choices)))])
    number = int(value)
    numbers = (*WHOLE, number + 1, number - 1, 2 * number, number // 2, number ^ (1 << int(rng.integers(8))))
    bits = 8 * struct.calcsize(layout)
    whole = numbers[int(rng.integers(len(numbers)))] % (1 << bits)
    return whole - (1 << bits) if layout[1].islower() and whole >= 1 << (bits - 1) else whole


def _swapped_fields(sample: Sample, rng: Rng) -> bytes:
    """Two numbers of a binary header change places."""
    out = bytearray(sample.data)
    at, layout = sample.fields[int(rng.integers(len(sample.fields)))]
    alike = [place for place, other in sample.fields if other == layout]
    to, size = int(rng.choice(alike)), struct.calcsize(layout)
    out[at : at + size], out[to : to + size] = out[to : to + size], out[at : at + size]
    return _file(sample, bytes(out))


def _header_of(sample: Sample) -> slice:
    """Where the words of a header are."""
    return xml_of(sample.data) if sample.paged else slice(0, sample.head)


def _put(sample: Sample, text: bytes) -> bytes:
    if sample.paged:
        return paged(with_xml(sample.data, text))
    return text + sample.data[sample.head :]


def _words(sample: Sample, rng: Rng) -> bytes:
    """A number or a word of a header that is text becomes another, or two change places."""
    text = sample.data[_header_of(sample)]
    found = [m.span() for m in (NUMBER if rng.random() < 0.75 else WORD).finditer(text)]
    if not found:
        return _lines(sample, rng)
    start, end = found[int(rng.integers(len(found)))]
    word = text[start:end]
    if rng.random() < 0.2:
        a, b = found[int(rng.integers(len(found)))]
        new = text[a:b]
    elif NUMBER.fullmatch(word) and rng.random() < 0.3 and word.isdigit() and len(word) < 18:
        new = str(int(word) + int(rng.choice([-1, 1, int(word)]))).encode()
    else:
        new = WRITTEN[int(rng.integers(len(WRITTEN)))].encode()
    return _put(sample, text[:start] + new + text[end:])


def _lines(sample: Sample, rng: Rng) -> bytes:
    """Lines of a text, or of a header that is text, are dropped, doubled or change places."""
    whole = sample.text and rng.random() < 0.5
    text = sample.data if whole else sample.data[_header_of(sample)]
    lines = text.splitlines(keepends=True)
    k = int(rng.integers(len(lines)))
    number = int(rng.integers(1, 4))
    match int(rng.integers(3)):
        case 0:
            del lines[k : k + number]
        case 1:
            lines[k:k] = lines[k : k + number]
        case _:
            other = int(rng.integers(len(lines)))
            lines[k], lines[other] = lines[other], lines[k]
    changed = b"".join(lines)
    return changed if whole else _put(sample, changed)


def _bytes(sample: Sample, rng: Rng, low: int, high: int) -> bytes:
    out = bytearray(sample.data)
    for _ in range(int(rng.integers(1, 5))):
        out[int(rng.integers(low, high))] = int(rng.integers(256))
    return _file(sample, bytes(out))


def _head_bytes(sample: Sample, rng: Rng) -> bytes:
    where = _header_of(sample) if rng.random() < 0.7 else slice(0, sample.head)
    return _bytes(sample, rng, where.start, where.stop)


def _cut(sample: Sample, rng: Rng) -> bytes:
    data = _file(sample, sample.data)
    size = int(rng.choice([1, *SECTORS]))
    at = int(rng.integers(1, len(data))) // size * size
    return data[: max(1, at)]


def _appended(sample: Sample, rng: Rng) -> bytes:
    data = _file(sample, sample.data)
    size = int(rng.choice([1, 2, 12, 100, 512, 4096]))
    more = (bytes(size), rng.bytes(size), data[-size:])
    return data + more[int(rng.integers(len(more)))]


def _sector(data: bytes | bytearray, rng: Rng) -> tuple[int, int]:
    size = int(rng.choice(SECTORS))
    return int(rng.integers(0, max(1, len(data) // size))) * size, size


def _zeroed(sample: Sample, rng: Rng) -> bytes:
    data = bytearray(_file(sample, sample.data))
    at, size = _sector(data, rng)
    end = min(len(data), at + size)
    data[at:end] = bytes(end - at)
    return bytes(data)


def _doubled(sample: Sample, rng: Rng) -> bytes:
    """A sector stands over another, or once more behind itself, or is lost."""
    data = _file(sample, sample.data)
    at, size = _sector(data, rng)
    to = int(rng.integers(0, max(1, len(data) // size))) * size
    match int(rng.integers(3)):
        case 0:
            return data[:to] + data[at : at + size] + data[to + size :]
        case 1:
            return data[: at + size] + data[at:]
        case _:
            return data[:at] + data[at + size :]


def _unchecked_zeros(sample: Sample, rng: Rng) -> bytes:
    """A sector of zeros whose page has the checksum of zeros."""
    plain = replace(sample, paged=False)
    return paged(_zeroed(plain, rng))


KINDS: dict[str, Callable[[Sample, Rng], bytes]] = {
    "field": _field,
    "fields swapped": _swapped_fields,
    "words": _words,
    "lines": _lines,
    "header bytes": _head_bytes,
    "body bytes": lambda sample, rng: _bytes(sample, rng, sample.head, len(sample.data)),
    "cut": _cut,
    "appended": _appended,
    "zeroed": _zeroed,
    "doubled": _doubled,
    "zeroed in pages": _unchecked_zeros,
}
FITS: dict[str, Callable[[Sample], bool]] = {
    "field": lambda sample: bool(sample.fields),
    "fields swapped": lambda sample: bool(sample.fields),
    "words": lambda sample: sample.words,
    "lines": lambda sample: sample.words,
    "body bytes": lambda sample: sample.head < len(sample.data),
    "zeroed in pages": lambda sample: sample.paged,
}
