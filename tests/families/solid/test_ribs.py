"""Ribs are exact bodies of the section that is asked for, and do not cut each other."""

from math import asin, sqrt

import numpy as np
import pytest

from families import FAMILIES, Elliptical, Groin, Pointed, Rib, Ribs, Segmental, Umbrella
from families.declaration.ribs import BOSS, RIB_KINDS, rib_plans
from families.solid.occ.shapes import volume
from families.solid.ribs import rib_bodies

VAULTS = (
    Rib(5, 6),
    Rib(4, 5, Pointed(0.8), Pointed(0.6), ridge_bow=0.9),
    Groin(5, 7, profile_y=Elliptical(2.5 / 7)),
    Umbrella(5),
)


def under(vault, rib, count=3000):
    """Volume [m³] between a rib's soffit and the numeric surface of the webs, from places all over its plan."""
    corners, rng = np.array([side.start for side in rib.plan.sides]), np.random.default_rng(3)
    one, two = corners[1:-1] - corners[0], corners[2:] - corners[0]
    area = np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0])
    which = np.repeat(np.arange(len(area)), np.ceil(count * area / area.sum()).astype(int))
    share = rng.random((len(which), 2))
    share = np.where(share.sum(axis=1, keepdims=True) > 1, 1 - share, share)
    xy = corners[0] + share[:, :1] * one[which] + share[:, 1:] * two[which]
    bottom = np.array([max(rib.height(x, y), 0.0) for x, y in xy.tolist()])
    room, stone = np.zeros(len(xy)), np.full(len(xy), vault.top + 0.1)
    for _ in range(25):
        middle = (room + stone) / 2
        inside = vault.distance(np.column_stack([xy, middle])) < 0
        room, stone = np.where(inside, middle, room), np.where(inside, stone, middle)
    return float((room - bottom).mean() * rib.plan.area)


@pytest.mark.parametrize("vault", VAULTS, ids=lambda vault: vault.id)
def test_ribs_fill_what_is_between_their_soffits_and_the_webs(vault):
    for one in rib_bodies(vault, Ribs(0.3, 0.18)):  # which looks whether they are closed and without fault
        assert volume(one.shape) / 1e9 == pytest.approx(under(vault, one.rib), rel=0.05), one.rib.name


@pytest.mark.parametrize("vault", VAULTS, ids=lambda vault: vault.id)
def test_ribs_cover_their_strips_once(vault):
    ribs = Ribs(0.3, 0.18)
    plans = list(rib_plans(vault.rib_lines(), vault.plan, ribs))
    xy = np.random.default_rng(1).uniform(-1, 1, (20_000, 2)) * vault.plan.half
    times = np.sum([rib.plan.holds(xy) for rib in plans], axis=0)
    near = np.zeros(len(xy), bool)
    for line in vault.rib_lines():
        along, across = ((xy - line.start) @ way for way in (line.direction, line.across))
        near |= (np.abs(across) < ribs.width / 2 - 1e-6) & (along > 0) & (along < line.length)
    near &= vault.plan.holds(xy)
    boss = next(rib.plan.holds(xy) for rib in plans if rib.kind == BOSS)
    assert times.max() == 1
    assert (times[near] == 1).all()
    assert not times[~near & ~boss & (vault.plan.distance(xy) < -ribs.width)].any()


def test_a_straight_ridge_hangs_by_its_section_along_its_length():
    groin, ribs = Groin(4, 4), Ribs(0.4, 0.3, kinds=("ridge",))
    radius, half = 2.0, ribs.width / 2
    segment = radius**2 * asin(half / radius) + half * sqrt(radius**2 - half**2) - 2 * half * radius  # below the crown
    for one in rib_bodies(groin, ribs):
        if one.rib.kind != BOSS:
            length = 2.0 - half
            assert volume(one.shape) / 1e9 == pytest.approx((ribs.width * ribs.depth + segment) * length, rel=1e-5)


def test_only_the_kinds_that_are_asked_for_are_made():
    for kind in RIB_KINDS:
        names = {rib.kind for rib in rib_plans(Rib().rib_lines(), Rib().plan, Ribs(kinds=(kind,)))}
        assert names - {BOSS} == {kind}


def test_what_cannot_be_is_refused_with_its_reason():
    with pytest.raises(ValueError, match="choose of diagonal, wall, ridge"):
        Ribs(kinds=("lierne",))
    with pytest.raises(ValueError, match="no lines that ribs could run along"):
        rib_bodies(Groin(profile_x=Segmental(), profile_y=Segmental()), Ribs())
    with pytest.raises(ValueError, match="overlap as far as"):
        rib_bodies(Rib(1, 1), Ribs(0.9))
    with pytest.raises(ValueError, match="stand out under the webs"):
        rib_bodies(Rib(5, 5, Pointed(1.5), Pointed(1.5)), Ribs(1.0, 0.03, kinds=("ridge",)))


def test_a_rib_of_which_no_body_can_be_made_is_named_with_the_way_out(monkeypatch):
    def refuse(upper, lower):
        raise ValueError("OpenCASCADE finds a fault")

    monkeypatch.setattr("families.solid.ribs.body", refuse)
    with pytest.raises(ValueError, match=r"no exact body of ridge_south can be built.*leave the ridges out"):
        rib_bodies(Rib(5, 5), Ribs(kinds=("ridge",)))


def test_lines_lie_on_the_vaults():
    for vault in (*VAULTS, *(cls() for cls in FAMILIES)):
        for line in vault.rib_lines():
            shares = np.linspace(0.02, 0.98, 9)
            places = [np.array(line.start) * (1 - v) + np.array(line.end) * v for v in shares]
            inwards = np.array([(*(0.9999999 * p), line.height(v)) for p, v in zip(places, shares, strict=True)])
            assert np.abs(vault.distance(inwards)).max() < 1e-5, (vault, line.name)
