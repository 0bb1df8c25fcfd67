"""Kinds of arches are told apart, their sizes are found, and what settlement hides stays in the odds."""

import numpy as np
import pytest

from bench.sections import arch_points, drawn_profile
from families import Elliptical, Pointed, Semicircular
from families.declaration.usual_arches import DRAWN
from vaultcad.model import said
from vaultcad.one_thread import one_thread
from vaultcad.sections.arch_curves import KINDS, distances, drawn
from vaultcad.sections.classify import classified

NAMES = [kind.name for kind in KINDS]


@pytest.mark.parametrize("name", DRAWN)
def test_points_of_an_arch_lie_on_it_and_normals_point_out(name):
    rng = np.random.default_rng(5)
    curve = DRAWN[name](rng).curve(2.0)
    line = drawn(curve, 101)[1:-1]
    away, normal = distances(curve, line)
    assert np.abs(away).max() < 1e-9
    beyond = distances(curve, line + 1e-4 * normal)[0]
    np.testing.assert_allclose(beyond, 1e-4, atol=2e-6)


@pytest.mark.parametrize("name", NAMES)
@one_thread
def test_the_kind_of_a_settled_arch_is_found_with_its_sizes(name):
    for seed in range(3):
        rng = np.random.default_rng(900 + seed)
        profile, span = drawn_profile(name, rng), float(rng.uniform(3, 8))
        found = classified(arch_points(profile, span, 0.01, rng))
        assert found is not None
        assert name in said(found.odds)
        assert sum(found.odds.values()) == pytest.approx(1)
        assert found.rms < 0.012
        curve = profile.curve(span / 2)
        for size, true in (("span", span), ("rise", curve.rise)):
            told = found.sizes[size]
            assert told.std is not None
            assert abs(told.value - true) < 3 * told.std
        if found.kind == name and curve.arcs:
            # From left to right without a gap, each arc where its centre and radius say.
            ends = np.concatenate([arc.points()[[-1, 0]] for arc in found.arcs])
            np.testing.assert_allclose(ends[1:-1:2], ends[2::2], atol=1e-3)


@one_thread
def test_a_settlement_of_centimetres_hides_whether_a_circle_was_meant():
    rng = np.random.default_rng(1)
    found = classified(arch_points(Elliptical(0.49), 5.0, 0.03, rng))
    assert found is not None
    assert {"semicircular", "elliptical"} & set(said(found.odds))
    assert max(found.odds.values()) < 0.95


@one_thread
def test_the_rule_of_setting_out_is_told_with_its_odds():
    rng = np.random.default_rng(2)
    found = classified(arch_points(Pointed(0.8660254), 5.0, 0.0, rng))
    assert found is not None
    assert next(iter(found.rules)) == "equilateral"
    assert sum(found.rules.values()) == pytest.approx(1)


def test_few_points_tell_no_kind():
    points = arch_points(Semicircular(), 5.0, 0.0, np.random.default_rng(3))
    few = type(points)(points.at[:8], points.normal[:8], points.feet, points.foot_std, points.width)
    assert classified(few) is None
