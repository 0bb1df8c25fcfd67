"""The work of a command in a process of its own, so that it ends at once when it is told to, and never leaves a half.

What takes long is native code (solids, packing, sorting), which does not look up until it is through. So a second
process works, and the first waits: a signal, a crash or want of memory ends the worker, and who waits takes away what
was not whole.
"""

from __future__ import annotations

import ctypes
import os
import signal
import sys
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path

STOPPING = {signal.SIGINT, signal.SIGTERM, *({signal.SIGHUP} if hasattr(signal, "SIGHUP") else ())}
BY_SIGNAL = 128  # added to a signal's number it is the exit code of who ended by it, as shells have it
PARENT_DIES = 1  # PR_SET_PDEATHSIG of linux/prctl.h
CLEAN_LINE = "\r\x1b[2K\x1b[?25h"  # for a terminal: wipes a progress bar, and shows the cursor again


class StoppedError(Exception):
    """The worker did not end by itself. signal: by which it did; asked: whether somebody wanted that."""

    def __init__(self, number: int, asked: bool) -> None:
        super().__init__(signal.Signals(number).name)
        self.signal, self.asked = signal.Signals(number), asked

    @property
    def code(self) -> int:
        """Exit code."""
        return BY_SIGNAL + self.signal


def supervised(work: Callable[[], int]) -> int:
    """The exit code of `work`, done in a copy of this process where the system has that, else here.

    Raises:
        StoppedError: in the process that waits, if the worker was stopped; nothing half written is left.
    """
    if not hasattr(os, "fork"):
        return work()
    heeded = [number for number in STOPPING if signal.getsignal(number) != signal.SIG_IGN]
    signal.pthread_sigmask(signal.SIG_BLOCK, heeded)  # until both have settled who does what
    told, tell = os.pipe()
    worker = os.fork()
    if worker == 0:
        os.close(told)
        _obey(heeded, tell)
        return work()
    os.close(tell)
    stopped: list[int] = []

    def stop(number: int, frame: object) -> None:
        stopped.append(number)
        with suppress(ProcessLookupError):
            os.kill(worker, signal.SIGKILL)

    for number in heeded:
        signal.signal(number, stop)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, heeded)
    with os.fdopen(told, "rb") as pipe:
        names = pipe.read().split(b"\0")[:-1]  # until the worker ends
    code = os.waitstatus_to_exitcode(os.waitpid(worker, 0)[1])
    if code >= 0:
        return code
    _clean_up(Path(os.fsdecode(name)) for name in reversed(names))
    if sys.stderr.isatty():
        sys.stderr.write(CLEAN_LINE)
    # A terminal sends its signal to both, and the worker may have died of it first.
    raise StoppedError(stopped[0] if stopped else -code, asked=bool(stopped) or -code in STOPPING)


def _obey(signals: Iterable[int], tell: int) -> None:
    """In the worker: end when told to, or when the other process is gone; tell the names of what is not whole."""
    from segmentation.temporary import listen

    for number in signals:
        signal.signal(number, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, signals)
    if sys.platform.startswith("linux"):
        ctypes.CDLL(None).prctl(PARENT_DIES, signal.SIGKILL)

    def told(path: Path) -> None:
        os.write(tell, os.fsencode(path) + b"\0")

    listen(told)


def _clean_up(paths: Iterable[Path]) -> None:
    for path in paths:
        if path.is_dir():
            from vaultcad.export.folder import ENDING, clear, target

            if path.suffix == ENDING:
                clear(target(path))
                continue
            with suppress(OSError):
                path.rmdir()
        else:
            path.unlink(missing_ok=True)
