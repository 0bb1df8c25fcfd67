"""A result's folder is replaced as a whole: wherever it lies, whatever the system cannot do, or not at all."""

import errno
import os
import resource
import signal
from pathlib import Path

import pytest

from fuzz.results import FILES, REPORT, STATES, in_child, listing, words, write
from segmentation.errors import WriteError
from vaultcad.errors import ExportError
from vaultcad.export.folder import check_target, replacing_folder


@pytest.fixture(autouse=True)
def no_waiting_for_the_disk(monkeypatch):
    monkeypatch.setattr(os, "fsync", lambda fd: None)


def test_a_result_that_may_not_be_written_to_is_replaced(tmp_path):
    out = tmp_path / "out"
    write(out, "old")
    (out / "notes.txt").write_text("mine")
    out.chmod(0o555)
    write(out, "new")
    assert words(out) == {REPORT % "new"}
    assert (out / "notes.txt").read_text() == "mine"
    assert out.stat().st_mode & 0o777 == 0o555
    assert listing(tmp_path) == ["out"]


def test_what_cannot_have_two_names_goes_along_too(tmp_path, monkeypatch):
    out = tmp_path / "out"
    write(out, "old")
    (out / "photos").mkdir()
    os.mkfifo(out / "photos" / "pipe")
    (out / "photos" / "link").symlink_to("nowhere")
    monkeypatch.setattr(os, "link", lambda *a, **k: (_ for _ in ()).throw(OSError(errno.EPERM, "no")))
    write(out, "new")
    assert sorted(path.name for path in (out / "photos").iterdir()) == ["link", "pipe"]


def test_a_name_that_is_too_long_is_refused_before_the_work(tmp_path):
    with pytest.raises(ExportError, match="the name is too long"):
        check_target(tmp_path / ("o" * 240), FILES)


def test_a_folder_through_a_link_is_replaced_where_it_is(tmp_path):
    (tmp_path / "disk").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "disk" / "out")
    write(tmp_path / "link", "old")
    write(tmp_path / "link", "new")
    assert words(tmp_path / "disk" / "out") == {REPORT % "new"}
    assert (tmp_path / "link").is_symlink()
    assert listing(tmp_path / "disk") == ["out"]


def test_the_folder_keeps_its_permissions(tmp_path):
    out = tmp_path / "out"
    write(out, "old")
    assert out.stat().st_mode & 0o777 == 0o777 & ~_mask()
    out.chmod(0o2770)
    write(out, "new")
    assert out.stat().st_mode & 0o7777 == 0o2770


def _mask():
    mask = os.umask(0)
    os.umask(mask)
    return mask


def test_the_folder_one_is_in_and_a_mounted_disk_are_refused(tmp_path, monkeypatch):
    out = tmp_path / "out"
    (out / "deeper").mkdir(parents=True)
    monkeypatch.chdir(out / "deeper")
    with pytest.raises(ExportError, match="is the folder that you are in"):
        check_target(out, FILES)
    with pytest.raises(ExportError, match="is where a disk is mounted"):
        check_target(Path("/dev"), FILES)


def test_a_full_disk_leaves_the_old_result_and_is_said(tmp_path):
    """The disk is full when the marker is written."""
    out = tmp_path / "out"
    write(out, "old")

    def full():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        with replacing_folder(out) as place:
            (place.part / "report.json").write_text(REPORT % "new")
            resource.setrlimit(resource.RLIMIT_FSIZE, (1, 1))

    def said():
        with pytest.raises(WriteError, match="could not be written"):
            full()

    assert in_child(said) == 0
    assert words(out) == {REPORT % "old"}
    assert listing(tmp_path) == ["out"]


def test_an_exchange_that_the_system_refuses_leaves_all_as_it_was(tmp_path, monkeypatch):
    out = tmp_path / "out"
    write(out, "old")

    def refuses(one, other):
        raise OSError(errno.EBUSY, "Device or resource busy")

    monkeypatch.setattr("vaultcad.export.folder.exchange", refuses)
    with pytest.raises(
        ExportError, match=r"cannot be replaced \(Device or resource busy\): the new result is in .*new-1"
    ):
        write(out, "new")
    assert words(out) == {REPORT % "old"}
    assert words(tmp_path / "out-new-1") == {REPORT % "new"}
    assert listing(tmp_path) == ["out", "out-new-1"]


def test_files_on_a_system_without_links_go_along(tmp_path, monkeypatch):
    out = tmp_path / "out"
    STATES["a result with other files"](out)
    monkeypatch.setattr(os, "link", lambda *a, **k: (_ for _ in ()).throw(OSError(errno.EPERM, "no")))
    write(out, "new")
    assert (out / "photos" / "north" / "1.jpg").read_text() == "mine"
    assert (out / "review.png").read_text() == "mine"
