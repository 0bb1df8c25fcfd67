"""Arrays in few bytes, as scene.js reads them."""

from __future__ import annotations

import json
import struct
from base64 import b64encode
from typing import Any
from zlib import compress

import numpy as np
from numpy.typing import NDArray

ALIGNED = 4  # bytes, as typed arrays of the browser want it
STEPS = 65_535  # of a coordinate in its box
FINE = 1e-4  # m, step of a deviation or a displacement
FAR = 32_767  # steps
UNKNOWN = -32_768  # where there is no deviation

Floats = NDArray[np.float64]


class Packed:
    """Arrays one after the other, each as the differences of its rows, which deflate packs better."""

    def __init__(self) -> None:
        self._bytes = bytearray()

    def add(self, array: NDArray[np.integer]) -> list[int]:
        """Where an array (n,) or (n, k) lies: its first byte and how many numbers it has."""
        start = len(self._bytes)
        first = np.zeros_like(array[:1])
        steps = np.diff(array, axis=0, prepend=first)  # they wrap as they do when they are summed up again
        self._bytes += steps.tobytes()
        self._bytes += b"\0" * (-len(self._bytes) % ALIGNED)
        return [start, array.size]

    def places(self, points: Floats) -> dict[str, Any]:
        """Points (n, 3) [m], each axis in `STEPS` of their box."""
        low, high = points.min(axis=0), points.max(axis=0)
        step = np.maximum(high - low, 1e-9) / STEPS
        steps = np.rint((points - low) / step).astype(np.uint16)
        return {"xyz": self.add(steps), "low": _short(low), "step": _short(step)}

    def lengths(self, values: Floats) -> list[int]:
        """Lengths [m] of any shape in steps of `FINE`; NaN as `UNKNOWN`."""
        steps = np.clip(np.rint(values / FINE), -FAR, FAR)
        return self.add(np.where(np.isnan(steps), UNKNOWN, steps).astype(np.int16))

    def with_head(self, head: dict[str, Any]) -> bytes:
        """The length of the head, the head as JSON, and the arrays."""
        text = json.dumps(head, separators=(",", ":")).encode()
        text += b" " * (-len(text) % ALIGNED)
        return struct.pack("<I", len(text)) + text + bytes(self._bytes)


def page_text(plain: bytes) -> str:
    """Bytes as they lie in the page: deflated, in letters."""
    return b64encode(compress(plain)).decode("ascii")


def _short(values: Floats) -> list[float]:
    return [float(f"{value:.12g}") for value in values.tolist()]
