"""The work of a command in a process of its own, so that it ends at once when it is told to, and never leaves a half.

What takes long is native code (solids, packing, sorting), which does not look up until it is through. So a second
process works, and the first waits: a signal, a crash or want of memory ends the worker, and who waits takes away what
was not whole.
"""

from __future__ import annotations

import ctypes
import os
import select
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
        known = number in {*signal.Signals}
        super().__init__(signal.Signals(number).name if known else f"signal {number}")
        self.signal, self.asked = number, asked

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
    told, tell = (_above_streams(fd) for fd in os.pipe())
    waiting = os.getpid()
    worker = os.fork()
    if worker == 0:
        os.close(told)
        _obey(heeded, tell, waiting)
        return work()
    os.close(tell)
    stopped, names = _watch(worker, told, heeded)
    code = os.waitstatus_to_exitcode(os.waitpid(worker, 0)[1])
    if code >= 0:
        return code
    _clean_up(Path(os.fsdecode(name)) for name in reversed(names.split(b"\0")[:-1]))
    if sys.stderr.isatty():
        sys.stderr.write(CLEAN_LINE)
    # A terminal sends its signal to both, and the worker may have died of it first.
    raise StoppedError(stopped[0] if stopped else -code, asked=bool(stopped) or -code in STOPPING)


def _watch(worker: int, told: int, heeded: Iterable[int]) -> tuple[list[int], bytes]:
    """The signals that came, by which the worker was ended, and what it had told by its end."""
    calls, call = os.pipe()
    os.set_blocking(call, False)
    # A signal writes there at once; its handler would wait for a call of the system's that began just before it.
    signal.set_wakeup_fd(call)
    for number in heeded:
        signal.signal(number, lambda number, frame: None)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, heeded)
    stopped: list[int] = []
    names = b""
    while True:
        ready, _, _ = select.select([told, calls], [], [])
        if calls in ready:
            stopped += os.read(calls, 1)
            os.kill(worker, signal.SIGKILL)
        if told in ready:
            more = os.read(told, 1 << 16)
            if not more:  # it has ended
                return stopped, names
            names += more


def _above_streams(fd: int) -> int:
    """The descriptor, or a copy where it has taken the number of a stream that was closed."""
    import fcntl

    if fd > 2:
        return fd
    copy = fcntl.fcntl(fd, fcntl.F_DUPFD_CLOEXEC, 3)
    os.close(fd)
    return copy


def _obey(signals: Iterable[int], tell: int, waiting: int) -> None:
    """In the worker: end when told to, or when the other process is gone; tell the names of what is not whole."""
    from segmentation.temporary import listen

    for number in signals:
        signal.signal(number, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, signals)
    if sys.platform.startswith("linux"):
        ctypes.CDLL(None).prctl(PARENT_DIES, signal.SIGKILL)
    if os.getppid() != waiting:  # it was gone before that was asked for
        os._exit(BY_SIGNAL)

    def told(path: Path) -> None:
        os.write(tell, os.fsencode(path) + b"\0")

    listen(told)


def _clean_up(paths: Iterable[Path]) -> None:
    for path in paths:
        with suppress(OSError):
            if not path.is_dir():
                path.unlink(missing_ok=True)
                continue
            from vaultcad.export.folder import clear, target

            out = target(path)
            if out is None:
                path.rmdir()
            else:
                clear(out)
