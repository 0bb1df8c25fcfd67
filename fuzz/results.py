"""Results whose files each hold one word, and processes that die while they write one.

`python -m fuzz.results WORK …` does such work in a process that has loaded little, of which copies are made at once.
"""

import os
import signal
import subprocess
import sys
import traceback
from pathlib import Path

from vaultcad.export import exchange
from vaultcad.export.folder import check_target, clear, replacing_folder
from vaultcad.export.marker import MARKER

ROOT = Path(__file__).parents[1]
FILES = ("model.ifc", "report.json", "segments.laz")
MAP = "unrolled/vault-1.dxf"  # a file in a folder within a result
REPORT = '{"schema": 1, "of": "%s"}'


def write(out, word, *, names=FILES, force=False):
    """A result of which each file holds the word."""
    with replacing_folder(out, force=force) as place:
        for name in names:
            (place.part / name).parent.mkdir(exist_ok=True)
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
    "a result with other files in a folder of ours": lambda out: (
        write(out, "old", names=[*FILES, MAP]),
        (out / "unrolled" / "cracks.dxf").write_text("mine"),
    ),
}


def killed_before_any_call(state, steps, folder):
    """Each time one call later, until the work is done before."""
    if steps == "three steps":
        exchange._swap = lambda: None
    seen, ended = set(), None
    for count in range(1000):
        place = Path(folder) / f"{count}"
        place.mkdir()
        out = place / "out"
        STATES[state](out)
        others = {p.relative_to(out) for p in out.rglob("*") if p.is_file()} - {*map(Path, (*FILES, MAP, MARKER))}
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


def two_at_once(folder):
    """Again and again."""
    out = Path(folder) / "out"
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
        assert listing(Path(folder)) == ["out"]


def killed_after_a_change(folder):
    """The change is a person's."""
    for count in range(1000):
        place = Path(folder) / f"{count}"
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


def apart(work, *arguments):
    """Do one of these in a process of its own."""
    command = [sys.executable, "-m", "fuzz.results", work.__name__, *map(str, arguments)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


if __name__ == "__main__":
    os.fsync = lambda fd: None
    globals()[sys.argv[1]](*sys.argv[2:])
