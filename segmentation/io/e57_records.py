"""How many records the points of an E57 scan hold, told by their packets, which the count in the XML is compared with.

The layout of sections and packets follows ASTM E2807, 9.3 and 9.4.
"""

import struct
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import BinaryIO
from xml.etree import ElementTree as Xml

from segmentation.errors import COPY_AGAIN, ReadError
from segmentation.io.e57_check import CHECKSUM, PAGE

BODY = PAGE - CHECKSUM
SECTION = struct.Struct("<B7xQQQ")  # kind, bytes of the section, places of its data and its index
PACKET = struct.Struct("<BBHH")  # kind, flags, bytes of the packet but one, streams
POINTS, DATA = 1, 1  # kinds of a section and a packet that hold points
PACKETS = (0, 1, 2)  # kinds of packets: of an index, with points, to be passed over
ALIGNED = 4  # bytes that the length of a packet is a multiple of
# packets that any section may have, and bytes of a section for one more; good ones have 64 KB
PACKETS_ALLOWED, TYPICAL = 1000, 64
WORD = 8  # bytes that a stream of whole numbers may be filled up by, in each packet
SINGLE, DOUBLE = 4, 8  # bytes of a real number


@dataclass(frozen=True)
class Section:
    """Where a section and its first packet begin, and where it ends, all without checksums."""

    start: int
    data: int
    end: int


@dataclass(frozen=True)
class PointsSection:
    """What the XML says of the points of a scan: their place, how many there are, bits of each field of one."""

    at: int
    count: int
    bits: tuple[int, ...]


def check_records(path: Path, xml: bytes) -> list[str]:
    """What else than the count in the XML the packets of each scan hold, in words; nothing for scans that are whole.

    Raises:
        ReadError: a scan has fewer records than its count, or is not where the XML says.
    """
    found = []
    scans = {number: scan for number, scan in enumerate(_scans(path, xml), 1) if scan.count}
    with path.open("rb", buffering=0) as file:  # a few bytes of each packet
        sections = _sections(path, file, scans)
        for number, scan in scans.items():
            try:
                lengths, packets = _streams(file, sections[number], len(scan.bits))
            except (struct.error, ValueError) as error:
                wrong = f"is no whole E57 file (the packets of scan {number}: {error})"
                raise ReadError(path, wrong, COPY_AGAIN) from None
            for length, bits in zip(lengths, scan.bits, strict=True):
                if 8 * length < scan.count * bits:
                    raise ReadError(
                        path, f"is truncated: {8 * length // bits} of {scan.count} points are there", COPY_AGAIN
                    )
            if not any(scan.bits):
                raise ReadError(path, f"all points of scan {number} are one and the same", "export the scan again")
            spare = [0 if bits in (8 * SINGLE, 8 * DOUBLE) else WORD * packets for bits in scan.bits]
            more = [
                8 * (length - room) // bits - scan.count
                for length, room, bits in zip(lengths, spare, scan.bits, strict=True)
                if bits
            ]
            if max(more) > 0:
                found.append(f"scan {number} holds {max(more):,} points more than it says")
    return found


def _scans(path: Path, xml: bytes) -> list[PointsSection]:
    try:
        root = Xml.fromstring(xml)
        points = list(root.iterfind("{*}data3D/*/{*}points"))
        return [
            PointsSection(
                int(node.get("fileOffset", "0")),
                int(node.get("recordCount", "0")),
                tuple(_bits(field) for field in _leaves(node.find("{*}prototype"))),
            )
            for node in points
        ]
    except (Xml.ParseError, ValueError, KeyError) as error:
        raise ReadError(path, f"is no whole E57 file (its XML: {error})", COPY_AGAIN) from None


def _leaves(node: Xml.Element | None) -> list[Xml.Element]:
    """The fields of a record, in their order."""
    if node is None:
        return []
    fields: list[Xml.Element] = []
    for child in node:
        fields += _leaves(child) if child.get("type") in ("Structure", "Vector") else [child]
    return fields


def _bits(field: Xml.Element) -> int:
    """Bits that a field has in a record, at least: 0 for a text, and for a whole number that can only be one.

    Raises ValueError for what is no field.
    """
    if field.get("type") == "String":
        return 0
    if field.get("type") == "Float":
        return 8 * (SINGLE if field.get("precision") == "single" else DOUBLE)
    if field.get("type") not in ("Integer", "ScaledInteger"):
        raise ValueError(f"a field of type {field.get('type')!r}")
    low, high = int(field.get("minimum", -(2**63))), int(field.get("maximum", 2**63 - 1))
    return max(high - low, 0).bit_length()


def _sections(path: Path, file: BinaryIO, scans: dict[int, PointsSection]) -> dict[int, Section]:
    """Where the packets of each scan are; no two scans share any, or a small file would take long.

    Raises ReadError if they do, or a section is not where the XML says.
    """
    size = path.stat().st_size // PAGE * BODY
    found = {}
    for number, scan in scans.items():
        try:
            start = _logical(scan.at)
            kind, length, data, _ = SECTION.unpack(_read(file, start, SECTION.size))
            found[number] = section = Section(start, _logical(data), start + length)
        except (struct.error, ValueError, OverflowError, OSError):
            kind, section = None, Section(0, 0, 0)
        if kind != POINTS or scan.count < 0 or not start + SECTION.size <= section.data <= section.end <= size:
            wrong = f"is no whole E57 file (the points of scan {number} are not where it says)"
            raise ReadError(path, wrong, COPY_AGAIN)
    order = sorted(found, key=lambda number: found[number].start)
    for one, next_one in pairwise(order):
        if found[one].end > found[next_one].start:
            first, second = sorted((one, next_one))
            wrong = f"is no whole E57 file (the points of scans {first} and {second} are in the same place)"
            raise ReadError(path, wrong, COPY_AGAIN)
    return found


def _streams(file: BinaryIO, section: Section, fields: int) -> tuple[list[int], int]:
    """Bytes of each stream of a section, over all packets, and how many packets with points there are.

    fields: how many streams each has. Raises ValueError for packets that cannot be.
    """
    at, most = section.data, PACKETS_ALLOWED + (section.end - section.data) // TYPICAL
    lengths = [0] * fields
    seen = packets = 0
    while at < section.end:
        head = _read(file, at, PACKET.size + 2 * fields)
        kind, _, size, streams = PACKET.unpack_from(head)
        size, seen = size + 1, seen + 1
        if kind not in PACKETS or size % ALIGNED:
            raise ValueError(f"one of kind {kind} has {size:,} bytes")
        if seen > most:
            raise ValueError(f"more than {most:,} in {section.end - section.data:,} bytes")
        if kind == DATA:
            if streams != fields:
                raise ValueError(f"one has {streams:,} fields, not {fields:,}")
            own = struct.unpack_from(f"<{streams}H", head, PACKET.size)
            if PACKET.size + 2 * streams + sum(own) > size or at + size > section.end:
                raise ValueError(f"what one holds is longer than its {size:,} bytes")
            lengths = [a + b for a, b in zip(lengths, own, strict=True)]
            packets += 1
        at += size
    return lengths, packets


def _logical(at: int) -> int:
    """A place in the file, without the checksums before it."""
    return at // PAGE * BODY + at % PAGE


def _read(file: BinaryIO, at: int, length: int) -> bytes:
    """Bytes from a logical place on, without checksums. Fewer where the file ends."""
    found = b""
    while len(found) < length:
        page, offset = divmod(at + len(found), BODY)
        file.seek(page * PAGE + offset)
        part = file.read(min(length - len(found), BODY - offset))
        if not part:
            break
        found += part
    return found
