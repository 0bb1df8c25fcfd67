"""A command ends at once, whatever it is doing, and leaves nothing half written."""

import os
import signal
import subprocess
import sys
import time

import pytest

WORK = """
import ctypes, os, signal, sys
from pathlib import Path
from vaultcad.cli.supervise import StoppedError, supervised

def busy():
    '''In native code that lets nobody else have a turn.'''
    print("ready", flush=True)
    ctypes.PyDLL(None).sleep(60)

def folder():
    from vaultcad.export.folder import replacing_folder
    with replacing_folder(Path("above/out")) as place:
        (place.part / "report.json").write_text("half")
        busy()

def file():
    from segmentation.io.whole import replacing
    with replacing(Path("cloud.laz")) as beside:
        beside.write_text("half")
        busy()

def changed():
    '''Between the new result's coming and the old one's going.'''
    from vaultcad.export import folder
    for word in ("old", "new"):
        folder.sync_folder = (lambda out: busy()) if word == "new" else folder.sync_folder
        with folder.replacing_folder(Path("out")) as place:
            (place.part / "report.json").write_text('{"schema": 1, "word": "%s"}' % word)

def crash():
    with open("nothing", "w"):
        os.abort()

def hungry():
    os.kill(os.getpid(), signal.SIGKILL)

def fine():
    print("done")
    return 7

try:
    code = supervised(globals()[sys.argv[1]])
except StoppedError as stop:
    print(stop, stop.asked, stop.code)
    code = stop.code
sys.exit(code)
"""


def heeding(ignored):
    """Signals as a terminal has them but for those ignored: who runs the tests may ignore some, as nohup and `&` do."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN if number in ignored else signal.SIG_DFL)


@pytest.fixture
def started(tmp_path):
    """Starts a program in the test's folder; what still runs after the test is ended, for it would fail later ones."""
    running = []

    def start(arguments, ignored=(), **more):
        process = subprocess.Popen(
            arguments,
            cwd=tmp_path,
            text=True,
            start_new_session=True,
            preexec_fn=lambda: heeding(ignored),  # noqa: PLW1509  # no lock is taken between fork and exec
            **{"stdout": subprocess.PIPE, **more},
        )
        running.append(process)
        return process

    yield start
    for process in running:
        with process:  # closes its streams, and waits
            process.kill()


def program(work):
    return [sys.executable, "-c", WORK, work]


def listing(folder):
    return sorted(path.name for path in folder.iterdir())


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
@pytest.mark.parametrize("terminal", [True, False], ids=["to both", "to one"])
@pytest.mark.parametrize(("work", "left"), [("busy", []), ("folder", []), ("file", [])])
def test_a_signal_ends_it_and_nothing_is_left(number, terminal, work, left, started, tmp_path):
    process = started(program(work))
    assert process.stdout.readline() == "ready\n"
    (os.killpg if terminal else os.kill)(process.pid, number)
    said, _ = process.communicate(timeout=20)
    assert said == f"{number.name} True {128 + number}\n"
    assert process.returncode == 128 + number
    assert listing(tmp_path) == left


def test_a_signal_after_the_exchange_leaves_the_new_result_alone(started, tmp_path):
    process = started(program("changed"))
    assert process.stdout.readline() == "ready\n"
    process.terminate()
    process.communicate(timeout=20)
    assert process.returncode == 143
    assert listing(tmp_path) == ["out"]
    assert "new" in (tmp_path / "out" / "report.json").read_text()


@pytest.mark.parametrize(("work", "said"), [("crash", "SIGABRT False 134\n"), ("hungry", "SIGKILL False 137\n")])
def test_a_worker_that_dies_is_told(work, said, started):
    process = started(program(work), stderr=subprocess.DEVNULL)
    assert process.communicate(timeout=20)[0] == said


def test_streams_that_are_closed_are_not_taken_for_names(started, tmp_path):
    """Native code may write to them."""
    silent = WORK.replace("print(", "(lambda *a, **k: 0)(")
    process = started(["/bin/sh", "-c", 'exec "$0" -c "$1" file <&- >&-', sys.executable, silent], stdout=None)
    while not listing(tmp_path):
        time.sleep(0.01)
    time.sleep(0.2)
    process.terminate()
    assert process.wait(20) == 143
    assert listing(tmp_path) == []


def test_a_worker_that_ends_by_itself_says_its_code(started):
    process = started(program("fine"))
    assert process.communicate(timeout=20)[0] == "done\n"
    assert process.returncode == 7


def test_a_signal_that_was_to_be_ignored_is_ignored(started):
    """As nohup asks."""
    process = started(program("busy"), ignored=[signal.SIGHUP])
    assert process.stdout.readline() == "ready\n"
    os.killpg(process.pid, signal.SIGHUP)
    with pytest.raises(subprocess.TimeoutExpired):
        process.wait(0.3)
    process.terminate()
    assert process.wait(20) == 143


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only Linux tells a child that its parent died")
def test_the_worker_does_not_outlive_the_one_that_waits(started):
    process = started(program("busy"))
    assert process.stdout.readline() == "ready\n"
    process.kill()
    assert process.communicate(timeout=20)[0] == ""  # the pipe is closed when the worker is gone too


def test_the_program_says_in_one_line_that_it_was_stopped(started):
    stuck = (
        "import time, vaultcad.cli.app as app; app._run = lambda given: (print('ready', flush=True), time.sleep(60)); "
    )
    process = started([sys.executable, "-c", stuck + "raise SystemExit(app.main())"], stderr=subprocess.PIPE)
    assert process.stdout.readline() == "ready\n"
    time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=20)
    assert (process.returncode, said) == (130, "vaultcad: interrupted; nothing half written is left\n")
