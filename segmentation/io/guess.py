"""Columns of numbers that no header names: told apart by what they hold, or not at all."""

import numpy as np
from numpy.typing import NDArray

Table = NDArray[np.float64]
RUNNING = 0.99
"""Share of the steps of a running number that are one and the same."""
NORTH_FIRST = (
    ((1e6, 1e7), (1e5, 1e6)),  # UTM, Lambert, British
    ((4e6, 6.6e6), (1e6, 4.7e6)),  # Gauss-Krüger and Gauss-Boaga, whose eastings begin with the zone
    ((1.0e6, 1.35e6), (2.4e6, 2.9e6)),  # Swiss LV95
)
"""m; what a first and a second column hold that are northing and easting, in this order, of national grids."""
HIGHEST = 1e5
"""m; no third column that is more is a height."""


class AmbiguousError(ValueError):
    """Columns that may be one thing or another; the message says which."""


def guessed(table: Table, words: frozenset[int], *, pts: bool) -> tuple[str, ...]:
    """What each column holds by its place and the first rows (k, columns); "" for what is of no use.

    A number in front that runs on is a point's. Then come x, y and z, then, in any order, intensity, threes of colour
    or (unit vectors) normals. words: columns that hold no numbers. pts: whether intensity comes before colour, if both
    orders are possible.
    Raises AmbiguousError if the first columns may be something else than x, y and z.
    """
    columns = [c for c in range(table.shape[1]) if c not in words]
    if len(columns) > 4 and _whole(table[:, columns[:2]]).all() and not _whole(table[:, columns[2:4]]).any():
        raise AmbiguousError("its first two columns hold whole numbers, as rows and columns of a grid of beams do")
    if len(columns) > 3 and _is_number_of_point(table, columns):
        columns = columns[1:]
    xyz = columns[:3]
    check_northing_first(table[:, xyz])
    at = dict(zip(xyz, ("x", "y", "z"), strict=True))
    left = [c for c in columns[3:] if not np.isnan(table[:, c]).all()]
    for k in range(len(left) - 3, -1, -1):
        if _are_normals(table[:, left[k : k + 3]]):
            at |= dict(zip(left[k : k + 3], ("nx", "ny", "nz"), strict=True))
            del left[k : k + 3]
            break
    color = _color(table, left, pts)
    at |= dict(zip(color, "rgb", strict=False))
    rest = [c for c in left if c not in color]
    at |= {rest[0]: "intensity"} if rest else {}
    return tuple(at.get(c, "") for c in range(table.shape[1]))


def _is_number_of_point(table: Table, columns: list[int]) -> bool:
    """Whether the first column counts the points.

    Raises AmbiguousError if it holds whole numbers beside coordinates that are none, and yet does not count.
    """
    first, others = table[:, columns[0]], table[:, columns[1:4]]
    if len(first) < 3 or not np.array_equal(first, np.round(first)) or _whole(others).all():
        return False
    steps = np.diff(first)
    if (steps > 0).all() and np.mean(steps == np.median(steps)) >= RUNNING:
        return True
    if _whole(others).any() or len(np.unique(first)) == 1:
        return False
    raise AmbiguousError("its first column holds whole numbers, the next three do not: it may be no x")


def _whole(table: Table) -> NDArray[np.bool_]:
    whole: NDArray[np.bool_] = (table == np.round(table)).all(axis=0)
    return whole


def check_northing_first(xyz: Table) -> None:
    """See that columns (k, 3) which are taken for x, y and z do not look like northing, easting and height.

    Raises AmbiguousError if they do.
    """
    known = np.abs(xyz[np.isfinite(xyz).all(axis=1)])
    if len(known) == 0:
        return
    first, second, third = np.median(known, axis=0)
    for north, east in NORTH_FIRST:
        if north[0] <= first < north[1] and east[0] <= second < east[1] and third < HIGHEST:
            raise AmbiguousError(
                f"its x and y, near {first:,.0f} and {second:,.0f}, look like northing and easting: "
                "taken as they stand they would mirror the scan"
            )


def _color(table: Table, left: list[int], pts: bool) -> list[int]:
    """Three columns in succession that may be colours: before a fourth or after it, whichever are more alike."""
    if len(left) < 3:
        return []
    starts = [s for s in ((0, 1) if len(left) > 3 else (0,)) if _are_colors(table[:, left[s : s + 3]])]
    if not starts:
        return []
    apart = [_apart(table[:, left[s : s + 3]]) for s in starts]
    best = min(range(len(starts)), key=lambda k: (apart[k], -starts[k] if pts else starts[k]))
    return left[starts[best] : starts[best] + 3]


def _apart(columns: Table) -> float:
    """How much three columns differ from each other, beside what they are; red, green and blue of stone are alike."""
    spread = np.ptp(columns, axis=1).mean()
    return float(spread / max(columns.mean(), 1e-9))


def _are_normals(columns: Table) -> bool:
    return bool(np.allclose(np.linalg.norm(columns, axis=1), 1, atol=0.01))


def _are_colors(columns: Table) -> bool:
    whole = np.array_equal(columns, np.round(columns))
    top = float(columns.max())
    return bool(columns.min() >= 0 and (top <= 1 if not whole else top <= 65535))
