"""A family's picture from its numeric surface: the components in plan, and lines on the intrados seen from above.

It asks nothing of a vault but its distance, components and the box of its plan, so that any family can be drawn. Sizes
are rounded to tenths of a pixel: the same vault gives the same bytes.
"""

from __future__ import annotations

from itertools import groupby, pairwise
from math import cos, radians, sin

import numpy as np
from numpy.typing import NDArray

from families import Vault
from families.declaration.palette import colour

Floats = NDArray[np.float64]
Ints = NDArray[np.uint16]

SIDE, MARGIN = 300.0, 12.0  # of each of the two drawings and around it, in pixels
ROWS, COLUMNS = 110, 241  # of the plan: rows, and places in each where it is asked which component is there
LINES, STEPS = 9, 81  # drawn lines along either direction, and points of each
HALVINGS = 30  # between the springing and a metre above the crown: to a hundredth of a millimetre and better
BORDER_HALVINGS = 12
INSIDE = 1 - 1e-9  # of the plan's half extents
SPRINGING = 1e-6  # [m] above it, where a point of the plan must be in the room
AZIMUTH, ELEVATION = radians(-60), radians(32)
GROUND = "#888888"
THICK, OVERLAP = 2.5, 0.3  # pixels: lines through the middle; rows of the plan over one another


def drawing(vault: Vault) -> str:
    """Plan and view as an SVG document."""
    wide, tall = 2 * (SIDE + 2 * MARGIN), SIDE + 2 * MARGIN
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{wide:.0f}" height="{tall:.0f}" '
        f'viewBox="0 0 {wide:.0f} {tall:.0f}" fill="none" role="img">\n<title>{vault.title}</title>\n'
        f'<g transform="translate({MARGIN:.0f} {MARGIN:.0f})">{_plan(vault)}</g>\n'
        f'<g transform="translate({SIDE + 3 * MARGIN:.0f} {MARGIN:.0f})" stroke-linejoin="round">{_view(vault)}</g>\n'
        "</svg>\n"
    )


def surface(vault: Vault, xy: Floats) -> tuple[Floats, Ints]:
    """Height [m] of the intrados over places (n, 2) of the plan, and the component there; NaN and 0 outside."""

    def room(z: Floats) -> NDArray[np.bool_]:
        return vault.distance(np.column_stack([xy, z]), walls=True) < 0

    low, high = np.full(len(xy), SPRINGING), np.full(len(xy), vault.derived_values()["rise"] + 1.0)
    inside = room(low)
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        under = room(middle)
        low, high = np.where(under, middle, low), np.where(under, high, middle)
    component = vault.evaluate(np.column_stack([xy, low])).component
    return np.where(inside, low, np.nan), np.where(inside, component, 0).astype(np.uint16)


def _plan(vault: Vault) -> str:
    """Rows of the plan, each in runs of one component."""
    half = vault.plan.half
    scale, step = SIDE / (2 * half.max()), 2 * half[1] / ROWS
    y = half[1] - (np.arange(ROWS) + 0.5) * step
    x = half[0] * INSIDE * np.linspace(-1, 1, COLUMNS)
    component = surface(vault, np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2))[1].reshape(ROWS, COLUMNS)
    row, column = np.nonzero(np.diff(component.astype(int)))
    borders = _borders(vault, x[column], x[column + 1], y[row], component[row, column])
    paths: dict[int, list[str]] = {}
    for k, northing in enumerate(y):
        ends = [x[0], *borders[row == k], x[-1]]
        for own, (left, right) in zip(component[k, [0, *(column[row == k] + 1)]], pairwise(ends), strict=True):
            place = SIDE / 2 + scale * left, SIDE / 2 - scale * northing
            paths.setdefault(int(own), []).append(f"M{place[0]:.1f} {place[1]:.1f}h{scale * (right - left):.1f}")
    paths.pop(0, None)
    drawn = (
        f'<path stroke="{colour(k).hex}" d="{"".join(runs)}"><title>{vault.components[k - 1]}</title></path>'
        for k, runs in sorted(paths.items())
    )
    return f'<g stroke-width="{scale * step + OVERLAP:.1f}">{"".join(drawn)}</g>'


def _borders(vault: Vault, west: Floats, east: Floats, y: Floats, component: Ints) -> Floats:
    """Where, between places (n,) [m] to the west and to the east, the western component ends."""
    for _ in range(BORDER_HALVINGS if len(west) else 0):
        middle = (west + east) / 2
        same = surface(vault, np.column_stack([middle, y]))[1] == component
        west, east = np.where(same, middle, west), np.where(same, east, middle)
    return (west + east) / 2


def _view(vault: Vault) -> str:
    """Lines along both directions in the components' colours, those through the middle thick, and their ground."""
    half, rise = vault.plan.half * INSIDE, vault.derived_values()["rise"]
    shares = np.linspace(-1, 1, LINES)
    along = np.sin(np.linspace(-np.pi / 2, np.pi / 2, STEPS))  # closer where arches are steep
    box = np.array([[x, y, z] for x in (-half[0], half[0]) for y in (-half[1], half[1]) for z in (0.0, rise)])
    flat = _seen(box)
    low, size = flat.min(axis=0), np.ptp(flat, axis=0)
    scale = SIDE / size.max()
    shift = (SIDE - scale * size) / 2

    def xy(points: Floats) -> str:
        u, v = (scale * (_seen(points) - low) + shift).T
        return " ".join(f"{a:.1f},{SIDE - b:.1f}" for a, b in zip(u, v, strict=True))

    drawn = []
    for axis in (0, 1):
        for share in shares:
            place = np.full((STEPS, 2), share * half[1 - axis])
            place[:, axis] = along * half[axis]
            points = np.column_stack([place, surface(vault, place)[0]])
            width = THICK if abs(share) < 1e-9 else 1
            for component, run in groupby(enumerate(_stretches(vault, points)), key=lambda one: int(one[1])):
                ends = [k for k, _ in run]
                if component:
                    line, shade = xy(points[ends[0] : ends[-1] + 2]), colour(component).hex
                    drawn.append(f'<polyline points="{line}" stroke="{shade}" stroke-width="{width}"/>')
    corners = np.concatenate([vault.corners, vault.corners[:1]])
    corners = np.column_stack([corners, np.zeros(len(corners))])
    ground = f'<polyline points="{xy(corners)}" stroke="{GROUND}" stroke-dasharray="4 3"/>'
    return ground + "".join(drawn)


def _stretches(vault: Vault, points: Floats) -> Ints:
    """The components (n - 1,) between points (n, 3) of a line on the intrados; 0 where an end is outside."""
    middle = (points[:-1] + points[1:]) / 2
    outside = np.isnan(middle[:, 2])
    component = vault.evaluate(np.where(outside[:, None], 0.0, middle)).component
    return np.where(outside, 0, component).astype(np.uint16)


def _seen(points: Floats) -> Floats:
    """Points (n, 3) as they are seen in parallel lines from above, (n, 2)."""
    x, y, z = points.T
    right = x * sin(-AZIMUTH) + y * cos(AZIMUTH)
    away = -x * cos(AZIMUTH) + y * sin(-AZIMUTH)
    return np.column_stack([right, z * cos(ELEVATION) + away * sin(ELEVATION)])
