"""What a scan says before any family is tried: the points above the floor, how the room is turned, and its plan."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

from families.declaration.footprint import RECTANGLE, Footprint
from vaultcad.errors import NoVaultError
from vaultcad.survey.ends import RIM, OpenSide, ends_over, open_sides, splay_of, turn_of
from vaultcad.survey.footprints import Ground, grounds_of, slopes_of
from vaultcad.survey.plan_kernel import places_within

if TYPE_CHECKING:
    from segmentation.cloud import Cloud

Array = NDArray[np.float64]
Real = TypeVar("Real", bound=np.floating)
SMALL = 0.3  # m; what stands above the floor is no vault if it is flatter than this along any axis
FEWEST_POINTS = 1000  # points of a scan
LONGEST_SCAN = 20_000.0  # m, of a scan; neither a building nor what the cells of a grid can number
FEWEST_PLACES = 100  # of them, once they are thinned
LOOKED_AT, AROUND = 1000, 8  # points at which the spacing is measured, and how many neighbours tell it
CHUNK = 1 << 20  # points of the scan that are looked at together
CELL, CELLS = 0.004, (0.02, 0.05)  # thinning, as a share of the scan's diagonal, and its limits in metres
UPRIGHT = 0.1  # |nz| of a wall at the most, where haunches must not be taken for one
WALL_HEIGHT = 0.5  # m, height of plane wall along all of a side that makes it a wall
SPREAD = 0.25, 0.5  # m, and the share of a side's strips of that width that a wall must show in, as piers do not
STEEP = 0.3  # |nz| below which a point weighs as a wall
FLOOR_NORMAL = 0.9  # |nz| of a floor at the least
UNDER = 0.2  # share of all points below the floor at the most
PEAK = 5.0  # how far the most frequent direction of the walls must stand above the middling one
SECOND = 0.5  # of the most frequent direction, how frequent that halfway between is over an octagon
OVER_FLOOR = 0.2  # m over the lowest stone that is no floor, up to where strays of that may lie
GUESSED = 0.1  # weight of the ends of stone that was cut in a valley
BIN = 0.03  # m, of the histograms along the plan's axes


@dataclass(frozen=True)
class Site:
    """Thinned points that may be vault or wall, with normals and weights, and the rectangle they stand on.

    points: (n, 3) in the cloud's local frame. normals: (n, 3), unoriented. weights: (n,), an even share of area each,
    less for walls. yaw: of the rectangle's x axis [rad]. low, high: (2,) its corners in that turned frame [m].
    walled: (2, 2) whether a wall stands there, by axis and side. bottom, crown: heights of
    the points kept [m]. spacing: of the points [m].
    ends: (k, 3) where the stone ends in plan on the sides without a wall, put below all other points [m].
    counts: (n,) how many points of the scan each of the thinned ones stands for.
    ties: (k,) weights of the ends. guessed: (axis, side) of the sides where the stone was cut by guess.
    splay: (2,) by which share the stone is wider at the rectangle's east than in the middle, and at its north.
    """

    points: Array
    normals: Array
    weights: Array
    yaw: float
    low: Array
    high: Array
    walled: NDArray[np.bool_]
    bottom: float
    crown: float
    spacing: float
    ends: Array
    counts: Array
    splay: tuple[float, float] = (0.0, 0.0)
    ties: Array | None = None
    guessed: frozenset[tuple[int, int]] = frozenset()

    def with_guessed_ends(self, axis: int, side: int) -> Site:
        """The same where the stone was cut by guess on a side of the rectangle: its ends there say little."""
        ties = np.ones(len(self.ends)) if self.ties is None else self.ties
        edge = (self.low, self.high)[side][axis]
        near = np.abs(turned(self.ends[:, :2], self.yaw)[:, axis] - edge) < RIM
        return replace(self, ties=np.where(near, GUESSED * ties, ties), guessed=self.guessed | {(axis, side)})

    def only(self, mask: NDArray[np.bool_]) -> Site:
        """The same with the points of a mask (n,)."""
        return replace(self, **{name: getattr(self, name)[mask] for name in ("points", "normals", "weights", "counts")})

    @property
    def centre(self) -> Array:
        """(2,) of the rectangle in the local frame [m]."""
        middle: Array = (self.low + self.high)[None] / 2
        return np.asarray(turned(middle, -self.yaw)[0])

    @property
    def spans(self) -> Array:
        """(2,) of the rectangle [m]."""
        spans: Array = self.high - self.low
        return spans

    @cached_property
    def rectangle(self) -> Ground:
        """That as what a vault may stand over."""
        (x, y), (a, b) = self.centre.tolist(), self.spans.tolist()
        slopes = slopes_of(turned(self.points[:, :2], self.yaw), self.points[:, 2], self.normals[:, 2], STEEP)
        over = Footprint(a, b, slope_x=slopes[0], slope_y=slopes[1], splay_x=self.splay[0], splay_y=self.splay[1])
        return Ground(over, x, y, self.yaw)

    @cached_property
    def grounds(self) -> Mapping[str, tuple[Ground, ...]]:
        """What else normals tell that it may stand over, by the shapes of footprints."""
        return grounds_of(self.points, self.normals, STEEP)

    def over(self, shape: str) -> tuple[Ground, ...]:
        """What a vault over footprints of a shape may stand over."""
        return (self.rectangle,) if shape == RECTANGLE else self.grounds.get(shape, ())


@dataclass(frozen=True)
class Thin:
    """A scan thinned to `spacing` [m], or as sparse as it is: points (n, 3) in the cloud's local frame [m].

    normals: (n, 3), unit. counts: (n,) how many points of the scan each stands for.
    """

    points: Array
    normals: Array
    counts: Array
    spacing: float

    def only(self, mask: NDArray[np.bool_]) -> Thin:
        """The points of a mask (n,)."""
        points, normals = (rows.compress(mask, axis=0) for rows in (self.points, self.normals))  # sooner than by a mask
        return Thin(points, normals, self.counts[mask], self.spacing)


def survey(cloud: Cloud) -> Site:
    """Thin a scan of one vault to a size that suits it, take normals, and find the vault's room in it.

    Raises:
        NoVaultError: the scan is too small for a vault.
    """
    thinned = thin_scan(cloud)
    return find_site(thinned, cloud.xyz)


def thin_scan(cloud: Cloud) -> Thin:
    """Thin a scan to a size that suits it, and take normals.

    Raises:
        NoVaultError: the scan is too small for a vault.
    """
    from segmentation.normals import estimate
    from segmentation.voxel import thin

    if len(cloud) < FEWEST_POINTS:
        raise NoVaultError(f"no vault found: the scan has {len(cloud)} points; at least {FEWEST_POINTS} are needed")
    # Axis by axis: numpy takes several times as long over many rows of three.
    size = float(np.linalg.norm([float(np.ptp(axis)) for axis in cloud.xyz.T]))
    if size == 0:
        raise NoVaultError("no vault found: all points of the scan are one and the same")
    if size > LONGEST_SCAN:
        raise NoVaultError(f"no vault found: the scan is {size / 1000:,.0f} km long; crop it to one building")
    voxel = float(np.clip(CELL * size, *CELLS))
    thinned = thin(cloud.xyz, voxel)
    normals = estimate(thinned.xyz)
    # Means round off groins and springings, so the fit gets a point of the scan from each cell.
    points = cloud.xyz[thinned.first].astype(np.float64)
    good: NDArray[np.bool_] = np.asarray(np.isfinite(normals).all(axis=1))
    if good.sum() < FEWEST_PLACES:
        raise NoVaultError(
            f"no vault found: {good.sum()} places of the scan have a surface; at least {FEWEST_PLACES} are needed"
        )
    spacing = max(voxel, _spacing(points))
    return Thin(points, normals.astype(np.float64), thinned.count.astype(np.float64), spacing).only(good)


def _spacing(points: Array) -> float:
    """Distance [m] at which points (n, 3) lie on a surface, of the middling one, by how far its neighbours are."""
    from scipy.spatial import cKDTree

    some = points[:: max(1, len(points) // LOOKED_AT)]
    reach, _ = cKDTree(points).query(some, [AROUND + 1])
    return float(np.median(reach) * np.sqrt(np.pi / AROUND))


def find_site(thin: Thin, xyz: NDArray[np.floating]) -> Site:
    """The room of one vault in thinned points, up being +z; `xyz` (n, 3) [m] are the points before thinning.

    Raises:
        NoVaultError: nothing stands above the floor.
    """
    whole, thin = thin, above_floor(thin)
    yaw = yaw_of(thin.points, thin.normals)
    site = _along(yaw, thin)
    if site.walled.all():
        return site
    # A floor goes on beyond an open side.
    lowest = site.bottom + OVER_FLOOR if len(thin.points) < len(whole.points) else -np.inf
    sides = _open_sides(xyz, site, lowest)
    if turn := turn_of(sides):  # the walls of a splay are as many as its axis, and it lies between them
        site = _along(yaw + turn, thin)
        sides = _open_sides(xyz, site, lowest)
    return _open(xyz, site, sides, lowest)


def _along(yaw: float, thin: Thin) -> Site:
    """A site with its rectangle turned by `yaw` [rad], its sides without walls where the points end."""
    points, normals = thin.points, thin.normals
    steep = np.abs(normals[:, 2]) < STEEP
    low, high, walled = rectangle(
        turned(points[:, :2], yaw), turned(normals[:, :2], yaw), np.abs(normals[:, 2]) < UPRIGHT, thin.spacing
    )
    weights = np.where(steep, 0.4, 1.0)
    top = points[inside(turned(points[:, :2], yaw), low, high), 2]
    crown = float(np.quantile(top, 0.998)) if len(top) else float(points[:, 2].max())
    bottom = float(points[:, 2].min())
    none, counts = np.empty((0, 3)), thin.counts
    return Site(points, normals, weights, yaw, low, high, walled, bottom, crown, thin.spacing, none, counts)


def above_floor(thin: Thin) -> Thin:
    """The points above the floor.

    Raises:
        NoVaultError: nothing stands above the floor.
    """
    above = thin.only(~floor_of(thin.points, thin.normals))
    if len(above.points) < FEWEST_PLACES or np.ptp(above.points, axis=0).min() < SMALL:
        raise NoVaultError(
            "no vault found: nothing but a floor or a wall is in the scan; scan the whole room under a vault"
        )
    return above


def support(counts: Array) -> Array:
    """How much places with so many points (n,) of the scan tell of what hangs there: as many as most have, or less.

    A dense scan has strays in many places, by single points: on the way from an edge to what is behind it.
    """
    shown: Array = np.minimum(counts / np.median(counts), 1.0)
    return shown


def direction(yaw: float, points: NDArray[Real]) -> tuple[Real, Real]:
    """Cosine and sine of an angle [rad], as numbers of those that points have."""
    number = points.dtype.type
    return number(np.cos(yaw)), number(np.sin(yaw))


def turned(xy: NDArray[Real], yaw: float) -> NDArray[Real]:
    """Points or directions (n, 2) in axes turned by `yaw` [rad]."""
    c, s, (x, y) = float(np.cos(yaw)), float(np.sin(yaw)), xy.T
    return np.stack([c * x + s * y, c * y - s * x], axis=1)


def floor_of(points: Array, normals: Array) -> NDArray[np.bool_]:
    """Level points of the lowest level that holds a good share of all level points, and all below it."""
    z = points[:, 2]
    level = np.abs(normals[:, 2]) > FLOOR_NORMAL
    if level.sum() < 50:
        return np.zeros(len(z), bool)
    low, high = np.quantile(z, [0.001, 0.999])
    counts, edges = np.histogram(z[level & (z < low + 0.5 * (high - low))], bins=np.arange(low - 0.2, high + 0.1, 0.1))
    k = int(counts.argmax())
    # Soffits of arches are level too, but much hangs and stands below them.
    if counts.max() < max(0.15 * level.sum(), 1) or (z < edges[k]).mean() > UNDER:
        none: NDArray[np.bool_] = z < low - 0.3
        return none
    floor: NDArray[np.bool_] = (level & (z < edges[k + 1] + 0.15)) | (z < edges[k] + 0.05)
    return floor


def yaw_of(points: Array, normals: Array) -> float:
    """Direction of the walls and of the cylinders' generatrices, modulo a right angle; else of the least rectangle."""
    flat = normals[:, :2]
    size = np.hypot(flat[:, 0], flat[:, 1])
    angle = np.mod(np.arctan2(flat[:, 1], flat[:, 0]), np.pi / 2)
    use = size > 0.3
    bins = 180
    counts = np.bincount((angle[use] / (np.pi / 2) * bins).astype(int) % bins, weights=size[use] ** 2, minlength=bins)
    smooth = np.sum([np.roll(counts, k) * (3 - abs(k)) for k in range(-2, 3)], axis=0) / 9
    k = int(np.argmax(smooth))
    if smooth[k] < PEAK * np.median(smooth) or use.sum() < 100:
        return _least_rectangle(points[:, :2])
    # Over an octagon there are two: that of the square about it is narrower.
    other = (k + bins // 2) % bins
    if smooth[other] > SECOND * smooth[k]:
        hung = points[np.abs(normals[:, 2]) > STEEP, :2]
        k = min(k, other, key=lambda at: float(np.prod(np.ptp(turned(hung, _middle(at, bins)), axis=0))))
    centre = _middle(k, bins)
    off = np.mod(angle[use] - centre + np.pi / 4, np.pi / 2) - np.pi / 4
    near = np.abs(off) < np.radians(4)
    yaw = centre + float(np.median(off[near]))
    return float(np.mod(yaw + np.pi / 4, np.pi / 2) - np.pi / 4)


def _middle(k: int, bins: int) -> float:
    """Of a bin of a right angle [rad]."""
    return (k + 0.5) / bins * np.pi / 2


def _least_rectangle(xy: Array) -> float:
    """Yaw in [-45, 45) degrees of the rectangle of least area about the points (Freeman and Shapira 1975)."""
    from scipy.spatial import ConvexHull

    hull = xy[ConvexHull(xy).vertices]
    edges = np.roll(hull, -1, axis=0) - hull
    angles = np.mod(np.arctan2(edges[:, 1], edges[:, 0]) + np.pi / 4, np.pi / 2) - np.pi / 4
    areas = [np.prod(np.ptp(turned(hull, a), axis=0)) for a in angles]
    return float(angles[int(np.argmin(areas))])


def rectangle(
    xy: Array, normals: Array, upright: NDArray[np.bool_], spacing: float
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Outermost walls along both axes; where there is none, where the points end.

    A wall is upright and plane over so much of its side that no haunch can be taken for it.
    """
    low, high, walled = np.empty(2), np.empty(2), np.zeros((2, 2), np.bool_)
    for axis in range(2):
        ends = np.quantile(xy[:, axis], [0.002, 0.998])
        wall = np.flatnonzero(upright & (np.abs(normals[:, axis]) > 0.9))
        edges = np.arange(ends[0] - 0.5, ends[1] + 0.5 + BIN, BIN)
        counts = np.histogram(xy[wall, axis], bins=edges)[0].astype(float)
        counts = counts + np.roll(counts, 1)  # a wall may straddle two bins
        length = float(np.quantile(xy[:, 1 - axis], 0.998) - np.quantile(xy[:, 1 - axis], 0.002))
        enough = max(0.25 * counts.max(initial=0.0), WALL_HEIGHT * length / spacing**2)
        strong = np.flatnonzero(counts >= enough)
        middle = ends.mean()
        for side, corner in ((0, low), (1, high)):
            corner[axis] = ends[side]
            mine = [k for k in strong if (edges[k] < middle) == (side == 0)]
            for k in mine if side == 0 else mine[::-1]:
                near = wall[np.abs(xy[wall, axis] - edges[k]) < 2 * BIN]
                strips = np.unique(np.floor(xy[near, 1 - axis] / SPREAD[0]))
                if len(strips) * SPREAD[0] < SPREAD[1] * length:
                    continue  # the faces of piers
                corner[axis] = float(np.median(xy[near, axis]))
                walled[axis, side] = True
                break
    return low, high, walled


def inside(xy: NDArray[np.floating], low: Array, high: Array) -> NDArray[np.bool_]:
    """Which points (n, 2) lie between two corners (2,) [m]."""
    x, y = xy[:, 0], xy[:, 1]
    found: NDArray[np.bool_] = (x > low[0]) & (x < high[0]) & (y > low[1]) & (y < high[1])
    return found


def _open_sides(xyz: NDArray[np.floating], site: Site, lowest: float) -> list[OpenSide]:
    """The sides of a site without a wall, by all points (n, 3) above the lowest [m]."""
    xyz = np.ascontiguousarray(xyz)
    near = places_within(xyz, *direction(site.yaw, xyz), site.low - RIM, site.high + RIM, lowest)
    return open_sides(near, turned(site.points[:, :2], site.yaw), site.low, site.high, site.walled)


def _open(xyz: NDArray[np.floating], site: Site, sides: list[OpenSide], lowest: float) -> Site:
    """The site with where the stone ends on its open sides: of each strip across an edge one point."""
    shape = next(iter(site.grounds), None)
    if shape is None:
        ends = turned(np.concatenate([side.ends for side in sides]), -site.yaw)
    else:
        upright = site.points[np.abs(site.normals[:, 2]) < UPRIGHT]
        above = xyz[xyz[:, 2] > lowest] if np.isfinite(lowest) else xyz
        ends = ends_over(shape, site.grounds[shape][0], above, upright, site.spacing)
    low, high = site.low.copy(), site.high.copy()
    for side in sides:
        (low, high)[side.side][side.axis] = side.middle
    ends = np.column_stack([ends, np.full(len(ends), site.bottom - 1.0)])
    return replace(site, low=low, high=high, ends=ends, splay=splay_of(sides, high - low))
