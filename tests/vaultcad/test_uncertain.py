"""Covariances of the unknowns of a fit."""

from __future__ import annotations

import numpy as np
import pytest

from vaultcad.uncertain import Covariance

NAMES = ("z", "span", "rise_ratio")


@pytest.mark.parametrize("std", [0.001, 0.02, 0.3])
def test_what_hangs_on_an_unknown_is_as_unsure_as_that_and_what_does_not_as_before(std: float) -> None:
    """As by Bayes: given the unknown, the others are as sure as they were."""
    rng = np.random.default_rng(0)
    root = rng.standard_normal((3, 3))
    free = Covariance(NAMES, root @ root.T)
    told = free.with_std("z", std)
    assert told.stds()["z"] == pytest.approx(std)
    slopes = [one.matrix[1:, 0] / one.matrix[0, 0] for one in (free, told)]
    assert slopes[1] == pytest.approx(slopes[0])
    given = [
        one.matrix[1:, 1:] - np.outer(one.matrix[1:, 0], one.matrix[1:, 0]) / one.matrix[0, 0] for one in (free, told)
    ]
    assert given[1] == pytest.approx(given[0], abs=1e-9)


def test_an_unknown_that_was_held_is_as_unsure_as_what_told_it() -> None:
    matrix = np.diag([0.0, 0.01, 0.04])
    told = Covariance(NAMES, matrix).with_std("z", 0.02)
    assert told.stds() == pytest.approx({"z": 0.02, "span": 0.1, "rise_ratio": 0.2})
