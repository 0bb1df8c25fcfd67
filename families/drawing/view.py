"""An ideal vault seen from above at an angle: lines on its intrados along both directions of the plan."""

from __future__ import annotations

from math import cos, radians, sin

import numpy as np

from families.declaration.vault import Vault
from families.drawing.section import INSIDE, outline, stretches
from families.drawing.sheet import Drawing, Floats

LINES, STEPS = 9, 49  # along either direction, and places of each where its height is asked; odd, so that one is midway
AZIMUTH, ELEVATION = radians(-60), radians(32)


def view(vault: Vault) -> Drawing:
    """The intrados in lines of the components' colours, those through the middle thick, over the plan's outline."""
    corners = np.concatenate([vault.corners, vault.corners[:1]])
    ground = np.column_stack([corners, np.zeros(len(corners))])
    low, high = corners.min(axis=0), corners.max(axis=0)
    top = np.array([0.0, 0.0, vault.derived_values()["rise"]])
    reach = _seen(np.concatenate([ground, ground + top]))
    drawing = Drawing(reach.min(axis=0), reach.max(axis=0), f"View: {vault.title}")
    drawing.line(_seen(ground), "springing")
    for across in (0, 1):
        middle, half = (low + high)[1 - across] / 2, (high - low)[1 - across] / 2
        for share in np.linspace(-INSIDE, INSIDE, LINES):
            at = float(middle + share * half)
            line, _ = outline(vault, across, at, STEPS)
            points = np.full((len(line), 3), at)
            points[:, [across, 2]] = line
            component = vault.evaluate((points[:-1] + points[1:]) / 2).component  # not the wall, where one is beside
            component[[0, -1]] = 0  # up to the intrados, and down again
            for row, shade, name in stretches(vault, _seen(points), component):
                if shade is not None:
                    drawing.line(row, "surface" if share else "intrados", shade, name)
    return drawing


def _seen(points: Floats) -> Floats:
    """Points (n, 3) in parallel projection, (n, 2)."""
    x, y, z = points.T
    right = x * sin(-AZIMUTH) + y * cos(AZIMUTH)
    away = -x * cos(AZIMUTH) + y * sin(-AZIMUTH)
    return np.column_stack([right, z * cos(ELEVATION) + away * sin(ELEVATION)])
