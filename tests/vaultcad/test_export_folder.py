"""A result's folder is whole as it was or whole as it is now, whatever happens and whenever."""

import errno
import os
import resource
import signal
import sys
import traceback
from pathlib import Path

import pytest

from segmentation.errors import WriteError
from vaultcad.errors import ExportError
from vaultcad.export import exchange as module
from vaultcad.export import folder
from vaultcad.export.folder import MARKER, UNFINISHED, check_target, clear, replacing_folder

FILES = ("model.ifc", "report.json", "segments.laz")
REPORT = '{"schema": 1, "of": "%s"}'


@pytest.fixture(autouse=True)
def no_waiting_for_the_disk(monkeypatch):
    monkeypatch.setattr(os, "fsync", lambda fd: None)


def write(out, word, *, names=FILES, force=False):
    """A result of which each file holds the word."""
    with replacing_folder(out, force=force) as place:
        for name in names:
            (place.part / name).write_text(REPORT % word)
    return place


def words(out, names=FILES):
    return {(out / name).read_text() for name in names}


def listing(folder):
    return sorted(path.name for path in folder.iterdir())


def in_child(work, **limits):
    """How a copy of this process that does the work ends."""
    pid = os.fork()
    if pid == 0:
        try:
            work()
        except BaseException:
            traceback.print_exc()
            os._exit(3)
        os._exit(0)
    return os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])


def dying_at(count, work):
    """Do the work; before the call to the file system with that number the process is killed."""
    left = [count]

    def hook(event, args):
        if event.startswith(("os.", "open", "shutil.", "fcntl.")):
            left[0] -= 1
            if left[0] == -1:
                os.kill(os.getpid(), signal.SIGKILL)

    sys.addaudithook(hook)
    work()


STATES = {
    "nothing": lambda out: None,
    "empty": lambda out: out.mkdir(),
    "a result": lambda out: write(out, "old"),
    "an older one without a marker": lambda out: (write(out, "old"), (out / MARKER).unlink()),
    "a result with other files": lambda out: (
        write(out, "old"),
        (out / "review.png").write_text("mine"),
        (out / "photos" / "north").mkdir(parents=True),
        (out / "photos" / "north" / "1.jpg").write_text("mine"),
    ),
}


@pytest.mark.parametrize("steps", ["one step", "three steps"])
@pytest.mark.parametrize("state", STATES)
def test_a_kill_before_any_call_leaves_the_old_or_the_new_whole(state, steps, tmp_path, monkeypatch):
    if steps == "three steps":
        monkeypatch.setattr(module, "_swap", lambda: None)
    seen, ended = set(), None
    for count in range(1000):
        place = tmp_path / f"{count}"
        place.mkdir()
        out = place / "out"
        STATES[state](out)
        others = {p.relative_to(out) for p in out.rglob("*") if p.is_file()} - {*map(Path, (*FILES, MARKER))}
        ended = in_child(lambda out=out, count=count: dying_at(count, lambda: write(out, "new")))
        assert ended in (0, -signal.SIGKILL)
        if steps == "three steps" and not out.exists():
            clear(out)  # as the next fit does first
        if out.exists() and any(out.iterdir()):
            (word,) = words(out)
            seen.add(word)
        else:
            seen.add("")
        assert all((out / name).read_text() == "mine" for name in others)
        check_target(out, FILES)
        write(out, "next")
        assert words(out) == {REPORT % "next"}
        assert all((out / name).read_text() == "mine" for name in others)
        assert listing(place) == ["out"]
        if ended == 0:
            break
    assert ended == 0
    assert count > 20
    assert seen == {REPORT % "new", "" if state in ("nothing", "empty") else REPORT % "old"}


def test_of_two_that_write_at_once_one_is_there_whole(tmp_path):
    out = tmp_path / "out"
    for turn in range(300):
        gate = os.pipe()
        children = []
        for word in ("one", "other"):
            pid = os.fork()
            if pid == 0:
                try:
                    os.close(gate[1])
                    os.read(gate[0], 1)
                    write(out, f"{word} {turn}", names=(*FILES, f"{word}.glb"))
                except BaseException:
                    traceback.print_exc()
                    os._exit(3)
                os._exit(0)
            children.append(pid)
        os.close(gate[0])
        os.close(gate[1])
        assert [os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]) for pid in children] == [0, 0]
        (word,) = words(out)
        assert word in (REPORT % f"one {turn}", REPORT % f"other {turn}")
        mine = "one" if "one" in word else "other"
        assert listing(out) == sorted([MARKER, *FILES, f"{mine}.glb"])
        assert listing(tmp_path) == ["out"]


def test_what_a_dead_process_left_is_taken_away_and_what_a_living_one_makes_is_not(tmp_path):
    out = tmp_path / "out"
    theirs = [".out.backup.part", ".out.11.part", ".outer.0123456789abcdef.part", ".out.fedcba9876543210.part"]
    for name, file, content in (
        (".out.4711.part", "model.step", "half"),  # as versions before the marker named it
        (".out.0123456789abcdef.part", UNFINISHED, ""),
        (".out.0123456789abcdef.gone.part", "thesis.doc", "that of which another name is there"),
        (theirs[0], "model.ifc", "mine"),
        (theirs[1], "thesis.doc", "mine"),
        (theirs[2], UNFINISHED, ""),
        (theirs[3], UNFINISHED, "another computer"),
    ):
        (tmp_path / name).mkdir()
        (tmp_path / name / file).write_text(content)
    with replacing_folder(out) as place:
        clear(out)
        assert listing(tmp_path) == sorted([*theirs, place.part.name])
        (place.part / "report.json").write_text(REPORT % "new")
    assert listing(tmp_path) == sorted([*theirs, "out"])


def test_what_others_add_while_it_changes_places_is_not_lost(tmp_path, monkeypatch):
    """An application saves into the folder that it had open, at the worst of times."""
    out = tmp_path / "out"
    write(out, "old")
    swap = module.exchange

    def late(one, other):
        swap(one, other)
        (one / "late.txt").write_text("mine")

    monkeypatch.setattr("vaultcad.export.folder.exchange", late)
    write(out, "new")
    assert words(out) == {REPORT % "new"}
    assert (out / "late.txt").read_text() == "mine"
    assert listing(tmp_path) == ["out"]


def test_what_a_person_changed_is_never_lost_whenever_the_process_dies(tmp_path):
    for count in range(1000):
        place = tmp_path / f"{count}"
        place.mkdir()
        write(place / "out", "old")
        (place / "out" / "model.ifc").write_text("with a wall more")
        ended = in_child(lambda count=count, out=place / "out": dying_at(count, lambda: write(out, "new")))
        write(place / "out", "next")
        assert words(place / "out") == {REPORT % "next"}
        assert "with a wall more" in {path.read_text() for path in place.glob("out-before-*/model.ifc")}
        if ended == 0:
            break
    assert count > 20


def test_what_a_person_changes_while_it_changes_places_is_kept(tmp_path, monkeypatch):
    out = tmp_path / "out"
    write(out, "old")
    carry = folder._carry_along

    def late(source, part):
        carry(source, part)
        (source / "model.ifc").write_text("with a wall more")

    monkeypatch.setattr(folder, "_carry_along", late)
    assert (write(out, "new").kept / "model.ifc").read_text() == "with a wall more"


def test_a_file_of_somebody_elses_does_not_come_over_ours_by_its_date(tmp_path):
    out = tmp_path / "out"
    write(out, "old")
    (out / "review.png").write_text("mine")
    os.utime(out / "review.png", (4e9, 4e9))
    write(out, "new", names=[*FILES, "review.png"], force=True)
    assert words(out, [*FILES, "review.png"]) == {REPORT % "new"}
    check_target(out, FILES)


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


def test_what_a_person_changed_is_refused_and_replaced_by_force(tmp_path):
    out = tmp_path / "out"
    write(out, "old")
    (out / "model.ifc").write_text("with a wall more")
    with pytest.raises(ExportError, match=r"model\.ifc was changed since it was written .* --force"):
        check_target(out, FILES)
    check_target(out, FILES, force=True)
    assert write(out, "new", force=True).kept is None
    assert words(out) == {REPORT % "new"}
    assert listing(tmp_path) == ["out"]


def test_what_a_person_changed_in_the_meantime_is_kept(tmp_path):
    out = tmp_path / "out"
    write(out, "old")
    for number in (1, 2):
        (out / "model.ifc").write_text("with a wall more")
        assert write(out, "new").kept == tmp_path / f"out-before-{number}"
        assert (tmp_path / f"out-before-{number}" / "model.ifc").read_text() == "with a wall more"
        assert words(out) == {REPORT % "new"}


def test_a_file_of_somebody_elses_under_a_name_of_ours_is_refused(tmp_path):
    out = tmp_path / "out"
    write(out, "old")
    (out / "review.png").write_text("mine")
    check_target(out, FILES)
    with pytest.raises(ExportError, match=r"review\.png is not of the earlier result"):
        check_target(out, [*FILES, "review.png"])
    kept = write(out, "new", names=[*FILES, "review.png"]).kept
    assert (kept / "review.png").read_text() == "mine"


def test_what_was_taken_out_by_a_person_is_no_change(tmp_path):
    out = tmp_path / "out"
    write(out, "old")
    (out / "report.json").unlink()
    check_target(out, FILES)
    write(out, "new")
    assert words(out) == {REPORT % "new"}


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
