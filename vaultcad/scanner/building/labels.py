"""What each surface of a building is, as rows of a table whose number every triangle carries."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Kind(IntEnum):
    """What a point shows."""

    VAULT = 0
    WALL = 1
    PIER = 2
    FLOOR = 3
    CLUTTER = 4
    ARCH = 5


BRIGHT = {Kind.VAULT: 0.65, Kind.WALL: 0.6, Kind.PIER: 0.5, Kind.FLOOR: 0.3, Kind.CLUTTER: 0.25, Kind.ARCH: 0.5}
"""Reflectance."""


class Label(NamedTuple):
    """Kind, and the 1-based numbers of vault, component and arch, 0 for none."""

    kind: Kind
    vault: int = 0
    component: int = 0
    arch: int = 0


CLUTTER, SKY = Label(Kind.CLUTTER), Label(Kind.CLUTTER, arch=-1)  # SKY: nothing is there, and nothing comes back
WALL, PIER, FLOOR = Label(Kind.WALL), Label(Kind.PIER), Label(Kind.FLOOR)


def arch_label(number: int) -> Label:
    """That of an arch."""
    return Label(Kind.ARCH, arch=number)


@dataclass
class Labels:
    """The table. Row 0 is what shows nothing: clutter, and pixels between two surfaces."""

    rows: dict[Label, int] = field(default_factory=lambda: {CLUTTER: 0, SKY: 1})

    def of(self, label: Label) -> int:
        """The number of a label's row, a new one where it has none."""
        return self.rows.setdefault(label, len(self.rows))

    def columns(self) -> NDArray[np.int64]:
        """(4, rows): kind, vault, component, arch."""
        return np.array(list(self.rows)).T

    def reflectance(self, number: NDArray[np.integer]) -> NDArray[np.float32]:
        """(n,) of surfaces by their numbers (n,)."""
        bright: NDArray[np.float32] = np.array([BRIGHT[label.kind] for label in self.rows], np.float32)[number]
        return bright
