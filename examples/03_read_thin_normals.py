"""Read a scan, thin it to a grid of 3 cm, and take normals. Writes thinned.ply.

Usage: python examples/03_read_thin_normals.py [FOLDER [SCAN]]
"""

import sys
from pathlib import Path

import numpy as np

from segmentation import read, write_cloud
from segmentation.normals import estimate
from segmentation.voxel import thin

ROOM = Path(__file__).with_name("room.laz")


def main(out: Path, scan: Path = ROOM) -> None:
    cloud = read(scan)
    print(f"{scan.name}: {len(cloud):,} points, {cloud.dropped} left out, origin {cloud.origin} m")

    thinned = thin(cloud.xyz, 0.03)
    print(f"thinned to {len(thinned):,} means of {thinned.count.mean():.1f} points")

    normals = estimate(thinned.xyz)
    upright = np.abs(normals[:, 2])
    print(f"walls {(upright < 0.1).mean():.0%}, floor and crown {(upright > 0.9).mean():.0%} of them")

    count = thinned.count.astype(np.int32)
    write_cloud(out / "thinned.ply", thinned.xyz, origin=cloud.origin, normals=normals, extra={"count": count})


if __name__ == "__main__":
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "out")
    folder.mkdir(parents=True, exist_ok=True)
    main(folder, *map(Path, sys.argv[2:3]))
