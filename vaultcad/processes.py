"""Work on several cores at once, in processes that share what was there before; each result is the same on one core."""

from __future__ import annotations

import ctypes
import gc
import logging
import multiprocessing
import os
import pickle
import signal
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection
from typing import Any, TypeVar

T = TypeVar("T")

LOG = logging.getLogger(__name__)

FORKS = sys.platform == "linux"  # elsewhere a process starts from nothing, and takes as long as a bay
PARENT_DIES = 1  # PR_SET_PDEATHSIG of prctl(2)
KILLED = "a process was killed, perhaps for want of memory: the rest is done by one, which takes longer"
Tell = Callable[[str], None]
_work: Callable[[int], Any] | None = None


def spread(work: Callable[[int], T], count: int) -> Iterator[T]:
    """`work(k)` for k from 0 to `count`, in this order, by as many processes as there are cores.

    Where one of them is killed, as a system does that runs out of memory, this process does the rest alone.
    """
    global _work  # noqa: PLW0603  processes that are forked find here what cannot be sent to them
    cores = _cores()
    if min(cores, count) < 2 or _work is not None:
        yield from map(work, range(count))
        return
    done, _work = 0, work
    try:
        context = multiprocessing.get_context("fork")
        try:
            with ProcessPoolExecutor(min(cores, count), mp_context=context, initializer=_begin) as pool:
                for result in pool.map(_do, range(count)):
                    done += 1
                    yield result
        except BrokenProcessPool:
            LOG.warning(KILLED)
            yield from map(work, range(done, count))
    finally:
        _work = None


@contextmanager
def beside(work: Callable[[Tell], T], *, long: bool = True) -> Iterator[Callable[[Tell], T]]:
    """Begin `work` in a process beside this one; what is yielded waits for its result, and passes on what it tells.

    It is for work that holds Python's lock, beside threads that would have to wait for it. On one core, where it is not
    `long`, and where that process is killed, it is done while it is waited for.
    """
    if not long or _cores() < 2 or _work is not None:
        yield work
        return
    _give_back()
    context = multiprocessing.get_context("fork")
    ours, its = context.Pipe(duplex=False)
    process = context.Process(target=_beside, args=(work, its))
    process.start()
    its.close()

    def result(tell: Tell) -> T:  # the message is a word on the way, what came of it, and what was raised
        try:
            while (told := ours.recv())[0] is not None:
                tell(told[0])
        except EOFError:
            LOG.warning(KILLED)
            return work(tell)
        _, done, error = told
        if error is not None:
            raise error
        out: T = done
        return out

    try:
        yield result
    finally:
        ours.close()
        process.kill()  # if it is not through, nobody waits for it any more
        process.join()


def _beside(work: Callable[[Tell], Any], its: Connection) -> None:
    _begin()
    try:
        done, error = work(lambda word: its.send((word, None, None))), None
    except Exception as raised:
        done, error = None, _sendable(raised)
    its.send((None, done, error))


def _sendable(error: Exception) -> Exception:
    """The same where another process can make it again, else one with its words."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if FORKS else 1


def _give_back() -> None:
    """Give the system what was freed: each process would need as much anew beside it."""
    with suppress(AttributeError):  # other C libraries than glibc have no such call
        ctypes.CDLL(None).malloc_trim(0)


def _begin() -> None:
    """A process ends with the one that made it, and leaves signals to it.

    Looking for garbage writes to all objects, and what is written to is no longer shared: theirs are left alone.
    """
    gc.freeze()
    ctypes.CDLL(None).prctl(PARENT_DIES, signal.SIGKILL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _do(k: int) -> Any:
    assert _work is not None
    return _work(k)
