"""vaultcad itself, after a first call that compiles or reads what is compiled."""

from __future__ import annotations

from math import radians
from typing import Any

from bench.peers.job import Job, serve
from segmentation import Settings, detect

WARM = 20_000  # points of the first call


def segment(job: Job) -> Any:
    """Labels (n,) by the job's settings, or by automatic ones."""
    xyz, normals = job.points()
    settings = (
        Settings()
        if job.automatic
        else Settings(
            min_support=job.min_points,
            epsilon=job.epsilon,
            beta=job.beta,
            alpha=radians(job.alpha_deg),
            overlooking_probability=job.probability,
            primitives=tuple(job.primitives),
        )
    )
    detect(xyz[:WARM], normals[:WARM])
    with job.timed():
        found = detect(xyz, normals, settings)
    return found.labels


if __name__ == "__main__":
    serve(segment)
