import numpy as np
import pytest

from families import FAMILIES, Annular
from vaultcad.change.motion import Places, Trend, Waves, estimated, likelihoods
from vaultcad.change.places import Sights, azimuth, crown_of, places, readings, wind
from vaultcad.mechanisms import LARGE, MECHANISMS, PARTS, Body, shapes

BODY = Body(np.array([2.5, 2.0]), 2.5, 3.0)


def test_every_mechanism_is_made_of_parts_that_there_are():
    assert {part for one in MECHANISMS for part in one.parts} == {*PARTS}


def test_no_shape_moves_the_foot_of_a_wall_but_by_tilt_and_twist():
    foot = np.array([[2.5, 0.3, -3.0], [-1.0, 2.0, -3.0]])
    fields, parts, _ = shapes(foot, BODY)
    assert np.abs(fields[:, ~np.isin(parts, ["tilt", "twist"])]).max() < 1e-12


def test_walls_fade_in_one_way_at_a_time_and_what_does_not_fade_is_always_there():
    at = np.random.default_rng(1).uniform([-2.5, -2, -3], [2.5, 2, 2.5], (200, 3))
    shown = shapes(at, BODY)
    ways = np.array(shown.alternatives())
    assert len(ways) == 6
    fades = shown.fading >= 0
    assert (ways.sum(axis=0) == np.where(fades, 1, len(ways))).all()
    for mine in ways:
        faded = shown.part[mine & fades].tolist()
        assert faded == ["spread x", "spread x", "spread y", "spread y", "lean x", "lean y"]
    shallow = shapes(at, Body(BODY.half, BODY.rise, 0.5))  # all reach as far down as walls are seen
    assert len(shallow.alternatives()) == 2


@pytest.mark.parametrize("across", [np.sin, np.tanh, lambda x: x], ids=["sine", "bodies", "linear"])
def test_halves_may_part_as_bodies_or_stretch_evenly(across):
    """All of it below the crown; a sine fitted by what stretches evenly alone is off by a fifth of its size."""
    x = np.linspace(-1, 1, 201)
    moved = across(x * np.pi / 2) / across(np.pi / 2)
    at = np.column_stack([x * BODY.half[0], np.zeros((201, 2))])
    fields = shapes(at, BODY, ["spread x"]).fields[:, :, 0]
    left = moved - fields @ np.linalg.lstsq(fields, moved, rcond=1e-9)[0]
    assert np.abs(left).max() < 0.05


def test_shapes_are_of_unit_size():
    at = np.random.default_rng(1).uniform([-2.5, -2, -3], [2.5, 2, 2.5], (3000, 3))
    size = np.linalg.norm(shapes(at, BODY).fields, axis=2).max(axis=0)
    assert (size <= 1 + 1e-9).all()


@pytest.mark.parametrize("family", FAMILIES, ids=lambda f: f.id)
def test_figures_are_read_on_the_vault_and_rigid_motions_are_no_spread(family):
    vault = family()
    wanted = readings(vault, Body(vault.plan.half, vault.top, 2.0), Sights())
    at = places(wanted)
    assert {"crown settlement", "spread along x", "spread along y"} <= {one.name for one in wanted}
    shift = at.sums(at.way @ np.array([[0.01], [0.02], [0.0]]))[:, 0]
    for one, value in zip(wanted, shift, strict=True):
        if one.name.startswith(("spread", "crown", "differential", "twist")):
            assert abs(value) < 1e-12, one.name
    crown = wanted[0].terms[0][0]
    assert abs(vault.distance(crown[None])[0]) < 1e-6


@pytest.mark.parametrize("angle", [2.0, np.pi, 5.0, 2 * np.pi])
def test_the_crown_of_a_vault_round_a_court_is_on_its_crown_line_also_where_the_middle_is_under_it(angle):
    vault = Annular(radius=4.0, span_ratio=0.7, angle=angle)
    assert crown_of(vault)[2] == pytest.approx(vault.top, abs=0.01)


@pytest.mark.parametrize("count", [1, 7])
def test_a_part_moves_by_as_much_however_many_shapes_it_has(count):
    parts = np.array([*["sinking"] * count, "tilt"])
    trend = Trend.of_shapes(np.zeros((3, count + 1)), np.zeros((1, count + 1)), parts)
    variance = 1 / trend.precision
    assert variance[:-1].sum() == pytest.approx(LARGE**2)
    assert variance[-1] == pytest.approx(LARGE**2)


def test_azimuths_count_clockwise_from_y():
    assert azimuth(np.array([0.0, 1.0, 0.0]), 0.0) == pytest.approx(0)
    assert azimuth(np.array([1.0, 0.0, 0.0]), 0.0) == pytest.approx(90)
    assert azimuth(np.array([1.0, 0.0, 0.0]), np.pi / 2) == pytest.approx(0)
    assert azimuth(np.array([0.0, 0.0, 1.0]), 0.0) is None
    assert [wind(b) for b in (0, 90, 181, 350, 315)] == ["N", "E", "S", "N", "NW"]


def test_limits_hold_for_motions_that_are_waves():
    rng = np.random.default_rng(3)
    place = rng.uniform([-2.5, -2.5, 0], [2.5, 2.5, 1], (150, 3))
    normal = np.tile([0.0, 0.0, 1.0], (150, 1))
    spot = np.array([[0.3, 0.2, 0.5]])
    figures = Places(np.zeros(1, np.int64), spot, np.array([[0.0, 0.0, 1.0]]))
    whole, length = np.vstack([place, spot]), 2.5
    cover = np.exp(-0.5 * ((whole[:, None] - whole[None]) ** 2).sum(axis=2) / length**2)
    factor = np.linalg.cholesky(cover + 1e-9 * np.eye(151))
    none = Trend(np.zeros((150, 1)), np.ones(1), np.zeros(1), np.zeros((1, 1)))
    waves = Waves.of(place, normal, figures, 5.0)
    off = []
    for _ in range(60):
        moved = 0.01 * factor @ rng.standard_normal(151)
        found = estimated(moved[:150] + rng.normal(0, 0.001, 150), none, waves)
        off.append((found.mean[0] - moved[150]) / found.std[0])
    assert 0.85 < np.mean(np.abs(off) < 1.96) <= 1
    assert np.std(off) > 0.5


def test_how_likely_a_part_of_the_unknowns_is_does_not_hang_on_the_others():
    rng = np.random.default_rng(5)
    place = rng.uniform([-2.5, -2.5, 0], [2.5, 2.5, 1], (60, 3))
    normal = np.tile([0.0, 0.0, 1.0], (60, 1))
    waves = Waves.of(place, normal, Places(np.zeros(1, np.int64), place[:1], normal[:1]), 5.0)
    trend = Trend(rng.normal(size=(60, 5)), rng.uniform(1, 1e4, 5), np.zeros(5), np.zeros((1, 5)))
    deviation = 0.02 * trend.slopes[:, 1] + rng.normal(0, 0.002, 60)
    masks = [rng.random(5) < 0.5 for _ in range(6)] + [np.zeros(5, np.bool_)]
    whole = likelihoods(deviation, trend, waves, masks)
    alone = [likelihoods(deviation, trend.only(mask), waves, [np.ones(mask.sum(), np.bool_)])[0] for mask in masks]
    assert whole == pytest.approx(alone)
    assert np.ptp(whole) > 1
    nothing_left = likelihoods(np.zeros(60), trend, waves, masks)
    assert np.isfinite(nothing_left).all()
