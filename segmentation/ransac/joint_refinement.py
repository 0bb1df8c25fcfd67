"""Joint refinement: all primitives compete for every point, are fitted again, and so on until no label changes."""

import math

import numpy as np

from segmentation.primitives.least_squares import Samples, least_squares
from segmentation.ransac.hypotheses import Floats, Ints, Shapes, Won, sizes_of, spread, won
from segmentation.ransac.settings import Search

ROUNDS = 30
HELD = np.empty(0, dtype=np.int64)
FIT_POINTS = 8000  # points that decide the primitives; the labels are for all


def refine_jointly(
    shapes: Shapes,
    xyz: Floats,
    normals: Floats,
    epsilon: float,
    settings: Search,
    rounds: int = ROUNDS,
    held: Ints = HELD,
) -> tuple[Shapes, Ints]:
    """The primitives fitted to the points (n, 3) each wins, but those held, and the labels (n,), -1 for points that
    none explains.
    """
    cos_alpha, sizes = math.cos(settings.alpha), sizes_of(shapes, settings)
    some = spread(len(xyz), FIT_POINTS)
    sample, directions, labels = xyz[some], normals[some], np.full(len(some), -1)
    for _ in range(rounds if len(shapes) else 0):
        new = won(shapes, sample, directions, epsilon, cos_alpha)
        if (new.labels == labels).all():
            break
        labels = new.labels
        rows = _fit_to_won(shapes, sample, new, sizes)
        rows[held] = shapes.rows[held]
        shapes = Shapes(shapes.kinds, rows)
    return shapes, won(shapes, xyz, normals, epsilon, cos_alpha).labels


def _fit_to_won(shapes: Shapes, xyz: Floats, found: Won, sizes: Floats) -> Floats:
    """Rows fitted to the points won, those that a second primitive explains about as well weighing little."""
    mine = np.flatnonzero(found.labels >= 0)
    own, rival = found.price[mine], found.rival[mine]
    clear = np.clip(4.0 * (np.sqrt(np.minimum(rival, 4.0)) - np.sqrt(own)), 0.05, 1.0)
    samples = Samples(xyz[mine], found.labels[mine], clear * np.clip(1.0 - own, 0.0, 1.0) ** 2)
    return least_squares(shapes.kinds, shapes.rows, samples, sizes, iterations=4)
