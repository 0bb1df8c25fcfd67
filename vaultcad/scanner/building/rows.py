"""Bays placed by what stands beside them: in rows, and before a side of another."""

from __future__ import annotations

from collections.abc import Iterable
from math import atan2, pi

import numpy as np

from families import Vault
from vaultcad.scanner.building.place import Place
from vaultcad.scanner.building.under import names


def in_row(vaults: Iterable[Vault], start: Place, gap: float) -> list[Place]:
    """Places of vaults one after the other along y of `start`, the first beginning there, with gaps [m] between."""
    found, y = [], 0.0
    for vault in vaults:
        y += vault.plan.half_y
        found.append(at(start, 0.0, y))
        y += vault.plan.half_y + gap
    return found


def at(start: Place, x: float, y: float, turn: float = 0.0) -> Place:
    """A place in the frame of another [m, rad]."""
    return Place(x, y, 0.0, turn).seen(start)


def beside(vault: Vault, place: Place, side: str, other: Vault, gap: float, *, enter: str, turn: float = 0.0) -> Place:
    """Where another vault stands so that its side `enter` faces a side of this one, `gap` [m] before it.

    turn: about the middle of that side, counterclockwise [rad]; it has to leave room for it.
    """
    middle, outward = _middle(vault, side)
    own, inward = _middle(other, enter)
    yaw = atan2(outward[1], outward[0]) - atan2(inward[1], inward[0]) + pi + turn
    reached = Place(0.0, 0.0, 0.0, yaw).out(own[None])[0]
    x, y = (middle + gap * outward - reached).tolist()
    return at(place, x, y, yaw)


def _middle(vault: Vault, name: str) -> tuple[np.ndarray, np.ndarray]:
    """The middle of a straight side [m], and its normal out of the plan."""
    side = dict(zip(names(vault), vault.plan.sides, strict=True))[name]
    return (np.array(side.start) + np.array(side.end)) / 2, np.array(side.normal)
