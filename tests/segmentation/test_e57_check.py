"""E57 files of strangers: nothing is fetched, expanded or nested without end before the library reads them."""

from __future__ import annotations

import os
import re
import socket
import struct
import threading
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pye57
import pytest

from fuzz.pages import BODY, PAGE, logical, paged, with_xml, xml_of
from segmentation import read
from segmentation.errors import ReadError
from segmentation.io import e57_check
from segmentation.io.write import write_cloud

POSE = (
    r'<pose type="Structure"><rotation type="Structure"><w type="Float">%s</w><x type="Float">0</x>'
    r'<y type="Float">0</y><z type="Float">0</z></rotation></pose>\1'
)


@pytest.fixture(scope="module")
def plain(tmp_path_factory) -> bytes:
    """A good E57 file of some points, without its pages' checksums."""
    path = tmp_path_factory.mktemp("e57") / "good.e57"
    write_cloud(path, np.random.default_rng(0).uniform(-3, 3, (500, 3)))
    return logical(path.read_bytes())


def changed(plain: bytes, change, **header: int) -> bytes:
    """The file with its XML changed, whole in all else; header: numbers of it that are not put right."""
    out = bytearray(with_xml(plain, change(plain[xml_of(plain)])))
    for name, value in header.items():
        struct.pack_into("<Q", out, {"size": 16, "at": 24, "count": 32, "page": 40}[name], value)
    return paged(bytes(out))


def after_declaration(text: str):
    """A change that puts a text between the XML's declaration and its root."""

    def change(xml: bytes) -> bytes:
        at = xml.index(b"?>") + 2
        return xml[:at] + text.encode() + xml[at:]

    return change


def in_root(text: str):
    """A change that gives the root an attribute."""
    return lambda xml: xml.replace(b"<e57Root ", b"<e57Root " + text.encode() + b" ", 1)


@pytest.fixture
def server() -> Iterator[tuple[int, list[str]]]:
    """A port on this machine, and who came."""
    guests: list[str] = []
    with socket.create_server(("127.0.0.1", 0)) as listening:
        listening.settimeout(0.1)
        over = threading.Event()

        def wait() -> None:
            while not over.is_set():
                try:
                    guest, address = listening.accept()
                except TimeoutError:
                    continue
                guests.append(str(address))
                guest.close()

        thread = threading.Thread(target=wait)
        thread.start()
        yield listening.getsockname()[1], guests
        over.set()
        thread.join()


HOSTILE = {
    "external dtd": after_declaration('<!DOCTYPE e57Root SYSTEM "{url}">'),
    "external entity": after_declaration('<!DOCTYPE e57Root [<!ENTITY x SYSTEM "{url}">]>'),
    "parameter entity": after_declaration('<!DOCTYPE e57Root [<!ENTITY % x SYSTEM "{url}"> %x;]>'),
    "local file": after_declaration('<!DOCTYPE e57Root [<!ENTITY x SYSTEM "file:///etc/passwd">]>'),
    "public dtd": after_declaration('<!DOCTYPE e57Root PUBLIC "-//X//Y" "{url}">'),
    "spaces": after_declaration('\n\n<!DOCTYPE\n\n e57Root\tSYSTEM "{url}">'),
    "schema": in_root(
        'xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" '
        'xsi:schemaLocation="http://www.astm.org/COMMIT/E57/2010-e57-v1.0 {url}"'
    ),
    "schema without namespace": in_root(
        'xmlns:q="http://www.w3.org/2001/XMLSchema-instance" q:noNamespaceSchemaLocation="{url}"'
    ),
    "laughs": after_declaration(
        "<!DOCTYPE e57Root ["
        + '<!ENTITY a0 "ha">'
        + "".join(f'<!ENTITY a{k} "{f"&a{k - 1};" * 10}">' for k in range(1, 12))
        + "]>"
    ),
    "utf-16": lambda xml: xml.decode().replace("UTF-8", "UTF-16").encode("utf-16"),
    "utf-16 without a mark": lambda xml: xml.decode().replace("UTF-8", "UTF-16").encode("utf-16-be"),
    "utf-7": lambda xml: xml.replace(b"UTF-8", b"UTF-7"),
    "deep": lambda xml: xml.replace(b"</e57Root>", b"<a>" * 200 + b"</a>" * 200 + b"</e57Root>"),
    "deep and open": lambda xml: xml.replace(b"</e57Root>", b"<a>" * 100_000),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_nothing_is_fetched_and_the_file_is_refused(plain, server, tmp_path, name) -> None:
    port, guests = server

    def change(xml: bytes) -> bytes:
        return HOSTILE[name](xml).replace(b"{url}", f"http://127.0.0.1:{port}/x.dtd".encode())

    path = tmp_path / "hostile.e57"
    path.write_bytes(changed(plain, change))
    with pytest.raises(ReadError, match="its XML"):
        read(path)
    assert guests == []


@pytest.mark.parametrize("text", ["<!-- a scan -->", "<?xml-stylesheet href='a.xsl'?>", "\n\n"])
def test_what_harms_nobody_is_read(plain, tmp_path, text) -> None:
    path = tmp_path / "good.e57"
    path.write_bytes(changed(plain, after_declaration(text)))
    assert len(read(path)) == 500


@pytest.mark.parametrize(
    ("header", "why"),
    [
        ({"count": 1 << 40}, "bytes long"),
        ({"count": 17 << 20}, "bytes long"),
        ({"at": 1 << 60}, "lies outside"),
        ({"at": 3}, "lies outside"),
        ({"at": PAGE + 1022}, "lies outside"),
        ({"size": 12345}, "where its header says 12345"),
        ({"page": 0}, "pages of 0 bytes"),
        ({"page": 4096}, "pages of 4096 bytes"),
    ],
)
def test_headers_that_make_no_sense_are_refused(plain, tmp_path, header, why) -> None:
    path = tmp_path / "bad.e57"
    path.write_bytes(changed(plain, lambda xml: xml, **header))
    with pytest.raises(ReadError, match=why):
        read(path)


@pytest.mark.parametrize("length", [8, 20, 47, 48, 1000])
def test_files_that_end_early_are_refused(plain, tmp_path, length) -> None:
    path = tmp_path / "short.e57"
    path.write_bytes(paged(plain)[:length])
    with pytest.raises(ReadError):
        read(path)


def test_a_pipe_is_not_waited_for(tmp_path) -> None:
    for suffix in (".e57", ".las", ".ply", ".xyz"):
        path: Path = tmp_path / f"pipe{suffix}"
        os.mkfifo(path)
        with pytest.raises(ReadError, match="no file but a pipe"):
            read(path)


def test_the_check_reads_the_xml_that_the_library_reads(plain, tmp_path) -> None:
    path = tmp_path / "good.e57"
    path.write_bytes(paged(plain))
    assert e57_check._xml(path) == plain[xml_of(plain)]


def xml_with(pattern: str, new: str):
    """A change of the first text that a pattern finds."""
    return lambda xml: re.sub(pattern.encode(), new.encode(), xml, count=1)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (xml_with('recordCount="500"', 'recordCount="499"'), "scan 1 holds 1 points more than it says"),
        (xml_with(r"(<xMaximum[^>]*>)[^<]*", r"\g<1>1.0"), "outside its bounds by up to"),
        (xml_with("(<cartesianBounds)", POSE % "2"), "has the length 2, not 1"),
    ],
)
def test_what_contradicts_the_xml_is_told(plain, tmp_path, change, told) -> None:
    path = tmp_path / "told.e57"
    path.write_bytes(changed(plain, change))
    assert told in dict(read(path).notes)["damaged"]


@pytest.mark.parametrize(
    ("change", "why"),
    [
        (xml_with('recordCount="500"', 'recordCount="501"'), "500 of 501 points"),
        (xml_with('recordCount="500"', 'recordCount="9223372036854775807"'), "500 of 9223372036854775807 points"),
        (xml_with('recordCount="500"', 'recordCount="many"'), "no whole E57"),
        (xml_with(r'fileOffset="\d+"', 'fileOffset="1000000000000"'), "are not where it says"),
        (xml_with(r'fileOffset="\d+"', 'fileOffset="-8"'), "are not where it says"),
        (xml_with("<cartesianX [^>]*/>", ""), "fields, not"),
        (xml_with('recordCount="500"', 'recordCount="-500"'), "are not where it says"),
        (xml_with("(?s)<vectorChild.*</vectorChild>", r"\g<0>\g<0>"), "in the same place"),
        (xml_with('<cartesianX type="Float"', '<cartesianX type="Blob"'), "a field of type 'Blob'"),
    ],
)
def test_records_that_are_not_there_are_refused(plain, tmp_path, change, why) -> None:
    path = tmp_path / "bad.e57"
    path.write_bytes(changed(plain, change))
    with pytest.raises(ReadError, match=why):
        read(path)


PACKETS = {  # of a file whose first packet begins at byte 80
    "of one byte": (struct.pack("<BBHH", 0, 1, 0, 3), "one of kind 0 has 1 bytes"),
    "of another kind": (struct.pack("<BBHH", 3, 0, 11, 3), "one of kind 3"),
    "of odd length": (struct.pack("<BBHH", 2, 0, 4, 3), "has 5 bytes"),
    "of other streams": (struct.pack("<BBHH", 1, 0, 11, 65535), "65,535 fields, not 3"),
    "of long streams": (struct.pack("<BBHHH", 1, 0, 11, 3, 4000), "longer than its 12 bytes"),
    "beyond the section": (struct.pack("<BBH", 1, 0, 65535), "longer than its 65,536 bytes"),
    "without end": (struct.pack("<BBH", 2, 0, 3) * 3000, "more than 1,1"),
    "of zeros": (bytes(3000), "one of kind 0 has 1 bytes"),
}


@pytest.mark.parametrize("name", PACKETS)
def test_packets_that_cannot_be_are_refused(plain, tmp_path, name) -> None:
    packet, why = PACKETS[name]
    path = tmp_path / "bad.e57"
    path.write_bytes(paged(plain[:80] + packet + plain[80 + len(packet) :]))
    with pytest.raises(ReadError, match=why):
        read(path)


def test_packets_to_be_passed_over_are(plain, tmp_path) -> None:
    path = tmp_path / "good.e57"
    (length,) = struct.unpack_from("<Q", plain, 56)
    behind = struct.pack("<BBHI", 2, 0, 7, 0)
    out = bytearray(plain[: 48 + length] + behind)
    struct.pack_into("<Q", out, 56, length + len(behind))
    struct.pack_into("<Q", out, 24, len(out) // BODY * PAGE + len(out) % BODY)
    path.write_bytes(paged(with_xml(bytes(out), plain[xml_of(plain)])))
    assert len(read(path)) == 500


def test_scans_are_numbered_as_in_the_file(plain, tmp_path) -> None:
    def change(xml: bytes) -> bytes:
        xml = re.sub(rb"(<xMaximum[^>]*>)[^<]*", rb"\g<1>1.0", xml)
        return re.sub(rb"(?s)<vectorChild.*</vectorChild>", lambda m: m[0].replace(b'"500"', b'"0"') + m[0], xml)

    path = tmp_path / "told.e57"
    path.write_bytes(changed(plain, change))
    assert "points of scan 2 lie outside" in dict(read(path).notes)["damaged"]


def test_points_that_are_all_one_take_no_time(plain, tmp_path) -> None:
    constant = '<cartesian\\1 type="Integer" minimum="3" maximum="3"/>'

    def change(xml: bytes) -> bytes:
        xml = re.sub(rb"<cartesian([XYZ]) [^>]*/>", constant.encode(), xml)
        return xml.replace(b'recordCount="500"', b'recordCount="9223372036854775807"')

    path = tmp_path / "bomb.e57"
    path.write_bytes(changed(plain, change))
    with pytest.raises(ReadError, match="one and the same"):
        read(path)


@pytest.mark.parametrize("turn", [(1, 0, 0, 0), (0.8, 0, 0, 0.6)])
def test_bounds_in_whatever_frame_are_right(tmp_path, turn) -> None:
    path = tmp_path / "posed.e57"
    xyz = np.random.default_rng(0).uniform(-3, 3, (500, 3))
    with pye57.E57(str(path), mode="w") as file:
        columns = dict(zip(("cartesianX", "cartesianY", "cartesianZ"), xyz.T.copy(), strict=True))
        file.write_scan_raw(columns, rotation=np.array(turn), translation=np.array([50.0, 60, 1]))
    assert "damaged" not in dict(read(path).notes)
