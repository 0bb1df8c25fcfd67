"""Robust, bounded least squares: pose and parameters of a vault against points, all at once."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from families import Vault
from families.declaration.once import Once
from families.void import body_table, kernel
from vaultcad.fit.freedom import Freedom
from vaultcad.pose import Pose

Array = NDArray[np.float64]
POSE = ("x", "y", "z", "yaw")
DIFFERENCE = 1e-6  # of finite differences; lengths are metres, ratios and angles of the same order
MARGIN = 1e-9
HALVINGS = 20  # of a step, to where a length that is given can just be
LONGEST_STEP = 0.5  # m, rad or 1: no step goes farther, however flat the cost
AS_HERE = 0.1  # m, rad or 1, of each parameter: so near, the bodies change with it as they did


@dataclass(frozen=True)
class Placed:
    """A vault where it stands."""

    vault: Vault
    pose: Pose

    def distance(self, points: Array) -> Array:
        """Signed distances (n,) [m] of points (n, 3) to the vault on its walls."""
        out: Array = kernel.distances(points, *self.packed)
        return out

    @Once
    def packed(self) -> tuple[Array, Array, Array]:
        """Frame, table of bodies and outline, as `families.void.kernel` takes them."""
        return self.pose.frame(), *tables(self.vault)


def tables(vault: Vault) -> tuple[Array, Array]:
    """Table of bodies and outline of a vault, as `families.void.kernel` takes them."""
    return body_table.pack(vault.pieces(), vault.components), body_table.pack_plan(vault.plan)


@dataclass(frozen=True)
class Solution:
    """Where the least squares came to rest.

    names: the unknowns, pose first. points: (n, 3) [m]. weights: (n,) robust weights times the points'. free: what the
    names may move, and what follows them.
    """

    placed: Placed
    names: tuple[str, ...]
    points: Array
    residuals: Array
    weights: Array
    converged: bool
    free: Freedom

    @Once
    def jacobian(self) -> Array:
        """Derivatives (n, k) of the distances by the unknowns."""
        return _jacobian(self.placed, _Bodies.of(self.placed, self.free), self.free, self.points)


def robust_cost(residuals: Array, scale: float) -> Array:
    """Geman and McClure (1987): (n,) from 0 for a fit to 1 for an outlier; one half at |residual| = scale [m]."""
    squared = (residuals / scale) ** 2
    cost: Array = squared / (1 + squared)
    return cost


def solve(
    start: Placed,
    points: Array,
    weights: Array,
    free: Freedom | tuple[str, ...],
    scales: tuple[float, ...],
    *,
    lowest: float = -np.inf,
    most: int = 15,
    gain: float = 1e-7,
) -> Solution:
    """Fit pose and `free` parameters to points (n, 3) with weights (n,), the springing not below `lowest` [m].

    What is tied follows at every step; parts of the pose that are fixed stay.

    Levenberg-Marquardt on iteratively reweighted residuals; the loss narrows through `scales` [m], from one that sees
    far outliers to one that does not (graduated non-convexity, Blake and Zisserman 1987); each ends after `most` steps
    or when a step lowers the cost by less than the share `gain`. Steps are projected on the
    parameters' ranges; an unknown that leans on its bound rests there (Kanzow, Yamashita, Fukushima 2004), and so does
    one beyond which a length that is given could not be.
    """
    if not isinstance(free, Freedom):
        free = Freedom(free)
    names = (*POSE, *free.names)
    low, high = _bounds(start.vault, free, lowest)
    x = np.clip(_vector(start, free), low, high)
    placed, converged = _placed(start, free, x), False
    r, bodies = placed.distance(points), _Bodies.of(placed, free)
    for scale in scales:
        damping, converged, leaning = 1e-3, False, np.zeros(len(x))
        cost = float(weights @ robust_cost(r, scale))
        for _ in range(most):
            w = weights / (1 + (r / scale) ** 2) ** 2
            bodies = bodies.at(placed, free)
            jacobian = _jacobian(placed, bodies, free, points)
            gradient, hessian = jacobian.T @ (w * r), (jacobian.T * w) @ jacobian
            resting = ((x <= low + MARGIN) & (gradient > 0)) | ((x >= high - MARGIN) & (gradient < 0))
            resting |= leaning * gradient < 0
            moved = False
            while damping < 1e6:
                step = _step(hessian, gradient, damping, ~resting)
                trial = np.minimum(np.maximum(x + step, low), high)
                new = _placed(start, free, trial)
                if free.reaches(placed.vault) and not free.reaches(new.vault):
                    trial, leaning = _within_reach(start, free, x, trial)
                    new = _placed(start, free, trial)
                residuals = new.distance(points)
                trial_cost = float(weights @ robust_cost(residuals, scale))
                if trial_cost < cost:
                    damping, moved = max(damping / 5, 1e-9), True
                    break
                damping *= 5
            if not moved:
                converged = True  # no direction lowers the cost
                break
            gained, size = (cost - trial_cost) / max(cost, 1e-300), float(np.abs(trial - x).max())
            x, r, cost, placed = trial, residuals, trial_cost, new
            if size < 1e-7 or gained < gain:
                converged = True
                break
    w = weights / (1 + (r / scales[-1]) ** 2) ** 2
    return Solution(placed, names, points, r, w, converged, free)


def _step(hessian: Array, gradient: Array, damping: float, free: NDArray[np.bool_]) -> Array:
    step = np.zeros_like(gradient)
    h = hessian[free][:, free]
    diagonal = h.diagonal() + 1e-12 * max(float(h.diagonal().max(initial=0.0)), 1e-12)
    h.flat[:: len(h) + 1] += damping * diagonal + 1e-15
    step[free] = -np.linalg.solve(h, gradient[free])
    return np.minimum(np.maximum(step, -LONGEST_STEP), LONGEST_STEP)  # as `np.clip`, in a fifth of its time


def _within_reach(start: Placed, free: Freedom, x: Array, trial: Array) -> tuple[Array, Array]:
    """A step that goes no farther than lengths that are given can be, and which way (k,) what was stopped would go.

    The first unknown that alone makes the difference is stopped; if none does, all are.
    """

    def reached(share: float, which: NDArray[np.bool_]) -> Array:
        out: Array = np.where(which, x + share * (trial - x), trial)
        return out

    def reaches(share: float, which: NDArray[np.bool_]) -> bool:
        return free.reaches(_moved(start, free, reached(share, which)))

    each = [np.arange(len(x)) == k for k in range(len(POSE), len(x))]
    which = next((one for one in each if reaches(0.0, one)), np.ones(len(x), np.bool_))
    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if reaches(middle, which) else (low, middle)
    return reached(low, which), np.where(which, np.sign(trial - x), 0.0) if which.sum() == 1 else np.zeros(len(x))


@dataclass(frozen=True)
class _Bodies:
    """How the bodies of a vault change with what is free.

    values: (k,) of that, where it was asked. table, plan: the bodies and the outline there. moved, outlines:
    (k, bodies, width) and (k, sides, 5), the same with each of these a step (k,) larger. others: the number of what
    makes more or fewer bodies, with these: of a trough that is just not yet a cloister, or a sector that just takes
    another arc.
    """

    values: Array
    table: Array
    plan: Array
    moved: Array
    outlines: Array
    steps: Array
    others: tuple[tuple[int, Array, Array], ...]

    @classmethod
    def of(cls, placed: Placed, free: Freedom) -> _Bodies:
        """By finite differences."""
        x, (_, high) = _vector(placed, free), _bounds(placed.vault, free, -np.inf)
        _, table, plan = placed.packed
        count = len(free.names)
        moved, outlines = np.repeat(table[None], count, axis=0), np.repeat(plan[None], count, axis=0)
        steps = np.where(x + DIFFERENCE <= high, DIFFERENCE, -DIFFERENCE)[len(POSE) :]
        others: list[tuple[int, Array, Array]] = []
        for k, step in enumerate(steps.tolist()):
            there = x.copy()
            there[len(POSE) + k] += step
            bodies, outline = tables(_moved(placed, free, there))
            if len(bodies) == len(table) and len(outline) == len(plan):
                moved[k], outlines[k] = bodies, outline
            else:
                others.append((k, bodies, outline))
        return cls(x[len(POSE) :], table, plan, moved, outlines, steps, tuple(others))

    def at(self, placed: Placed, free: Freedom) -> _Bodies:
        """The same at a vault that may be another: as they changed here if it is near, for packing them takes long."""
        values, (_, table, plan) = _vector(placed, free)[len(POSE) :], placed.packed
        near = bool((np.abs(values - self.values) < AS_HERE).all()) and not self.others
        alike = table.shape == self.table.shape and plan.shape == self.plan.shape
        if not (near and alike and (table[:, body_table.KINDS_OF] == self.table[:, body_table.KINDS_OF]).all()):
            return _Bodies.of(placed, free)
        moved, outlines = _carried(self.moved, self.table, table), _carried(self.outlines, self.plan, plan)
        return replace(self, moved=moved, outlines=outlines, table=table, plan=plan)


def _carried(moved: Array, here: Array, there: Array) -> Array:
    """Tables that were moved from one, moved from another by as much; what stayed stays."""
    other = moved != here
    out = np.repeat(there[None], len(moved), axis=0)
    out[other] += moved[other] - np.broadcast_to(here, moved.shape)[other]
    return out


def _jacobian(placed: Placed, bodies: _Bodies, free: Freedom, points: Array) -> Array:
    """Derivatives (n, k) of the distances to a vault by its pose and what is free.

    By the pose from the normals, by the parameters from finite differences.
    """
    frame, table, plan = placed.packed
    jacobian: Array = kernel.slopes(points, frame, table, plan, bodies.moved, bodies.outlines, bodies.steps)
    for k, other, outline in bodies.others:
        change = kernel.distances(points, frame, other, outline) - placed.distance(points)
        jacobian[:, len(POSE) + k] = change / bodies.steps[k]
    jacobian[:, [k for k, name in enumerate(POSE) if name in free.pose]] = 0
    return jacobian


def _vector(placed: Placed, free: Freedom) -> Array:
    values = placed.vault.values()
    p = placed.pose
    return np.array([p.x, p.y, p.z, p.yaw, *(values[name] for name in free.names)])


def _placed(start: Placed, free: Freedom, x: Array) -> Placed:
    return Placed(_moved(start, free, x), Pose(*x[: len(POSE)].tolist()))


def _moved(start: Placed, free: Freedom, x: Array) -> Vault:
    return free.settled(start.vault, dict(zip(free.names, x[len(POSE) :].tolist(), strict=True)))


def _bounds(vault: Vault, free: Freedom, lowest: float) -> tuple[Array, Array]:
    ranges = {p.name: p.range for p in vault.parameters()}
    low = [-np.inf, -np.inf, lowest, -np.inf] + [ranges[name].low for name in free.names]
    high = [np.inf] * len(POSE) + [ranges[name].high for name in free.names]
    for k, name in enumerate(POSE):
        if name in free.pose:
            low[k] = high[k] = free.pose[name]
    return np.array(low), np.array(high)
