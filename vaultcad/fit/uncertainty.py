"""How sure pose, parameters and derived sizes are, allowing for a settlement that hides in them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields

import numpy as np
from numpy.typing import NDArray

from families import Vault
from families.declaration.once import Once
from vaultcad.fit.freedom import Freedom
from vaultcad.fit.settlement import block_means, motion
from vaultcad.fit.solve import POSE, Placed, Solution
from vaultcad.uncertain import Covariance

Array = NDArray[np.float64]

DIFFERENCE = 1e-6  # of finite differences
VAGUE = 1e-8  # weight of a parameter's range against the points, share of the largest


def covariance(solution: Solution, points: Array) -> Covariance:
    """Covariance of the unknowns of a solution from points (n, 3) [m], about the vault before it settled.

    Two parts: how far the motions that the residuals make likely would move this weighted least-squares fit, and the
    square of the way by which generalised least squares, which know of these motions, put the unknowns elsewhere. What
    the points say nothing of is as unsure as its range is wide. An unknown that rests on its bound counts as free:
    where the bound keeps it off the truth, that is what it misses. Parts of the pose that were held have none.
    """
    blocks, placed = block_means(solution, points), solution.placed
    plan = placed.vault.plan
    moved = motion(blocks, plan, placed.vault.derived_values()["rise"])

    hessian = (solution.jacobian.T * solution.weights) @ solution.jacobian
    vague = _vague(solution)
    weight = VAGUE * float(np.diag(hessian).max(initial=0.0))
    bread = _inverse(hessian + weight * vague)
    pull = (blocks.jacobian * blocks.weight[:, None]).T
    wandering = bread @ (pull @ moved @ pull.T + weight**2 * vague) @ bread

    usable, jacobian = blocks.usable, blocks.jacobian[blocks.usable]
    informed = np.linalg.solve(moved[np.ix_(usable, usable)], np.column_stack([jacobian, blocks.residual[usable]]))
    shift = _inverse(jacobian.T @ informed[:, :-1] + vague) @ (jacobian.T @ informed[:, -1])
    return Covariance(solution.names, wandering + np.outer(shift, shift))


def open_ends(solution: Solution, apart: tuple[float, float]) -> Array:
    """Covariance (k, k) of the unknowns where the plan ends on sides without walls, in a sparse scan or by guess.

    apart: standard deviation [m] of the half extents in x and y, and of the middle between them; where walls tell, 0.
    What of the stone is the vault's and what an arch's beside it is told by few points there, or by none.
    """
    pose, size = solution.placed.pose, len(solution.names)
    out = np.zeros((size, size))
    for axis, sigma in enumerate(apart):
        if sigma == 0:
            continue
        slopes = np.zeros(size)
        for k, vaults, step in _moved(solution):
            less, more = (vault.plan.half[axis] for vault in vaults)
            slopes[k] = (more - less) / step
        if slopes.any():
            out += sigma**2 * np.outer(slopes, slopes) / float(slopes @ slopes) ** 2
        way = np.zeros(size)
        way[:2] = (np.cos(pose.yaw), np.sin(pose.yaw)) if axis == 0 else (-np.sin(pose.yaw), np.cos(pose.yaw))
        out += sigma**2 * np.outer(way, way)
    return out


def _vague(solution: Solution) -> Array:
    """Diagonal (k, k): what the ranges of the parameters say of them, as the inverse of a variance."""
    ranges = {p.name: p.range for p in solution.placed.vault.parameters()}
    wide = [np.inf if name in POSE else ranges[name].high - ranges[name].low for name in solution.names]
    return np.diag(12 / np.array(wide) ** 2)


def _inverse(matrix: Array) -> Array:
    """Of a symmetric matrix whose unknowns differ in scale; zero where a row is."""
    size = np.sqrt(np.diag(matrix))
    size[size == 0] = np.inf
    out: Array = np.linalg.pinv(matrix / np.outer(size, size), rcond=1e-14, hermitian=True) / np.outer(size, size)
    return out


def loosened(solution: Solution, free: Freedom, points: Array) -> Solution:
    """The same solution from points (n, 3) [m] with the unknowns that `free` moves, at rest where they are.

    So a constraint that was kept because it costs little is as unsure as what it holds would be without it.
    """
    known = {f.name: getattr(solution, f.name) for f in fields(solution)}
    return _Loosened(**{**known, "names": (*POSE, *free.names), "points": points, "free": free})


class _Loosened(Solution):
    """A solution at rest where not all of its unknowns would be."""

    @Once
    def jacobian(self) -> Array:
        """Derivatives (n, k) of the distances by the unknowns, from steps both ways."""
        return slopes_of_distances(self, self.points)


def slopes_of_sizes(solution: Solution) -> dict[str, Array]:
    """Derivatives (k,) by the unknowns of each parameter and derived size; zero for what was held."""
    names = _sizes(solution.placed.vault)
    rows = np.zeros((len(names), len(solution.names)))
    for k, vaults, apart in _moved(solution):
        less, more = map(_sizes, vaults)
        rows[:, k] = [(more[name] - less[name]) / apart for name in names]
    return dict(zip(names, rows, strict=True))


def _sizes(vault: Vault) -> dict[str, float]:
    return {**vault.values(), **vault.derived_values()}


def slopes_of_distances(solution: Solution, points: Array) -> Array:
    """Derivatives (n, k) of the distances of any points (n, 3) [m] to the fitted vault by the unknowns."""
    placed, pose = solution.placed, solution.placed.pose
    normal = placed.vault.evaluate(points, frame=pose.frame(), walls=True).normal
    turning = normal[:, 0] * (points[:, 1] - pose.y) - normal[:, 1] * (points[:, 0] - pose.x)
    slopes = np.zeros((len(points), len(solution.names)))
    slopes[:, : len(POSE)] = np.column_stack([-normal, turning])
    slopes[:, [k for k, name in enumerate(POSE) if name in solution.free.pose]] = 0
    for k, vaults, apart in _moved(solution):
        less, more = (Placed(vault, pose).distance(points) for vault in vaults)
        slopes[:, k] = (more - less) / apart
    return slopes


def _moved(solution: Solution) -> Iterator[tuple[int, tuple[Vault, Vault], float]]:
    """Index of each parameter among the unknowns, the vault with a little less and more of it, and how far apart.

    What is tied to it follows. Both ways, as the higher of two equal arches moves with either by half; one way where
    the other is out of its range, or of what given lengths allow, and not where neither is.
    """
    vault, free = solution.placed.vault, solution.free
    values, ranges = vault.values(), {p.name: p.range for p in vault.parameters()}
    for k, name in enumerate(solution.names[len(POSE) :], len(POSE)):
        low, high = max(values[name] - DIFFERENCE, ranges[name].low), min(values[name] + DIFFERENCE, ranges[name].high)
        less, more = (free.settled(vault, {name: value}) for value in (low, high))
        if free.reaches(less) != free.reaches(more):
            low, less = (low, less) if free.reaches(less) else (values[name], vault)
            high, more = (high, more) if free.reaches(more) else (values[name], vault)
        if high > low:
            yield k, (less, more), high - low
