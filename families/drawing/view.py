"""An ideal vault seen from above at an angle: lines on its intrados along both directions of the plan."""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, radians, sin

import numpy as np
from numpy.typing import NDArray

from families.declaration.vault import Vault
from families.drawing.section import outlines, stretches
from families.drawing.sheet import Drawing, Floats
from families.void.upright import INSIDE

LINES, STEPS = 9, 49  # along either direction, and places of each where its height is asked; odd, so that one is midway
AZIMUTH, ELEVATION = radians(-60), radians(32)


def view(vault: Vault) -> Drawing:
    """The intrados in lines of the components' colours, those through the middle thick, over the plan's outline."""
    grounds = [np.column_stack([row, np.zeros(len(row))])[[*range(len(row)), 0]] for row in vault.plan.outlines()]
    low, high = vault.plan.box
    lines = [
        (share, points, component)
        for across in (0, 1)
        for share in np.linspace(-INSIDE, INSIDE, LINES)
        for points, component in _lines(vault, across, float(_between(low, high, share)[1 - across]))
    ]
    top = np.array([0.0, 0.0, vault.derived_values()["rise"] + 2 * vault.lift])
    reach = _seen(np.concatenate([*grounds, *(ground + top for ground in grounds)]))
    drawing = Drawing(reach.min(axis=0), reach.max(axis=0), f"View: {vault.title}")
    for ground in grounds:
        drawing.line(_seen(ground), "springing")
    for share, points, component in lines:
        for row, shade, name in stretches(vault, _seen(points), component):
            if shade is not None:
                drawing.line(row, "surface" if share else "intrados", shade, name)
    return drawing


def _lines(vault: Vault, across: int, at: float) -> Iterator[tuple[Floats, NDArray[np.uint16]]]:
    """Points (n, 3) over the plan where the other coordinate is `at` [m], and the component of each stretch between."""
    for line, _ in outlines(vault, across, at, STEPS):
        points = np.full((len(line), 3), at)
        points[:, [across, 2]] = line
        component = vault.evaluate((points[:-1] + points[1:]) / 2).component  # not the wall, where one is beside
        component[[0, -1]] = 0  # up to the intrados, and down again
        yield points, component


def _between(low: Floats, high: Floats, share: float) -> Floats:
    """A place on the way, at -1 at the one, at 1 at the other."""
    return (low + high) / 2 + share * (high - low) / 2


def _seen(points: Floats) -> Floats:
    """Points (n, 3) in parallel projection, (n, 2)."""
    x, y, z = points.T
    right = x * sin(-AZIMUTH) + y * cos(AZIMUTH)
    away = -x * cos(AZIMUTH) + y * sin(-AZIMUTH)
    return np.column_stack([right, z * cos(ELEVATION) + away * sin(ELEVATION)])
