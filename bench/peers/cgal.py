"""CGAL's efficient RANSAC, by the bindings that PyPI calls `cgal`."""

from __future__ import annotations

from importlib import import_module
from math import cos, radians
from typing import Any

from bench.peers.job import Job, serve

KINDS = ("plane", "cone", "cylinder", "sphere", "torus")  # in the order of its arguments


def segment(job: Job) -> Any:
    """Labels (n,) by the job's settings; its first shape is 1."""
    sets, shapes = import_module("CGAL.CGAL_Point_set_3"), import_module("CGAL.CGAL_Shape_detection")
    cloud = sets.Point_set_3()
    cloud.read(str(job.cloud))
    found = cloud.add_int_map("shape", -1)
    wanted = [kind in job.primitives for kind in KINDS]
    with job.timed():
        shapes.efficient_RANSAC(
            cloud, found, job.min_points, job.epsilon, job.beta, cos(radians(job.alpha_deg)), job.probability, *wanted
        )
    return [1 + found.get(i) for i in range(cloud.size())]


if __name__ == "__main__":
    serve(segment)
