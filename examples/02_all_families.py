"""All families as clouds: points even by area, with normals and component labels. Writes sail.ply, barrel.ply ….

Usage: python examples/02_all_families.py [FOLDER]
"""

import sys
from pathlib import Path

import numpy as np

from families import FAMILIES
from segmentation import write_cloud


def main(out: Path) -> None:
    rng = np.random.default_rng(1)
    for family in FAMILIES:
        vault = family()
        cloud = vault.sample(50_000, rng)
        path = out / f"{family.id}.ply"
        write_cloud(path, cloud.xyz, normals=cloud.normals, extra={"component": cloud.component})
        counts = np.bincount(cloud.component)[1:]
        names = ", ".join(f"{name} {n:,}" for name, n in zip(vault.components, counts, strict=True))
        print(f"{path}: {vault.title}: {names}")


if __name__ == "__main__":
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "out")
    folder.mkdir(parents=True, exist_ok=True)
    main(folder)
