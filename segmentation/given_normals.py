"""Normals that come with a cloud: whether they are of any use."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from segmentation.normals import estimate
from segmentation.notes import Note

Floats = NDArray[np.float64]

LOOKED_AT = 1500  # places at which they are compared with what the points around say
NEIGHBOURS = 12
THERE = 0.5  # share of normals that must not be zero
ALIKE_NORMALS = np.cos(np.radians(30.0))  # cosine between a normal and the estimate beside it
RIGHT = 0.6  # share of the places where they are alike; noise and edges leave less than all
ONE = np.cos(np.radians(2.0)), 0.98  # cosine to one direction, and the share of normals that have it, if all do
VARIED = 0.8  # share of the estimates along that direction, below which it cannot be true
UNIT = 0.01  # by which the middle length may differ from 1


def usable(xyz: Floats, given: NDArray[np.floating]) -> tuple[Floats | None, Note | None]:
    """Normals (m, 3) given at thinned points (m, 3) [m] as unit vectors, NaN where one is zero; None if useless.

    Useless are normals that are mostly zero, all the same on a surface that turns, or others than those of the points.
    Their sign says nothing. The note tells what was found wrong with them.
    """
    normal = np.asarray(given, dtype=np.float64)
    length = np.sqrt((normal**2).sum(axis=1))
    there = np.isfinite(length) & (length > 0)
    if there.mean() < THERE:
        return None, _useless("zero" if not there.any() else f"zero on {1 - there.mean():.0%} of the points")
    unit = normal / np.where(there, length, np.nan)[:, None]
    some = np.flatnonzero(there)
    some = some[np.linspace(0, len(some) - 1, min(LOOKED_AT, len(some))).astype(np.int64)]
    seen = np.asarray(estimate(xyz, NEIGHBOURS, at=some), np.float64)
    known = np.isfinite(seen).all(axis=1)
    if known.sum() >= len(some) / 2:
        cosine = np.abs(np.einsum("ij,ij->i", unit[some], seen))[known]
        axis = _axis(unit[some])
        one = np.mean(np.abs(unit[some] @ axis) > ONE[0]) >= ONE[1]
        if one and np.mean(np.abs(seen[known] @ axis) > ALIKE_NORMALS) < VARIED:
            return None, _useless("all the same")
        if np.mean(cosine > ALIKE_NORMALS) < RIGHT:
            return None, _useless(f"off those of the surface on {np.mean(cosine <= ALIKE_NORMALS):.0%} of it")
    if abs(float(np.median(length[there])) - 1) > UNIT:
        return unit, Note("normals", "the normals of the scan are not of unit length: taken as directions")
    return unit, None


def _axis(directions: Floats) -> Floats:
    """The direction (3,) that most of the directions (k, 3) are nearest to, of whatever sign."""
    _, vectors = np.linalg.eigh(directions.T @ directions)
    return np.asarray(vectors[:, -1], np.float64)


def _useless(why: str) -> Note:
    return Note("normals", f"the normals of the scan are {why}: estimated anew")
