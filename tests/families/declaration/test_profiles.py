from itertools import pairwise
from math import acos, cos, hypot, pi, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from families import PROFILES, BasketHandle, Elliptical, Pointed, Segmental, Semicircular, Stilted, profile
from families.declaration.profiles import circle_through, junction
from families.void.profile_outline import half_outline

settings.register_profile("profiles", deadline=None)
settings.load_profile("profiles")
SPANS = st.floats(0.25, 20)


def drawn(curve, n=400):
    """Points (u, z) of the half curve from the springing to the crown."""
    bows = half_outline(curve, 0.0, curve.half_span, 0.0)
    return np.array([bow.at(t) for bow in bows for t in np.linspace(bow.start, bow.end, n)])


@st.composite
def profiles(draw):
    cls = draw(st.sampled_from(PROFILES))
    return cls(**{p.name: draw(st.floats(p.range.low, p.range.high)) for p in cls().parameters()})


@given(profiles(), SPANS)
def test_a_profile_springs_at_the_half_span_and_ends_at_its_rise(arch, S):
    curve = arch.curve(S)
    points = drawn(curve)
    assert curve.rise == pytest.approx(arch.rise(S))
    assert points[0] == pytest.approx((S, curve.stilt), abs=1e-6 * S)
    assert points[-1] == pytest.approx((0, curve.rise), abs=1e-9 * S)
    assert (np.diff(points[:, 0]) < 1e-9).all()
    assert (np.diff(points[:, 1]) > -1e-9).all()


@given(profiles(), SPANS)
def test_arcs_pass_into_each_other_without_a_kink(arch, S):
    bows = half_outline(arch.curve(S), 0.0, S, 0.0)
    for below, above in pairwise(bows):
        assert below.at(below.end) == pytest.approx(above.at(above.start), abs=1e-9 * S)
        assert below.end == pytest.approx(above.start, abs=1e-7)


@given(profiles(), SPANS)
def test_a_profile_grows_in_proportion_to_its_span(arch, S):
    assert drawn(arch.curve(S), 20) == pytest.approx(S * drawn(arch.curve(1.0), 20), abs=1e-6 * S)


@given(profiles(), SPANS, st.floats(0.05, 0.5))
def test_the_extrados_stands_off_by_the_thickness(arch, S, t):
    curve, grown = arch.curve(S), arch.curve(S).grown(t)
    assert grown.half_span == pytest.approx(S + t)
    for a, b in zip(curve.arcs, grown.arcs, strict=True):
        assert (b.u, b.z, b.radius) == (a.u, a.z, a.radius + t)
    assert grown.rise >= curve.rise + t - 1e-9
    assert curve.thickness_below(grown.rise) == pytest.approx(t)


def test_a_semicircle_has_half_span_radius_and_rise_in_one():
    curve = Semicircular().curve(2.0)
    assert (curve.rise, curve.crown_radius, curve.stilt) == (2.0, 2.0, 0.0)


@given(st.floats(0.05, 0.5), SPANS)
def test_a_segmental_arch_keeps_the_equation_of_the_paper(ratio, S):
    H = 2 * S * ratio
    curve = Segmental(ratio).curve(S)
    assert curve.crown_radius == pytest.approx((S**2 + H**2) / (2 * H))
    assert circle_through(S, H) == pytest.approx(curve.crown_radius)
    assert curve.arcs[0].z == pytest.approx(H - curve.crown_radius)
    assert curve.arcs[0].z <= 1e-12


@given(st.floats(0.5, 1.5), SPANS)
def test_a_pointed_arch_has_its_centres_on_the_springing(ratio, S):
    H = 2 * S * ratio
    (arc,) = Pointed(ratio).curve(S).arcs
    assert arc.z == 0
    assert arc.radius == pytest.approx((S**2 + H**2) / (2 * S))
    assert arc.u + arc.radius == pytest.approx(S)


def test_the_equilateral_pointed_arch_has_the_span_as_radius():
    (arc,) = Pointed(sqrt(3) / 2).curve(1.5).arcs
    assert arc.radius == pytest.approx(3.0)


@given(st.floats(0.15, 0.49), st.floats(0.2, 0.95), SPANS)
def test_a_basket_handle_has_three_tangent_arcs(ratio, haunch, S):
    H = 2 * S * ratio
    r = haunch * H
    small, large = BasketHandle(ratio, haunch).curve(S).arcs
    assert small.radius == pytest.approx(r)
    assert large.radius == pytest.approx((S**2 + H**2 - 2 * S * r) / (2 * (H - r)))
    assert hypot(small.u - large.u, small.z - large.z) == pytest.approx(large.radius - small.radius)
    u, z = junction(BasketHandle(ratio, haunch).curve(S))
    assert hypot(u - small.u, z - small.z) == pytest.approx(r)
    assert 0 < u < S


def test_the_three_arcs_of_huygens_have_sixty_degrees():
    # r + R = 2 S makes the angle sin⁻¹((S - r) / (R - r)) = 30° on either side of the axis.
    r = 0.5
    R = 2 - r
    H = R - (R - r) * cos(pi / 6)
    small, large = BasketHandle(H / 2, r / H).curve(1.0).arcs
    assert large.radius == pytest.approx(R)
    assert acos(-large.z / hypot(small.u, large.z)) == pytest.approx(pi / 6)


@given(st.floats(0.1, 1.0), SPANS)
def test_an_elliptical_arch_lies_on_its_ellipse(ratio, S):
    curve = Elliptical(ratio).curve(S)
    u, z = drawn(curve).T
    assert (u / S) ** 2 + (z / curve.rise) ** 2 == pytest.approx(1.0)


@given(st.floats(0.5, 1.2), SPANS)
def test_a_stilted_arch_is_a_semicircle_on_a_vertical(ratio, S):
    curve = Stilted(ratio).curve(S)
    assert curve.arcs[0].radius == S
    assert curve.stilt == pytest.approx(2 * S * ratio - S)


@pytest.mark.parametrize("cls", PROFILES)
@given(run=st.floats(0.3, 10), rise=st.floats(0.3, 10))
def test_an_arch_over_a_run_of_its_own_has_the_rise_asked_for(cls, run, rise):
    points = drawn(cls().arch(run, rise), 50)
    assert points[-1] == pytest.approx((0.0, rise), abs=1e-9)
    assert points[0][0] == pytest.approx(run)


@pytest.mark.parametrize("cls", PROFILES)
def test_a_profile_answers_to_its_names(cls):
    for name in (cls.id, *cls.aliases):
        assert profile(name) is cls
    with pytest.raises(ValueError, match=r"ogee.*semicircular"):
        profile("ogee")


def test_over_makes_the_profile_of_a_ratio_or_none():
    assert Segmental.over(0.3) == Segmental(0.3)
    assert Segmental.over(0.9) is None
    assert Semicircular.over(0.5) == Semicircular()
    assert Semicircular.over(0.4) is None
