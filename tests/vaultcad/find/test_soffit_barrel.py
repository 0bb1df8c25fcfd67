"""Where arches spring, and what that tells of their spans and rises."""

from __future__ import annotations

import numpy as np
import pytest

from families import Profile, Segmental, Semicircular
from segmentation.cloud import Cloud
from tests.vaultcad.survey.test_springings import NOISE, SPRINGS, WIDTH, arch
from vaultcad.find.arches import FoundArch
from vaultcad.find.found import Found
from vaultcad.find.soffit_barrel import fitted_soffit
from vaultcad.fit.label import label
from vaultcad.fit.uncertainty import covariance, slopes_of_sizes
from vaultcad.measure.estimates import deviation
from vaultcad.survey.soffits import Soffit
from vaultcad.survey.springings import Springing
from vaultcad.survey.thinned_scan import thin_scan

SPAN, SURE = 3.3, 0.008  # m


def foot(side: int, level: float = 0.0) -> Springing:
    """As it is seen at one end, so much too high [m]."""
    return Springing(np.array([side * SPAN / 2, 0.0, SPRINGS + level]), SURE)


def soffit_of(points: np.ndarray) -> Soffit:
    """The soffit of an arch, of which that is seen from a little above its feet on."""
    x, z = points[points[:, 2] > SPRINGS + 0.15][:, [0, 2]].T
    bins = np.floor(x / 0.1)
    curve = np.array([[x[bins == k].mean(), np.median(z[bins == k])] for k in np.unique(bins)])
    return Soffit(np.zeros(2), 0.0, float(np.ptp(x)), WIDTH, curve)


def found(points: np.ndarray, feet: list[Springing]) -> Found:
    """The arch over points."""
    thin = thin_scan(Cloud(points.astype(np.float32)))
    return fitted_soffit(soffit_of(points), thin, np.random.default_rng(0), None, feet)


def said(one: Found, name: str) -> tuple[float, float]:
    """Value and deviation of a size [m]."""
    vault = one.placed.vault
    value = {**vault.values(), **vault.derived_values()}[name]
    solution = one.refined.loose
    own = one.unsure(covariance(solution, one.refined.points)).std(slopes_of_sizes(solution)[name])
    return value, deviation(name, value, own, one.choices)


@pytest.mark.parametrize("ratio", [0.3, 0.36, 0.43])
@pytest.mark.parametrize("under", ["jamb", "pier", "capital"])
def test_a_segment_springs_from_its_feet_whatever_is_under_them(ratio: float, under: str) -> None:
    """Where a pier goes back under its capital arches were up to 58 cm too high and called ellipses."""
    points = arch(Segmental(ratio), SPAN, under, np.random.default_rng(1))
    one = found(points, [foot(-1, 0.005), foot(1, -0.005)])
    for name, true in (("span", SPAN), ("rise", ratio * SPAN)):
        value, std = said(one, name)
        assert value == pytest.approx(true, abs=0.015)
        assert abs(value - true) < 2 * std < 0.07


@pytest.mark.parametrize("profile", [Semicircular(), Segmental(0.47)], ids=["round", "nearly"])
@pytest.mark.parametrize("level", [0.0, 0.08])
def test_feet_of_what_is_all_but_round_leave_open_what_it_is(profile: Profile, level: float) -> None:
    """No crease is there, and the foot is seen too high: neither is to be believed alone."""
    points = arch(profile, SPAN, "jamb", np.random.default_rng(2))
    true = profile.rise(SPAN / 2)
    value, std = said(found(points, [foot(-1, level), foot(1, level)]), "rise")
    assert abs(value - true) < 2 * std


def test_feet_that_disagree_tell_nothing() -> None:
    points = arch(Segmental(0.36), SPAN, "jamb", np.random.default_rng(3))
    apart = found(points, [foot(-1), foot(1, 0.3)])
    assert "z" not in apart.refined.solution.free.pose


def of_no_kind() -> np.ndarray:
    """Points (n, 3) [m] of the soffit of an arch of three straight stretches."""
    rng = np.random.default_rng(4)
    corners = np.array([[-1.65, 0.0], [-0.8, 0.9], [0.8, 0.9], [1.65, 0.0]])
    at = rng.uniform(0, 3, 8000)
    curve = np.column_stack([np.interp(at, range(4), column) for column in corners.T])
    points = np.column_stack([curve[:, 0], rng.uniform(-WIDTH / 2, WIDTH / 2, len(curve)), curve[:, 1] + SPRINGS])
    return np.asarray(points + NOISE * rng.standard_normal(points.shape))


def test_an_arch_of_no_kind_says_so_and_how_unsure_its_sizes_are() -> None:
    one = found(of_no_kind(), [])
    assert "off it" in one.doubt
    assert said(one, "rise")[1] > 0.05


def test_points_of_an_arch_of_no_kind_are_told_by_its_stone_and_not_by_the_nearest_kind() -> None:
    """At its corners that is 10 cm off, and as far inside them between."""
    points = of_no_kind()
    high = points[:, 2] > SPRINGS + 0.15
    one = FoundArch(soffit_of(points), found(points, []), np.full(2, 0.2), np.full(2, 0.01))
    labels = label(points, [], [one.band(one.depth)])
    assert (labels.arch[high] > 0).mean() > 0.98
    off = np.abs(one.barrel.placed.distance(points))[high]
    assert np.nanmax(np.abs(np.abs(labels.deviation[high]) - off)[np.abs(points[high, 1]) < WIDTH / 2 - 0.03]) < 0.02
    beside = points[high] - [0, 0, 0.06]
    assert (label(beside, [], [one.band(one.depth)]).arch > 0).mean() < 0.05
