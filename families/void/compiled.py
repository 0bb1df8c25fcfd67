"""How what is called thousands of times is compiled.

numba keeps compiled code beside the file it stands in and watches that file alone: what one file takes from another is
compiled into it, so that who changes the one touches the other.
"""

from __future__ import annotations

from numba import njit

# Serial, as an optimiser calls it thousands of times on a few thousand points; threads may share a large cloud.
compiled = njit(cache=True, nogil=True, error_model="numpy")
# What only reads its arrays needs no count of references to them: without one it is ten times as fast (numba #1204).
inner = njit(cache=True, nogil=True, error_model="numpy", forceinline=True, _nrt=False)
apart = njit(cache=True, nogil=True, error_model="numpy", _nrt=False)  # what is rare, and would make the rest slower
