"""Pages of an E57 file with their checksums, so that mutants get past these."""

from __future__ import annotations

import struct
from functools import lru_cache

PAGE, BODY = 1024, 1020
POLYNOMIAL = 0x82F63B78  # Castagnoli's, bits turned round


def _row(value: int) -> int:
    for _ in range(8):
        value = (value >> 1) ^ (POLYNOMIAL if value & 1 else 0)
    return value


TABLE = [_row(value) for value in range(256)]


@lru_cache(maxsize=4096)
def crc32c(data: bytes) -> int:
    """The checksum that ends a page; those of pages that did not change are at hand."""
    crc = 0xFFFFFFFF
    for byte in data:
        crc = (crc >> 8) ^ TABLE[(crc ^ byte) & 0xFF]
    return crc ^ 0xFFFFFFFF


def paged(plain: bytes) -> bytes:
    """Bytes in pages with their checksums, filled up with zeros."""
    plain += b"\0" * (-len(plain) % BODY)
    pages = (plain[k : k + BODY] for k in range(0, len(plain), BODY))
    return b"".join(page + struct.pack(">I", crc32c(page)) for page in pages)


def logical(raw: bytes) -> bytes:
    """The bytes of pages, without their checksums."""
    return b"".join(raw[k : k + BODY] for k in range(0, len(raw), PAGE))


def xml_of(plain: bytes) -> slice:
    """Where the XML lies in the bytes without checksums."""
    at, count = struct.unpack_from("<QQ", plain, 24)
    start = at // PAGE * BODY + at % PAGE
    return slice(start, start + count)


def with_xml(plain: bytes, xml: bytes) -> bytes:
    """The bytes with another XML, which is last in the file, its length and that of the file put right."""
    out = bytearray(plain[: xml_of(plain).start] + xml)
    struct.pack_into("<Q", out, 16, -(-len(out) // BODY) * PAGE)
    struct.pack_into("<Q", out, 32, len(xml))
    return bytes(out)
