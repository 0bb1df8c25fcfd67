"""Clouds to write and read: the fixture `clouds` holds their makers."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from segmentation import write_cloud

N = 5000


def points(n: int = N, seed: int = 0) -> np.ndarray:
    """Points of a room, on a grid of 0.1 mm so that LAS holds them exactly."""
    return np.round(np.random.default_rng(seed).uniform(0, 8, (n, 3)), 4)


def attributes(n: int = N, seed: int = 1) -> dict[str, Any]:
    rng = np.random.default_rng(seed)
    normals = rng.normal(size=(n, 3))
    return {
        "normals": (normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype(np.float32),
        "color": rng.integers(0, 256, (n, 3)).astype(np.uint8),
        "intensity": rng.integers(0, 65536, n).astype(np.uint16),
    }


def sample(folder: Path, suffix: str, n: int = N) -> Path:
    """A good file of any format that can be written or made up by hand."""
    path = folder / f"scan{suffix}"
    if suffix in (".pcd", ".pts", ".ptx", ".csv"):
        MAKERS[suffix](path, points(n))
    else:
        write_cloud(path, points(n), **attributes(n))
    return path


def make_pts(path: Path, xyz: np.ndarray) -> None:
    path.write_text(f"{len(xyz)}\n" + "".join(f"{x:.4f} {y:.4f} {z:.4f} 7 1 2 3\n" for x, y, z in xyz))


def make_ptx(path: Path, xyz: np.ndarray) -> None:
    matrix = "\n".join(" ".join(f"{v:g}" for v in row) for row in [[0, 0, 0], *np.eye(3), *np.eye(4)])
    path.write_text(f"{len(xyz)}\n1\n{matrix}\n" + "".join(f"{x:.4f} {y:.4f} {z:.4f} 0.5\n" for x, y, z in xyz))


def make_csv(path: Path, xyz: np.ndarray) -> None:
    path.write_text("X,Y,Z\n" + "".join(f"{x:.4f},{y:.4f},{z:.4f}\n" for x, y, z in xyz))


def make_pcd(path: Path, xyz: np.ndarray) -> None:
    header = (
        "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
        f"WIDTH {len(xyz)}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {len(xyz)}\nDATA binary\n"
    )
    path.write_bytes(header.encode() + xyz.astype("<f4").tobytes())


MAKERS = {".pts": make_pts, ".ptx": make_ptx, ".csv": make_csv, ".pcd": make_pcd}


@pytest.fixture(scope="session")
def clouds() -> SimpleNamespace:
    return SimpleNamespace(points=points, attributes=attributes, sample=sample)
