"""Work on all cores at once, in processes that share what was there before; each result is the same on one core."""

from __future__ import annotations

import logging
import multiprocessing
import os
import signal
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import Any, TypeVar

T = TypeVar("T")

LOG = logging.getLogger(__name__)

FORKS = sys.platform == "linux"  # elsewhere a process starts from nothing, and takes as long as a bay
PARENT_DIES = 1  # PR_SET_PDEATHSIG of prctl(2)
_work: Callable[[int], Any] | None = None


def spread(work: Callable[[int], T], count: int) -> Iterator[T]:
    """`work(k)` for k from 0 to `count`, in this order, by as many processes as there are cores.

    Where one of them is killed, as a system does that runs out of memory, this process does the rest alone.
    """
    global _work  # noqa: PLW0603  processes that are forked find here what cannot be sent to them
    cores = len(os.sched_getaffinity(0)) if FORKS else 1
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
            LOG.warning("a process was killed, perhaps for want of memory: the rest is done by one, which takes longer")
            yield from map(work, range(done, count))
    finally:
        _work = None


def _begin() -> None:
    """A process ends with the one that made it, and leaves signals to it."""
    import ctypes

    ctypes.CDLL(None).prctl(PARENT_DIES, signal.SIGKILL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _do(k: int) -> Any:
    assert _work is not None
    return _work(k)
