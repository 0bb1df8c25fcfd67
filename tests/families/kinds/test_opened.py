"""Vaults over round rooms, polygons and crossings, sloped and splayed barrels: volumes, names, samples."""

from __future__ import annotations

from math import pi, sqrt, tan

import numpy as np
import pytest

from families import (
    PROFILES,
    Annular,
    Barrel,
    Cloister,
    Conch,
    Elliptical,
    Pointed,
    Rotunda,
    Segmental,
    Semicircular,
    Stilted,
    Vault,
    ideal,
)
from families.declaration.corners import Skew
from families.declaration.footprint import Footprint
from families.void.sampling import sample

OPENED: tuple[Vault, ...] = (
    *(Cloister(n, 2.5) for n in range(3, 13)),
    *(Cloister(8, 2.5, profile(), 0.3, crossing=k) for k, profile in enumerate(PROFILES[:3])),
    Cloister(8, 3.0, Pointed(), 0.0, 1.1, 1),
    Cloister(8, 3.0, Segmental(), 0.4, 0.9, 2),
    Cloister(6, 3.0, Semicircular(), 0.4, 1.13),
    Conch(),
    *(Conch(2.0, profile()) for profile in PROFILES),
    Annular(),
    *(Annular(5.0, 0.5, angle, Pointed()) for angle in (0.5, pi / 2, 4.0, 2 * pi)),
    Annular(3.0, 1.7, 2.0, Segmental()),
    Rotunda(),
    Rotunda(2.0, Stilted(), 0.5),
    Barrel(slope=0.3),
    Barrel(splay=0.3, profile=Segmental()),
    Barrel(4.0, 3.0, Pointed(), slope=-0.2, splay=-0.5),
)


def named(vault: Vault) -> str:
    return "-".join([vault.id, *(f"{value:g}" for value in vault.values().values())])


EACH = pytest.mark.parametrize("vault", OPENED, ids=named)


def volume(vault: Vault, n: int = 300) -> float:
    """Of the void above the springing [m³], from the heights at which columns over the plan leave it, by bisection."""
    lowest, highest = vault.plan.outline(64).min(axis=0), vault.plan.outline(64).max(axis=0)
    x, y = (low + (high - low) * (np.arange(n) + 0.5) / n for low, high in zip(lowest, highest, strict=True))
    xy = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    xy = xy[vault.plan.holds(xy)]
    low, high = np.zeros(len(xy)), np.full(len(xy), 30.0)
    for _ in range(40):
        middle = (low + high) / 2
        inside = vault.distance(np.column_stack([xy, middle])) < 0
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    return float(low.sum() * np.prod((highest - lowest) / n))


@pytest.mark.parametrize("sides", range(3, 13))
def test_the_void_of_a_cloister_vault_over_a_regular_polygon(sides: int) -> None:
    exact = 2 / 3 * sides * tan(pi / sides) * 2.0**3
    assert volume(Cloister(sides, 2.0)) == pytest.approx(exact, rel=2e-3)


def test_the_void_of_a_conch() -> None:
    assert volume(Conch(2.0)) == pytest.approx(pi * 2.0**3 / 3, rel=2e-3)


@pytest.mark.parametrize("angle", [0.7, pi / 2, pi, 5.0, 2 * pi])
def test_the_void_of_an_annular_vault_by_pappus(angle: float) -> None:
    vault = Annular(4.0, 0.75, angle)
    assert volume(vault) == pytest.approx(pi * 1.5**2 / 2 * angle * 4.0, rel=3e-3)


def test_the_void_of_a_rotunda() -> None:
    assert volume(Rotunda(2.0, drum_ratio=0.5)) == pytest.approx(pi * 4 * 1.0 + 2 / 3 * pi * 8, rel=2e-3)


def test_the_void_of_a_ramp_is_that_of_a_barrel_on_a_wedge() -> None:
    level, ramp = volume(Barrel(4.0, 6.0)), volume(Barrel(4.0, 6.0, slope=0.25))
    assert ramp - level == pytest.approx(4.0 * 6.0 * (0.25 * 6.0) / 2, rel=2e-3)


def test_the_void_of_an_embrasure_is_a_frustum_of_a_cone() -> None:
    vault = Barrel(2.0, 1.0, splay=0.5)  # half spans of 0.5 m and 1.5 m
    assert volume(vault) == pytest.approx(pi / 2 * 1.0 / 3 * (0.5**2 + 0.5 * 1.5 + 1.5**2), rel=2e-3)


@EACH
def test_samples_lie_on_the_surface_within_the_plan_and_show_all_components(vault: Vault) -> None:
    points = sample(vault, 4000, np.random.default_rng(1))
    here = vault.evaluate(points.xyz, walls=True)
    assert np.abs(vault.distance(points.xyz)).max() < 1e-9
    assert np.abs(here.distance).max() < 1e-6
    assert vault.plan.distance(points.xyz[:, :2]).max() < 1e-6
    assert points.xyz[:, 2].min() >= 0
    assert points.xyz[:, 2].max() <= vault.rise + abs(getattr(vault, "slope", 0)) * 10 + 2
    shown = {vault.components[k - 1] for k in points.component}
    assert shown == set(vault.components)
    beside = vault.distance(points.xyz - 1e-4 * points.normals)
    assert np.quantile(np.abs(beside - 1e-4), 0.95) < 1e-6


@EACH
def test_its_plain_values_make_it_again(vault: Vault) -> None:
    assert type(vault).from_plain(vault.plain()) == vault


@EACH
def test_the_crown_is_as_high_as_it_says(vault: Vault) -> None:
    points = sample(vault, 20_000, np.random.default_rng(2)).xyz
    if not getattr(vault, "slope", 0) and not getattr(vault, "splay", 0):
        assert points[:, 2].max() == pytest.approx(vault.derived_values()["rise"], abs=0.05)


def test_the_webs_of_an_octagon_follow_each_other_from_the_east() -> None:
    vault = Cloister(8, 2.0, drum_ratio=0.5)
    angle = np.arange(8) * pi / 4
    ring = np.column_stack([1.9 * np.cos(angle), 1.9 * np.sin(angle), np.full(8, 1.4)])
    assert [vault.components[k - 1] for k in vault.evaluate(ring).component] == [f"web_{k}" for k in range(1, 9)]
    ring[:, 2] = 0.5
    assert {vault.components[k - 1] for k in vault.evaluate(ring).component} == {"drum"}
    assert vault.plan.half == pytest.approx([2.0, 2.0])


@pytest.mark.parametrize("crossing", [1, 2])
def test_an_octagon_fits_its_square_and_what_carries_it_its_corners(crossing: int) -> None:
    vault = Cloister(5, 2.0, drum_ratio=0.5, crossing=crossing)
    assert vault.webs == 8
    corner = np.array([[1.9, 1.9, 0.02]])
    component = vault.components[vault.evaluate(corner).component[0] - 1]
    assert component == f"{('pendentive', 'squinch')[crossing - 1]}_north_east"
    # The wall under the octagon is the square's, the drum stands above.
    wall = np.array([[2.0, 0.1, 0.2], [2.0, 0.1, vault.ring_height + 0.2]])
    seen = vault.evaluate(wall, walls=True)
    assert seen.component[0] == 0
    assert vault.components[seen.component[1] - 1] == "drum"
    # A squinch's arch, and the sphere's on the octagon's wall, leave no sill: columns are either void or stone above.
    xy = np.random.default_rng(3).uniform(-2, 2, (2000, 2))
    z = np.linspace(0.001, vault.rise + 0.1, 200)
    column = np.column_stack([np.repeat(xy, 200, axis=0), np.tile(z, 2000)])
    inside = (vault.distance(column) < 0).reshape(2000, 200)
    assert (np.diff(inside.astype(int), axis=1) <= 0).all()


def test_squinches_spring_from_the_corner_and_end_in_an_arch_on_the_octagon() -> None:
    vault = Cloister(8, 2.0, crossing=2)
    size = 2.0 * (sqrt(2) - 1)
    assert vault.ring_height == pytest.approx(size)
    arch = np.array([[0.5**0.5 * 2.0, 0.5**0.5 * 2.0, size - 1e-3]]) + [1e-6, 1e-6, 0.0]
    assert vault.distance(arch)[0] == pytest.approx(0.0, abs=2e-3)


def test_ramps_rise_and_embrasures_widen_as_they_say() -> None:
    ramp = Barrel(4.0, 6.0, slope=0.25)
    crowns = np.array([[0.0, -3.0, 2.0], [0.0, 3.0, 3.5]])
    assert ramp.distance(crowns) == pytest.approx(0.0, abs=1e-12)
    splayed = Barrel(2.0, 1.0, splay=0.5)
    assert splayed.distance(np.array([[0.0, -0.5, 0.5], [0.0, 0.5, 1.5]])) == pytest.approx(0.0, abs=1e-12)
    assert splayed.plan.corners.tolist() == [[-0.5, -0.5], [0.5, -0.5], [1.5, 0.5], [-1.5, 0.5]]
    assert Barrel(splay=0.2, skew=Skew(taper_x=-0.2)).plan.corners[:, 0] == pytest.approx([-2.5, 2.5, 2.5, -2.5])


def test_old_barrels_are_as_they_were() -> None:
    told = {"schema": 1, "family": "barrel", "profiles": {"profile": "pointed"}, "parameters": {"span": 4.0}}
    vault = Barrel.from_plain(told)
    assert (vault.slope, vault.splay) == (0.0, 0.0)


@pytest.mark.parametrize("family", [Cloister, Conch, Annular, Rotunda])
def test_corners_are_not_free_where_there_are_not_four(family: type[Vault]) -> None:
    with pytest.raises(ValueError, match="no four corners"):
        family(skew=Skew())


def test_lengths_decide_ratios() -> None:
    assert ideal("cloister", radius=4.0, drum_height=2.0, profile="pointed", rise=8.0).rise == pytest.approx(8.0)
    assert ideal("volta anulare", radius=5.0, span=2.5).span == pytest.approx(2.5)
    assert ideal("catino", radius=2.0, profile="elliptical", rise=1.5).rise == pytest.approx(1.5)


def footprint(vault: Vault) -> Footprint:
    """That a scan of it should show."""
    width = 2 * vault.values()["radius"]
    if isinstance(vault, Annular):
        outer, inner = vault.radius + vault.span / 2, vault.radius - vault.span / 2
        return Footprint(2 * outer, 2 * outer, hole=inner / outer, angle=vault.angle)
    if isinstance(vault, Cloister):
        return Footprint(width, width, sides=vault.webs, diagonal=sqrt(2) if vault.crossing else 1.0)
    return Footprint(width, width)


@pytest.mark.parametrize("family", [Cloister, Conch, Annular, Rotunda])
def test_first_guesses_fill_the_footprint_they_are_given(family: type[Vault]) -> None:
    for seed in range(20):
        vault = family.drawn(np.random.default_rng(seed))
        guesses = list(family.first_guesses(footprint(vault)))
        assert guesses
        for guess in guesses:
            assert guess.plan.half == pytest.approx(vault.plan.half, rel=1e-9)
        assert vault.values() == family.drawn(np.random.default_rng(seed)).values()


def test_flat_domes_of_elliptical_profile_are_turned_as_they_are() -> None:
    vault = Rotunda(3.0, Elliptical(0.25))
    assert vault.distance(np.array([[0.0, 0.0, 1.5], [3.0, 0.0, 0.0]])) == pytest.approx(0.0, abs=1e-12)
