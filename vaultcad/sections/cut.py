"""The scan near a plane, measured against the ideal line in it, and the stone's line that follows.

Each point within the slab tells how far the stone is from the model there. So what the surface climbs within the slab,
beside a groin or where the plane cuts it at an angle, is no error: it is the model's, and taken off.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from families import Vault
from families.void.upright import Upright
from vaultcad.group_medians import group_medians
from vaultcad.sections.crease import CREASED, showing
from vaultcad.sections.guide import Guide
from vaultcad.sections.section import Level, ModelLine, ProfileRun
from vaultcad.sections.smooth import smooth

Floats = NDArray[np.float64]
Field = Callable[[Floats], Floats]  # displacements (n, 3) [m] of points (n, 3) in the vault's frame

FARTHEST = 0.12  # m from the ideal line, of a point that is part of its profile
ALIKE = 3.0  # scatters from the median of its cell, beyond which a point is clutter
FINEST = 0.001  # m, least scatter of a cell
TEXTURE = 4.0  # points of a cell that tell as much as endless many: what is left is the stone's own relief
SIDEWAYS = 0.1  # of an offset, by which it is unsure: stone that moved along the surface as well shows another place
AT_ENDS = 0.7  # of how far stone has moved, by which a line is unsure at its ends and kinks
BESIDE_ENDS = 0.1  # m, over which that fades
ON_CREASE = 0.002  # m to either side of a plane, between which a crease in it lies
GAP = 0.06  # m from the nearest cell with points, to which a line goes on
CORNER = 0.05  # m that two lines are extended to meet
AT_ONCE = 32_768  # points that are looked at together


@dataclass(frozen=True, eq=False)
class Stations:
    """What the scan says along a guide, a cell of the grid each.

    sample: (m,) nearest sample of the guide. s: (m,) [m] along its piece. offset: (m,) [m] of the stone from the ideal
    line along its normal, positive into the stone. std: (m,) [m]. count: (m,) points. unsure: (m,) [m] by which all of
    them may be off together, where a crease runs along the plane.
    """

    sample: NDArray[np.int64]
    s: Floats
    offset: Floats
    std: Floats
    count: NDArray[np.int64]
    unsure: Floats

    def of(self, guide: Guide, piece: slice) -> NDArray[np.bool_]:
        """Those (m,) on one piece of their guide."""
        return np.asarray((self.sample >= piece.start) & (self.sample < piece.stop), np.bool_)

    def at(self, guide: Guide) -> Floats:
        """Where the stone is, (m, 2) [m]."""
        return np.asarray(guide.at[self.sample] + self.offset[:, None] * guide.normal[self.sample], np.float64)


def in_slab(xyz: NDArray[np.floating], frame: Floats, cut: Upright | Level, slab: float) -> NDArray[np.int64]:
    """Which of points (n, 3) [m] lie within `slab` [m] of a plane of the frame that `frame` (3, 4) brings them into."""
    corner = frame[:, 3]
    if isinstance(cut, Level):
        across, offset = frame[2, :3], corner[2] - cut.z
    else:
        normal = np.array(cut.normal)
        across, offset = normal @ frame[:2, :3], float(normal @ (corner[:2] - cut.origin))
    way, shift = across.astype(xyz.dtype), xyz.dtype.type(offset)
    # By parts that stay in the processor's cache: of millions of points twice as fast.
    parts = [
        np.flatnonzero(np.abs(xyz[start : start + AT_ONCE] @ way + shift) < slab) + start
        for start in range(0, len(xyz), AT_ONCE)
    ]
    return np.concatenate(parts) if parts else np.empty(0, np.int64)


def stations(vault: Vault, plane: Upright, guide: Guide, points: Floats, grid: float) -> Stations:
    """Points (n, 3) [m] of the vault's frame near a plane, in cells of `grid` [m] along a guide."""
    from scipy.spatial import cKDTree

    away, nearest = cKDTree(guide.at).query(plane.drawn(points), distance_upper_bound=FARTHEST)
    near, sample = np.asarray(away) < FARTHEST, np.asarray(nearest)
    points, sample = points[near], sample[near]
    surface = vault.evaluate(points)
    slant = (plane.directions(guide.normal[sample]) * surface.normal).sum(axis=1)
    hit = slant > 0.5 * guide.slant[sample]  # else it is another face, behind a crease
    points, sample, offset = points[hit], sample[hit], (surface.distance / np.where(hit, slant, 1.0))[hit]
    s = guide.s[sample] + ((plane.drawn(points) - guide.at[sample]) * guide.tangent[sample]).sum(axis=1)
    piece = guide.piece[sample]
    cell = (piece << 32) + np.floor(np.maximum(s, 0.0) / grid).astype(np.int64)
    tilt = np.where(_on_crease(vault, plane, guide)[sample], surface.normal[hit, :2] @ np.array(plane.normal), 0.0)
    here, unsure = showing(piece, cell, s, offset, plane.off(points), tilt)
    return _cells(guide, cell[here], s[here], offset[here], np.abs(slant[hit][here]), unsure[here])


def _on_crease(vault: Vault, plane: Upright, guide: Guide) -> NDArray[np.bool_]:
    """Which samples (n,) of a guide are on a crease of the ideal vault, on which its normals turn across the plane."""
    at, across = plane.placed(guide.at), np.array([*plane.normal, 0.0])
    one, other = (vault.evaluate(at + way * ON_CREASE * across).normal @ across for way in (-1, 1))
    return np.asarray(np.abs(other - one) > 2 * CREASED, np.bool_)


def wall_stations(guide: Guide, points: Floats, grid: float) -> Stations:
    """Points (n, 2) [m] of a level section in cells along a guide that goes round the walls."""
    from scipy.spatial import cKDTree

    away, nearest = cKDTree(guide.at).query(points, distance_upper_bound=FARTHEST)
    near = np.asarray(away) < FARTHEST
    points, sample = points[near], np.asarray(nearest)[near]
    apart = points - guide.at[sample]
    s, offset = (
        (guide.s[sample] + (apart * guide.tangent[sample]).sum(axis=1)),
        (apart * guide.normal[sample]).sum(axis=1),
    )
    cell = (guide.piece[sample] << 32) + np.floor(np.maximum(s, 0.0) / grid).astype(np.int64)
    return _cells(guide, cell, s, offset, np.ones(len(s)), np.zeros(len(s)))


def _cells(guide: Guide, cell: NDArray[np.int64], s: Floats, offset: Floats, slant: Floats, unsure: Floats) -> Stations:
    """The means of each cell, without what lies far from its median; `slant` turns offsets into distances."""
    kept = np.ones(len(cell), np.bool_)
    if len(cell):
        keys, group = np.unique(cell, return_inverse=True)
        middle = group_medians(group, offset, len(keys))
        scatter = np.maximum(1.4826 * group_medians(group, np.abs(offset - middle[group]), len(keys)), FINEST)
        kept = np.abs(offset - middle[group]) <= ALIKE * scatter[group]
    keys, group = np.unique(cell[kept], return_inverse=True)
    count = np.bincount(group, minlength=len(keys))
    means = [np.bincount(group, values[kept], len(keys)) / count for values in (s, offset, unsure)]
    lean = np.bincount(group, slant[kept], len(keys)) / count
    spread = lean**2 * np.bincount(group, (offset[kept] - means[1][group]) ** 2, len(keys)) / np.maximum(count - 1, 1)
    usual = float(np.sqrt(np.median(spread[count > 2]))) if (count > 2).any() else FINEST
    std = max(usual, FINEST) / lean * np.sqrt(1 / count + 1 / TEXTURE)
    piece, sample = keys >> 32, np.empty(len(keys), np.int64)
    for part in guide.pieces():
        own = piece == guide.piece[part.start]
        sample[own] = part.start + np.clip(np.searchsorted(guide.s[part], means[0][own]), 0, part.stop - part.start - 1)
    return Stations(sample, means[0], means[1], std, count, means[2])


def profile(guide: Guide, found: Stations, grid: float) -> tuple[ProfileRun, ...]:
    """The stone's line along a guide, open where the scan saw nothing.

    It is smooth on each piece of the guide; ends of pieces are extended to meet.
    """
    rows: list[tuple[Floats, Floats, NDArray[np.uint16], bool]] = []
    for piece in guide.pieces():
        mine = found.of(guide, piece)
        runs = list(_piece(guide, piece, found, mine, grid)) if mine.any() else []
        for line, std, component, meets in runs:
            rows.append((line, std, component, meets))
        if not runs:
            rows.append((np.empty((0, 2)), np.empty(0), np.empty(0, np.uint16), False))
    joined: list[list[tuple[Floats, Floats, NDArray[np.uint16]]]] = []
    for k, (line, std, component, meets) in enumerate(rows):
        if not len(line):
            continue
        before = rows[k - 1][0] if k else np.empty((0, 2))
        corner = _corner(before, line) if meets and len(before) > 1 and len(line) > 1 else None
        if corner is None:
            joined.append([(line, std, component)])
        else:
            joined[-1].append((corner[None], std[:1], component[:1]))
            joined[-1].append((line, std, component))
    return tuple(ProfileRun(*(np.concatenate(column) for column in zip(*run, strict=True))) for run in joined)


def _piece(
    guide: Guide, piece: slice, found: Stations, mine: NDArray[np.bool_], grid: float
) -> Iterator[tuple[Floats, Floats, NDArray[np.uint16], bool]]:
    """Its lines, deviations and components, and whether a line begins where the piece does."""
    s = guide.s[piece]
    at, own = found.s[mine], np.argsort(found.s[mine])
    at = at[own]
    curve = smooth(at, found.offset[mine][own], found.std[mine][own] ** -2, (float(s[0]), float(s[-1])))
    places = np.linspace(s[0], s[-1], max(2, round(float(s[-1] - s[0]) / grid) + 1))
    offset, std = curve(places)
    std = np.sqrt(
        std**2
        + (SIDEWAYS * offset) ** 2
        + np.interp(places, at, found.unsure[mine][own]) ** 2
        + _at_ends(guide, piece, found, places) ** 2
    )
    columns = [np.interp(places, s, values[piece, k]) for values in (guide.at, guide.normal) for k in (0, 1)]
    line = np.column_stack(columns[:2]) + offset[:, None] * np.column_stack(columns[2:])
    component = guide.component[piece][np.clip(np.searchsorted(s, places), 0, len(s) - 1)]
    nearest = np.clip(np.searchsorted(at, places), 1, max(len(at) - 1, 1))
    apart = np.minimum(np.abs(places - at[nearest - 1]), np.abs(places - at[np.minimum(nearest, len(at) - 1)]))
    seen = apart < max(GAP, 1.5 * grid)
    ends = np.flatnonzero(np.diff(seen, prepend=False, append=False))
    for a, b in zip(ends[::2].tolist(), ends[1::2].tolist(), strict=True):
        if b - a > 1:
            yield line[a:b], std[a:b], component[a:b], a == 0


def _at_ends(guide: Guide, piece: slice, found: Stations, places: Floats) -> Floats:
    """How unsure a line is beside the ends of its piece (n,) [m], for stone has moved along it, too.

    By about as much as across it: a kink stands elsewhere then, and a foot, where the vault is narrow, shows the wall.
    """
    moved = float(np.sqrt(np.mean(found.offset**2)))
    away = np.minimum(places - guide.s[piece.start], guide.s[piece.stop - 1] - places)
    return np.asarray(AT_ENDS * moved * np.exp(-away / BESIDE_ENDS), np.float64)


def _corner(before: Floats, line: Floats) -> Floats | None:
    """Where two lines meet that are extended a little, if they do."""
    a, b = before[-1], line[0]
    one, other = a - before[-2], b - line[1]
    cross = one[0] * other[1] - one[1] * other[0]
    if np.hypot(*(a - b)) > CORNER or abs(cross) < 1e-12:
        return None
    share = ((b[0] - a[0]) * other[1] - (b[1] - a[1]) * other[0]) / cross
    met = a + share * one
    if max(np.hypot(*(met - a)), np.hypot(*(met - b))) > CORNER:
        return np.asarray((a + b) / 2, np.float64)
    return np.asarray(met, np.float64)


def displaced(vault: Vault, plane: Upright, guide: Guide, field: Field) -> ModelLine:
    """The line of the model whose surface is moved by a field, along a guide."""
    moved = (field(plane.placed(guide.at)) * guide.space_normal).sum(axis=1)
    line = guide.at + (moved / guide.slant)[:, None] * guide.normal
    return ModelLine(line, guide.component[1:])
