"""Threads for compiled work, which lets other threads run."""

import os
from concurrent.futures import ThreadPoolExecutor
from functools import cache

from numba import njit


def threads() -> ThreadPoolExecutor:
    """A pool with a thread a core, in which compiled functions may be called for the first time.

    At the first call of all numba loads what it knows of types, which must not happen while another thread looks it up.
    """
    _settle()
    return ThreadPoolExecutor(os.cpu_count())


@cache
def _settle() -> None:
    _same(0)


@njit(cache=True)
def _same(number: int) -> int:
    return number
