"""Planes, spheres and cylinders of a cloud by RANSAC, judged by the truth. Writes segments.ply and figures.csv.

Usage: python examples/04_segment_primitives.py [FOLDER]
"""

import sys
from pathlib import Path

import numpy as np

from families import Lunette
from segmentation import Settings, compare, detect, write_cloud


def main(out: Path) -> None:
    rng = np.random.default_rng(2)
    cloud = Lunette(span=6.0, length=9.0).sample(200_000, rng)
    noisy = cloud.xyz + 0.002 * rng.standard_normal(cloud.xyz.shape)

    # What is not given is chosen by the cloud's own spacing and noise. No normals are given, so they are estimated.
    found = detect(noisy, settings=Settings(primitives=("plane", "cylinder"), min_support=0.01), rng=rng)
    for segment in found.shapes:
        sizes = ", ".join(f"{name} {np.round(value, 3)}" for name, value in vars(segment.primitive).items())
        print(f"{segment.id}: {segment.primitive.name}, {segment.count:,} points, {sizes}")

    comparison = compare(found.labels, cloud.component)
    print(comparison.table())
    (out / "figures.csv").write_text(comparison.csv(), encoding="utf-8")
    write_cloud(out / "segments.ply", noisy, extra={"component": found.labels, "truth": cloud.component})


if __name__ == "__main__":
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "out")
    folder.mkdir(parents=True, exist_ok=True)
    main(folder)
