"""What of an E57 file is looked at before the library that reads it gets it.

libE57 hands the XML to a parser that fetches external entities and schemas, from files and over the network, and
expands all other entities. An E57 file has no use for any, so a file that declares one is none. The layout of header
and pages follows ASTM E2807, 8.
"""

from __future__ import annotations

import struct
from pathlib import Path
from xml.parsers import expat

from segmentation.errors import COPY_AGAIN, ReadError

HEADER = struct.Struct("<8sIIQQQQ")  # signature, version, length of the file, place and length of the XML, page
PAGE, CHECKSUM = 1024, 4  # bytes of a page, and of the checksum at its end; no other size is read
LONGEST_XML = 16 << 20  # bytes of XML; a survey of a thousand scans has about 4 MB
DEEPEST = 64  # elements within each other; the standard needs 8
ENCODINGS = ("utf-8", "utf8", "us-ascii", "ascii")
HARMLESS = (b"<!--", b"<![CDATA[")  # all else that begins like this declares something
LOCATIONS = ("schemaLocation", "noNamespaceSchemaLocation")  # attributes that name a schema to be fetched


def check_e57(path: Path) -> bytes:
    """The XML of an E57 file; refused is one that is too long, nested too deeply, or declares anything.

    Raises:
        ReadError: it is so, or the header makes no sense.
    """
    xml = _xml(path)
    if b"\0" in xml or not xml.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"<"):
        raise ReadError(path, "is no E57 file: its XML is not in UTF-8", COPY_AGAIN)
    at = xml.find(b"<!")
    while at >= 0:
        if not xml.startswith(HARMLESS, at):
            raise _unsafe(path)
        at = xml.find(b"<!", at + 2)
    _parsed(path, xml)
    return xml


def _xml(path: Path) -> bytes:
    """The XML, without the checksums of the pages."""
    size = path.stat().st_size
    with path.open("rb") as file:
        head = file.read(HEADER.size)
        if len(head) < HEADER.size:
            raise ReadError(path, "is no whole E57 file (it ends within its header)", COPY_AGAIN)
        signature, _, _, length, at, count, page = HEADER.unpack(head)
        if signature != b"ASTM-E57" or page != PAGE:
            raise ReadError(path, f"is no E57 file that can be read (pages of {page} bytes, not {PAGE})", COPY_AGAIN)
        if length != size:
            raise ReadError(path, f"is no whole E57 file ({size} bytes where its header says {length})", COPY_AGAIN)
        if count > LONGEST_XML:
            raise ReadError(path, f"its XML is {count} bytes long, more than {LONGEST_XML}", COPY_AGAIN)
        if not HEADER.size <= at < size or at % PAGE > PAGE - CHECKSUM or count > size:
            raise ReadError(path, "is no whole E57 file (its XML lies outside)", COPY_AGAIN)
        first = at // PAGE
        pages = (at % PAGE + count) // (PAGE - CHECKSUM) + 1
        file.seek(first * PAGE)
        raw = file.read(pages * PAGE)
    logical = b"".join(raw[k : k + PAGE - CHECKSUM] for k in range(0, len(raw), PAGE))
    xml = logical[at % PAGE :][:count]
    if len(xml) < count:
        raise ReadError(path, "is no whole E57 file (its XML is cut off)", COPY_AGAIN)
    return xml


def _parsed(path: Path, xml: bytes) -> None:
    """Walk through the XML, and stop at what no E57 file has. The parser follows nothing that is outside."""
    depth = 0

    def opened(name: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if any(name.rsplit(":", 1)[-1] in LOCATIONS for name in attributes):
            raise _unsafe(path)
        if depth > DEEPEST:
            raise ReadError(path, f"its XML has more than {DEEPEST} elements within each other", COPY_AGAIN)

    def closed(name: str) -> None:
        nonlocal depth
        depth -= 1

    def declared(version: str, encoding: str | None, standalone: int) -> None:
        if encoding is not None and encoding.lower() not in ENCODINGS:
            raise ReadError(path, f"its XML is in {encoding!r}, not in UTF-8", COPY_AGAIN)

    def refused(*_: object) -> None:
        raise _unsafe(path)

    parser = expat.ParserCreate()
    parser.StartElementHandler, parser.EndElementHandler, parser.XmlDeclHandler = opened, closed, declared
    parser.StartDoctypeDeclHandler = parser.EntityDeclHandler = refused
    try:
        parser.Parse(xml, True)
    except expat.ExpatError as error:
        raise ReadError(path, f"is no whole E57 file (its XML: {error})", COPY_AGAIN) from None


def _unsafe(path: Path) -> ReadError:
    return ReadError(
        path, "its XML declares a document type, entities or a schema, which no E57 file needs: not opened", COPY_AGAIN
    )
