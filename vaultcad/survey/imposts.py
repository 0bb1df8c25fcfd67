"""Imposts: ledges on which a vault stands before its walls, so that these say nothing of its span.

A wall ends under a ledge. What rises from the ledge's edge has nothing behind it; where stone is seen there, the vault
springs from the wall, and the ledge is an ornament in front of it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vaultcad.survey.thinned_scan import UPRIGHT, Site, turned

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

ON_WALL = 0.03  # m off a side, up to which stone is its wall's
OUT = 0.05, 0.35  # m before its wall that the face of a ledge stands; no haunch is upright so far out
FACING = 0.9  # cosine between the normal of what is upright and its side's
STRIP, LEAST = 0.25, 0.5  # m along a side, in which it is looked at; share of the strips with a wall that show a ledge
WALL = 0.3  # m of wall in a strip at the least
FACE = 0.05, 0.35  # m under where upright stone of a wall ends, and over that, between which the face of its ledge is
BEHIND = 0.12, 0.6  # m over that, between which nothing may be behind that face
STRAY = 0.15  # share of what is there that may be
LEVEL, PLANE = 0.04, 0.025  # m by which ends of walls are off one line, and faces off one plane, mostly
HIDDEN = 0.02  # m behind the face from which on stone is the ledge's, or the wall's under it
FEWEST = 3  # strips, and points of a face in one


def within_imposts(site: Site) -> Site:
    """A site up to the faces of the imposts along its walls, without what is behind these; as it is without any."""
    xy, facing = (turned(of[:, :2], site.yaw) for of in (site.points, site.normals))
    kept, low, high = np.ones(len(xy), np.bool_), site.low.copy(), site.high.copy()
    for axis, side in np.argwhere(site.walled).tolist():
        sign, edge = (1.0, site.low) if side == 0 else (-1.0, site.high)
        depth = sign * (xy[:, axis] - edge[axis])
        upright = (np.abs(site.normals[:, 2]) < UPRIGHT) & (np.abs(facing[:, axis]) > FACING)
        out = _ledge(depth, xy[:, 1 - axis], site.points[:, 2], upright)
        if out > 0:
            kept &= depth > out - HIDDEN
            (low, high)[side][axis] += sign * out
    return site if kept.all() else replace(site.only(kept), low=low, high=high)


def _ledge(depth: Array, along: Array, height: Array, upright: Mask) -> float:
    """How far a ledge stands out of the wall of a side [m], if a vault stands on its edge; 0 if there is none.

    depth, along, height: (n,) of points, from the side into the room, along it and upwards [m]. upright: (n,) whether
    they face as it does.
    """
    walls, found = 0, []
    near = np.flatnonzero(depth < OUT[1] + OUT[0])
    strip = np.floor(along[near] / STRIP)
    for k in np.unique(strip):
        mine = near[strip == k]
        d, z, plane = depth[mine], height[mine], upright[mine]
        wall = z[plane & (np.abs(d) < ON_WALL)]
        if len(wall) < FEWEST or np.ptp(wall) < WALL:
            continue
        walls, end = walls + 1, float(wall.max())
        face = d[plane & (d > OUT[0]) & (d < OUT[1]) & (z > end - FACE[0]) & (z < end + FACE[1])]
        if len(face) < FEWEST:
            continue
        out = float(np.median(face))
        over = d[(z > end + BEHIND[0]) & (z < end + BEHIND[1])]
        if len(over) and (over < out - ON_WALL).mean() < STRAY:
            found.append((k, end, out))
    if len(found) < max(FEWEST, LEAST * walls):
        return 0.0
    place, ends, outs = np.array(found).T
    off = ends - np.polyval(np.polyfit(place, ends, 1), place)
    level = np.median(np.abs(off)) < LEVEL and np.median(np.abs(outs - np.median(outs))) < PLANE
    return float(np.median(outs)) if level else 0.0
