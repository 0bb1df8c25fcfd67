"""pyransac3d, which fits one primitive at a time: the best of the wanted kinds, again and again on what is left.

It has no components, and a pass over all points in numpy for every hypothesis; it is given every so manieth point.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np

from bench.peers.job import Job, serve

KINDS = {"plane": "Plane", "sphere": "Sphere", "cylinder": "Cylinder"}
POINTS, DRAWS, MOST = 10_000, 500, 8  # that look for a shape; hypotheses of a kind; shapes


def segment(job: Job) -> Any:
    """Labels (n,) of all points, by the shapes found in some of them."""
    library = import_module("pyransac3d")
    xyz = job.points()[0].astype(np.float64)
    labels = np.zeros(len(xyz), dtype=np.int64)
    with job.timed():
        for number in range(1, MOST + 1):
            left = np.flatnonzero(labels == 0)
            if len(left) < job.min_points:
                break
            some = left[:: max(1, len(left) // POINTS)]
            shapes = [getattr(library, KINDS[kind])() for kind in job.primitives if kind in KINDS]
            best = max(shapes, key=lambda shape: len(shape.fit(xyz[some], job.epsilon, DRAWS).inliers))
            found = left[_distance(best, xyz[left]) <= job.epsilon]
            if len(found) < job.min_points:
                break
            labels[found] = number
    return labels


def _distance(shape: Any, xyz: Any) -> Any:
    """Distances (n,) [m] of points (n, 3) to a shape of the library."""
    if hasattr(shape, "equation"):
        return np.abs(xyz @ np.array(shape.equation[:3]) + shape.equation[3])
    away = xyz - shape.center
    if hasattr(shape, "axis"):
        away = np.cross(away, shape.axis)
    return np.abs(np.sqrt((away**2).sum(axis=1)) - shape.radius)


if __name__ == "__main__":
    serve(segment)
