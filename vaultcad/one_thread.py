"""Sums that round alike on any computer."""

from __future__ import annotations

import scipy.linalg  # noqa: F401  # only libraries that are loaded when a function is called can be limited
from threadpoolctl import threadpool_limits

one_thread = threadpool_limits.wrap(limits=1, user_api="blas")
"""Makes a function do its linear algebra in one thread: with more, sums round by the number of threads."""
