"""How many records the points of an E57 scan hold, told by their packets, which the count in the XML is compared with.

The layout of sections and packets follows ASTM E2807, 9.3 and 9.4.
"""

import struct
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO
from xml.etree import ElementTree as Xml

from segmentation.errors import COPY_AGAIN, ReadError
from segmentation.io.e57_check import CHECKSUM, PAGE

BODY = PAGE - CHECKSUM
SECTION = struct.Struct("<B7xQQQ")  # kind, bytes of the section, places of its data and its index
PACKET = struct.Struct("<BBHH")  # kind, flags, bytes of the packet but one, streams
POINTS, DATA = 1, 1  # kinds of a section and a packet that hold points
WORD = 8  # bytes that a stream of whole numbers may be filled up by, in each packet
SINGLE, DOUBLE = 4, 8  # bytes of a real number


@dataclass(frozen=True)
class Scan:
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
    with path.open("rb", buffering=0) as file:  # a few bytes of each packet
        for number, scan in enumerate(_scans(path, xml), 1):
            if scan.count == 0:
                continue
            try:
                lengths, packets = _streams(file, scan.at, len(scan.bits))
            except (struct.error, ValueError, OverflowError, OSError):
                wrong = f"is no whole E57 file (the points of scan {number} are not where it says)"
                raise ReadError(path, wrong, COPY_AGAIN) from None
            if len(lengths) != len(scan.bits):
                wrong = f"is no whole E57 file (the points of scan {number} have other fields than it says)"
                raise ReadError(path, wrong, COPY_AGAIN)
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


def _scans(path: Path, xml: bytes) -> list[Scan]:
    try:
        root = Xml.fromstring(xml)
        points = list(root.iterfind("{*}data3D/*/{*}points"))
        return [
            Scan(
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


def _streams(file: BinaryIO, at: int, fields: int) -> tuple[list[int], int]:
    """Bytes of each stream of the section at a place of the file, over all packets, and how many packets there are.

    fields: how many streams are expected.
    """
    start = _logical(at)
    kind, length, data, _ = SECTION.unpack(_read(file, start, SECTION.size))
    if kind != POINTS:
        raise ValueError("no section with points")
    at, end = _logical(data), start + length
    lengths: list[int] = []
    packets = 0
    while at < end:
        head = _read(file, at, PACKET.size + 2 * fields)
        kind, _, size, streams = PACKET.unpack_from(head)
        if kind == DATA:
            if streams > fields:
                head = _read(file, at, PACKET.size + 2 * streams)
            found = struct.unpack_from(f"<{streams}H", head, PACKET.size)
            lengths = [a + b for a, b in zip(lengths, found, strict=True)] if packets else list(found)
            packets += 1
        at += size + 1
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
