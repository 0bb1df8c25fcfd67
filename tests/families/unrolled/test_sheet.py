"""Every component of every family is laid flat and lifted again, and lengths are as true as is said."""

import numpy as np
import pytest
import shapely

from families import Annular, Barrel, Cloister, Dome, Groin, Lunette, Pointed, Rib, Sail, Segmental, Semicircular, Vault
from families.declaration.corners import Skew
from families.unrolled.developments import Cone, Cylinder, Plane
from families.unrolled.gores import METRIC, MOST_DISTORTED, NARROWEST
from families.unrolled.layout import GAP
from families.unrolled.sheet import unrolled

BENT = (Groin(4.0, 4.0, crown_rise_ratio=0.1, offset_x_ratio=0.1), Groin(skew=Skew(0.06, 0.08, -0.05)))
OPENED = (
    Barrel(4.0, 6.0, Pointed(), slope=-0.3),
    Barrel(4.0, 3.0, Segmental(), splay=0.5),
    Cloister(8, 3.0, Semicircular(), 0.3, crossing=1),
    Annular(5.0, 0.5, 4.2, Pointed()),
    *BENT,
)


def there_and_back(vault: Vault) -> None:
    sheet = unrolled(vault)
    assert {leaf.name for leaf in sheet.leaves} == set(vault.components)
    sample = vault.sample(1500, np.random.default_rng(3))
    place, leaf = sheet.lay(sample.xyz, sample.component)
    assert (leaf >= 0).all()
    back, found = sheet.lift(place)
    assert (found == leaf).all()
    assert np.abs(back - sample.xyz).max() < 1e-6


def test_points_of_every_component_come_back(default_vault):
    there_and_back(default_vault)


@pytest.mark.parametrize("vault", OPENED, ids=lambda vault: vault.id)
def test_points_of_ramps_cones_rings_and_domical_webs_come_back(vault):
    there_and_back(vault)


def net_lengths(leaf):
    """Lengths of the edges of a fine net on a leaf, on the sheet and on the surface, each as 8 steps."""
    a0, b0, a1, b1 = leaf.chart.region.area.bounds
    share = (np.arange(12) + 0.5) / 12
    a, b = (grid.ravel() for grid in np.meshgrid(a0 + (a1 - a0) * share, b0 + (b1 - b0) * share))
    for da, db in ((a1 - a0, 0.0), (0.0, b1 - b0), (a1 - a0, b1 - b0)):
        steps = np.linspace(0, 1 / 24, 9)
        inside = shapely.contains_xy(leaf.chart.region.area, a, b)
        inside &= shapely.contains_xy(leaf.chart.region.area, a + da / 24, b + db / 24)
        if not inside.any():
            continue
        rows = [(a[inside] + da * step, b[inside] + db * step) for step in steps]
        for of in (leaf.flat, leaf.chart.region.patch.place):
            points = np.array([of(*row) for row in rows])
            yield np.linalg.norm(np.diff(points, axis=0), axis=2).sum(axis=0)


def test_lengths_on_the_sheet_are_as_true_as_is_said(default_vault):
    for leaf in unrolled(default_vault).leaves:
        lengths = list(net_lengths(leaf))
        for flat, true in zip(lengths[::2], lengths[1::2], strict=True):
            long = true > 1e-6
            error = np.abs(flat[long] / true[long] - 1)
            if leaf.chart.beyond == 0:
                assert error.max(initial=0) <= max(1.05 * leaf.chart.distortion, METRIC / 10)
            if isinstance(leaf.chart.development, Plane | Cylinder | Cone):
                assert error.max(initial=0) < METRIC


def test_gores_keep_lengths_within_the_limit_but_where_webs_are_bent_without_end(default_vault):
    sheet = unrolled(default_vault)
    if isinstance(default_vault, Rib):
        assert 0 < sheet.beyond < 0.015
    else:
        assert sheet.distortion <= MOST_DISTORTED
        assert sheet.beyond <= 0.001
    for leaf in sheet.leaves:
        if leaf.chart.distortion > MOST_DISTORTED:  # no wider than gores are cut at the least
            assert leaf.chart.surface / np.hypot(*np.ptp(shapely.get_coordinates(leaf.outline), axis=0)) < 2 * NARROWEST


def test_no_two_parts_are_nearer_than_their_gap(default_vault):
    outlines = [leaf.outline for leaf in unrolled(default_vault).leaves]
    for k, outline in enumerate(outlines[:-1]):
        assert shapely.distance(outline, outlines[k + 1 :]).min() > 0.8 * GAP


def test_all_of_the_surface_is_on_the_sheet(default_vault):
    """As much of it as the evenly spread points of a sample say."""
    sheet = unrolled(default_vault)
    area = sum(shapely.area(leaf.outline) for leaf in sheet.leaves)
    sample = default_vault.sample(20_000, np.random.default_rng(1))
    place, _ = sheet.lay(sample.xyz, sample.component)
    one = sheet.leaves[0]
    share = shapely.contains_xy(one.outline, *place.T).mean()
    assert share == pytest.approx(shapely.area(one.outline) / area, abs=0.01)


def test_a_barrel_is_as_wide_as_its_arch_is_long_and_a_climbing_one_as_long_as_its_lines():
    s0, t0, s1, t1 = unrolled(Barrel(4.0, 6.0)).bounds
    assert (s1 - s0, t1 - t0) == pytest.approx((2 * np.pi, 6.0), abs=1e-5)
    crown = [[0.0, -2.0, 0.0], [0.0, 2.0, 0.0]]
    climbing = Barrel(4.0, 6.0, slope=0.3)
    crown = np.array(crown) + [0, 0, climbing.top]
    feet = climbing.evaluate(crown)
    on = crown - feet.distance[:, None] * feet.normal
    place, _ = unrolled(climbing).lay(on, np.array([1, 1]))
    assert np.hypot(*np.diff(place, axis=0)[0]) == pytest.approx(np.linalg.norm(on[1] - on[0]), abs=1e-6)


def test_parts_are_turned_as_they_lie_in_plan():
    vault = Lunette(5.0, 6.0, count=1)
    sheet = unrolled(vault)
    middles = {leaf.name: leaf.outline.centroid for leaf in sheet.leaves}
    assert middles["lunette_west_1"].x < middles["barrel"].x < middles["lunette_east_1"].x
    points = np.array([[0.0, -2.0], [0.0, 2.0], [-1.0, 0.0], [1.0, 0.0]])
    place, _ = sheet.lay(np.column_stack([points, np.full(4, vault.top)]), np.ones(4, int))
    assert place[1, 1] > place[0, 1]
    assert place[3, 0] > place[2, 0]


def test_feet_of_points_beside_the_surface_are_where_they_lie():
    for vault in (Sail(), Dome(), Groin(4.0, 4.0, crown_rise_ratio=0.1)):
        sheet, sample = unrolled(vault), vault.sample(500, np.random.default_rng(2))
        off = sample.xyz - 0.02 * sample.normals
        on, _ = sheet.lay(sample.xyz, sample.component)
        beside, _ = sheet.lay(off, sample.component)
        apart = np.hypot(*(beside - on).T)
        assert np.quantile(apart, 0.98) < 1e-3  # the rest lies at edges of gores


def test_places_off_all_parts_have_no_point():
    xyz, leaf = unrolled(Groin()).lift(np.array([[0.0, 0.0], [50.0, 0.0]]))
    assert np.isnan(xyz).all()
    assert (leaf == -1).all()
