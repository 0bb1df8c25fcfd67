"""How sure the parameters are, allowing for residuals that are alike over some distance."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vaultcad.solve import Placed, Solution

Array = NDArray[np.float64]
BLOCK = 0.75  # m; the settlement of a vault is alike within about this distance


def covariance(solution: Solution, points: Array) -> Array:
    """Covariance (k, k) of the unknowns of a solution from points (n, 3) [m].

    The sandwich estimator with residuals summed within blocks of space, so that what settled together counts once
    (Liang and Zeger 1986; Conley 1999 for space).
    """
    w, jacobian = solution.weights, solution.jacobian
    hessian = (jacobian.T * w) @ jacobian
    pull = jacobian * (w * solution.residuals)[:, None]
    _, block = np.unique(np.floor(points / BLOCK).astype(np.int64), axis=0, return_inverse=True)
    count = int(block.max()) + 1
    sums = np.zeros((count, pull.shape[1]))
    np.add.at(sums, block.ravel(), pull)
    bread = np.linalg.pinv(hessian, rcond=1e-12, hermitian=True)
    correction = count / max(1, count - pull.shape[1])
    out: Array = correction * bread @ (sums.T @ sums) @ bread
    return out


def derived_std(placed: Placed, names: tuple[str, ...], cov: Array) -> dict[str, float]:
    """Standard deviations of the derived sizes of a vault whose unknowns `names` have the covariance (k, k)."""
    values, ranges = placed.vault.values(), {p.name: p.range for p in placed.vault.parameters()}
    base = placed.vault.derived_values()
    rows = np.zeros((len(base), len(names)))
    for k, name in enumerate(names):
        if name in values:
            step = 1e-6 if values[name] + 1e-6 <= ranges[name].high else -1e-6
            moved = placed.vault.replaced({name: values[name] + step}).derived_values()
            rows[:, k] = [(moved[key] - base[key]) / step for key in base]
    variance = np.einsum("ik,kl,il->i", rows, cov, rows)
    return dict(zip(base, np.sqrt(np.maximum(variance, 0.0)).tolist(), strict=True))
