"""Scans of a few thousand points: right, or said to be unsure."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from families import Barrel, Groin, Segmental, Trough, Vault
from segmentation.cloud import Cloud
from vaultcad.fit.freedom import Freedom
from vaultcad.fit.solve import Placed, Solution
from vaultcad.fit.uncertainty import open_ends
from vaultcad.pipeline import FitSettings, Result, fit_scan
from vaultcad.scanner import ScannerSettings, scan
from vaultcad.survey.thinned_scan import support, thin_scan

SETTINGS = ScannerSettings(points=120_000, tie_rods=1, furniture=2, settlement=0.01, noise=0.002, yaw=0.2)
VAULTS: dict[str, Vault] = {
    "barrel": Barrel(4.0, 6.0),
    "groin": Groin(4.6, 5.4, Segmental(1.5 / 4.6), Segmental(1.5 / 5.4)),
    "trough": Trough(3.6, 6.4),
}


@cache
def scanned(name: str) -> np.ndarray:
    return scan(VAULTS[name], SETTINGS, rng=np.random.default_rng(11)).xyz


@cache
def fitted(name: str, points: int) -> Result:
    xyz = scanned(name)
    chosen = np.random.default_rng(points).permutation(len(xyz))[:points]
    return fit_scan(Cloud(xyz[chosen].astype(np.float32)), FitSettings(families=(type(VAULTS[name]),)))


@pytest.mark.parametrize("points", [4000, 8000])
@pytest.mark.parametrize("name", VAULTS)
def test_a_randomly_thinned_room_keeps_its_plan(name: str, points: int) -> None:
    (vault,) = fitted(name, points).model.vaults
    true = VAULTS[name].plan
    found = vault.vault.plan
    assert sorted((found.half_x, found.half_y)) == pytest.approx(sorted((true.half_x, true.half_y)), abs=0.04)
    assert vault.coverage > 0.85


def test_the_spacing_is_that_of_the_points_where_they_are_sparser_than_the_grid() -> None:
    xyz = scanned("barrel")
    dense = thin_scan(Cloud(xyz.astype(np.float32)))
    some = np.random.default_rng(0).permutation(len(xyz))[:4000]
    sparse = thin_scan(Cloud(xyz[some].astype(np.float32)))
    assert dense.spacing == pytest.approx(0.004 * np.linalg.norm(np.ptp(xyz, axis=0)), rel=0.25)
    assert 0.12 < sparse.spacing < 0.3


def test_an_end_without_a_wall_is_unsure_in_a_sparse_scan() -> None:
    fit = fitted("barrel", 4000)
    (vault,) = fit.model.vaults
    assert vault.covariance is not None
    names = vault.covariance.names
    solution = Solution(
        Placed(vault.vault, replace(vault.pose, yaw=0.0)), names, np.zeros((0, 3)), np.zeros(0), np.zeros(0), True,
        Freedom(names[4:]),
    )  # fmt: skip
    assert not open_ends(solution, (0.0, 0.0)).any()
    along = np.sqrt(np.diag(open_ends(solution, (0.0, 0.2))))
    known = dict(zip(names, along.tolist(), strict=True))
    assert known["length"] == pytest.approx(0.4, rel=1e-3)  # both halves
    assert known["y"] == pytest.approx(0.2)
    assert known["x"] == known["span"] == 0


def test_places_of_few_points_tell_less_than_most_and_none_tells_more() -> None:
    counts = np.array([1.0, 2.0, 20.0, 20.0, 400.0])
    assert support(counts) == pytest.approx([0.05, 0.1, 1, 1, 1])
    assert support(np.ones(3)) == pytest.approx(1.0)
