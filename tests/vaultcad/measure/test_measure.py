"""Labels, deviations, coverage, the as-built surface, and the site they stand on."""

from __future__ import annotations

import numpy as np
import pytest

from families import FAMILIES, Barrel, Groin, Sail, Semicircular, Vault
from segmentation.cloud import Cloud
from vaultcad.cubic_grid import add_to_bands
from vaultcad.errors import NoVaultError
from vaultcad.fit.label import label
from vaultcad.fit.solve import Placed
from vaultcad.measure.as_built import as_built, displacement
from vaultcad.measure.coverage import look
from vaultcad.measure.deviation import level_of_accuracy, summarise
from vaultcad.measure.routes import as_built_distance
from vaultcad.mechanisms import Body
from vaultcad.pose import Pose
from vaultcad.scanner.settle import draw_settlement
from vaultcad.survey.thinned_scan import survey, thin_scan, turned

HERE = Pose(0.0, 0.0, 0.0, 0.0)


def test_points_get_their_component_and_those_off_the_vault_none() -> None:
    vault = Groin(4.0, 5.0)
    sample = vault.sample(5000, np.random.default_rng(0))
    strays = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, -1.0], [0.0, 0.0, 2.45], [9.0, 9.0, 9.0]])
    labels = label(np.concatenate([sample.xyz, strays]), [(Placed(vault, HERE), 0.03)])
    assert (labels.component[:5000] == sample.component).mean() > 0.999
    assert labels.component[5000:].tolist() == [0, 0, 0, 0]
    assert np.isnan(labels.deviation[5000:]).all()
    assert (labels.vault == (labels.component > 0)).all()


def test_a_deviation_is_positive_in_the_stone_and_negative_in_the_room() -> None:
    labels = label(np.array([[0.0, 0.0, 2.51], [0.0, 0.0, 2.48]]), [(Placed(Barrel(5.0, 8.0), HERE), 0.03)])
    assert labels.deviation == pytest.approx([0.01, -0.02], abs=1e-6)


def test_labels_do_not_hang_on_how_the_cloud_is_cut_into_chunks() -> None:
    vault = Sail(4.0, 4.0, 0.7)
    xyz = vault.sample(300_000, np.random.default_rng(1)).xyz
    whole, part = label(xyz, [(Placed(vault, HERE), 0.03)]), label(xyz[:1000], [(Placed(vault, HERE), 0.03)])
    assert (whole.component[:1000] == part.component).all()
    assert np.array_equal(whole.deviation[:1000], part.deviation, equal_nan=True)


def test_a_summary_counts_what_it_says() -> None:
    d = summarise(np.array([-0.005, 0.02, 0.04, -0.1]))
    assert (d.mean, d.max) == pytest.approx((0.04125, 0.1))
    assert d.rms == pytest.approx(np.sqrt(np.mean(np.square([0.005, 0.02, 0.04, 0.1]))))
    assert (d.median, d.signed_mean) == pytest.approx((0.03, -0.01125))
    assert dict(d.within) == {0.01: 0.25, 0.03: 0.5, 0.06: 0.75}
    with pytest.raises(ValueError, match="no points"):
        summarise(np.empty(0))


@pytest.mark.parametrize(
    ("p95", "name"), [(0.0005, "LOA50"), (0.005, "LOA40"), (0.01, "LOA30"), (0.05, "LOA20"), (1, "LOA10")]
)
def test_the_level_of_accuracy_is_that_of_the_standard(p95: float, name: str) -> None:
    assert level_of_accuracy(p95) == name


@pytest.mark.parametrize("vault", [Barrel(4.0, 6.0, Semicircular()), Groin(4.0, 5.0)], ids=lambda v: v.id)
def test_coverage_is_the_share_that_was_seen(vault: Vault) -> None:
    rng = np.random.default_rng(2)
    xyz = vault.sample(20_000, rng).xyz
    assert look(vault, xyz, 0.1, rng).whole > 0.995
    assert look(vault, xyz[xyz[:, 1] > 0], 0.1, rng).whole == pytest.approx(0.5, abs=0.03)
    assert look(vault, xyz[:0], 0.1, rng).whole == 0.0


def settled(vault: Vault, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 3) of the ideal vault, and where a settlement of 25 mm has brought them."""
    rng = np.random.default_rng(seed)
    xyz = vault.sample(12_000, rng).xyz
    xyz = xyz[(np.abs(xyz[:, :2]) < vault.plan.half - 0.06).all(axis=1)]  # past its ends it is no vault
    return xyz, xyz + draw_settlement(xyz, vault.plan, 3.0, 0.025, rng)(xyz)


@pytest.mark.parametrize("cls", FAMILIES, ids=lambda cls: cls.id)
def test_the_as_built_surface_follows_the_stone_not_the_clutter_and_bridges_a_hole(cls: type[Vault]) -> None:
    vault, rng = cls(), np.random.default_rng(7)
    ideal, stone = settled(vault, 0)
    noisy = stone + rng.normal(0, 0.003, stone.shape)
    seen = vault.evaluate(noisy)
    known = np.abs(seen.distance) < 0.03  # as the points that are labelled
    centre = ideal[np.linalg.norm(ideal[:, :2] - 0.3 * vault.plan.half, axis=1).argmin()]
    far = np.linalg.norm(ideal - centre, axis=1)
    hole = far < np.quantile(far, 0.15)
    clutter = np.where(rng.random(len(stone)) < 0.03, rng.uniform(0.015, 0.03, len(stone)), seen.distance)
    foot = noisy - seen.distance[:, None] * seen.normal
    fit = known & ~hole
    surface = displacement(foot[fit], seen.normal[fit], clutter[fit], Body.of(vault))
    off = np.abs(as_built_distance(vault, surface, stone))
    assert off[fit].mean() < 0.0015
    assert off[hole & known].max() < 0.015
    assert surface.steepness < 0.3


@pytest.mark.parametrize("cls", FAMILIES, ids=lambda cls: cls.id)
def test_a_hole_in_a_corner_is_told_by_how_the_rest_of_the_vault_has_given(cls: type[Vault]) -> None:
    vault, rng = cls(), np.random.default_rng(8)
    ideal, stone = settled(vault, 0)
    normal = vault.evaluate(ideal).normal
    moved = np.einsum("nc,nc->n", stone - ideal, normal)
    far = np.linalg.norm(ideal[:, :2] - vault.plan.half, axis=1)
    hole = far < np.quantile(far, 0.15)
    seen = moved + rng.normal(0, 0.003, len(moved))
    surface = displacement(ideal[~hole], normal[~hole], seen[~hole], Body.of(vault))
    off = np.abs(np.einsum("nc,nc->n", surface(ideal), normal) - moved)
    assert off[hole].max() < 0.015
    assert off[~hole].mean() < 0.0015


def test_distances_to_the_as_built_surface_are_those_that_were_put_there() -> None:
    vault = Groin(5.0, 4.0)
    ideal, stone = settled(vault, 3)
    seen = vault.evaluate(stone)
    foot = stone - seen.distance[:, None] * seen.normal
    surface = displacement(foot, seen.normal, seen.distance, Body.of(vault))
    inner = np.abs(ideal[:, :2]).max(axis=1) < 1.5
    places, normals = ideal[inner], vault.evaluate(ideal[inner]).normal
    inverse = np.linalg.inv(np.eye(3) + surface.jacobian(places)).swapaxes(1, 2)
    true = np.einsum("nij,nj->ni", inverse, normals)  # normals of the displaced surface
    true /= np.linalg.norm(true, axis=1, keepdims=True)
    for off in (-0.02, 0.0, 0.02):
        found = as_built_distance(vault, surface, surface.moved(places) + off * true)
        assert np.quantile(np.abs(found - off), 0.99) < 2e-4  # but where a groin is nearer


def test_the_surface_is_measured_on_points_that_did_not_make_it() -> None:
    vault, rng = Groin(5.0, 4.0), np.random.default_rng(2)
    _, stone = settled(vault, 1)
    stone = stone + rng.normal(0, 0.003, stone.shape)
    found = as_built(vault, stone, stone, 0.03, rng)
    assert found is not None
    black = np.floor(stone[found.which] / 0.25).astype(int).sum(axis=1) % 2 == 0
    assert not black.any()
    assert 0.0020 < summarise(found.distances).mean < 0.0030  # 2.4 mm is the mean of a noise of 3 mm
    assert as_built(vault, stone[:150], stone[:150], 0.03, rng) is None


def room(span_x: float, span_y: float, yaw: float, rng: np.random.Generator) -> Cloud:
    """A barrel on four walls and a floor, with points all over."""
    vault = Barrel(span_x, span_y)
    on = vault.sample(30_000, rng).xyz
    n = 20_000
    sign = rng.choice([-1.0, 1.0], n)
    walls = np.column_stack([sign * span_x / 2, rng.uniform(-span_y / 2, span_y / 2, n), rng.uniform(-3, 0, n)])
    ends = np.column_stack([rng.uniform(-span_x / 2, span_x / 2, n), sign * span_y / 2, rng.uniform(-3, 0, n)])
    floor = np.column_stack([rng.uniform(-0.5, 0.5, (n, 2)) * [span_x, span_y], np.full(n, -3.0)])
    xyz = np.concatenate([on, walls, ends, floor]) + 0.002 * rng.standard_normal((30_000 + 3 * n, 3))
    xyz[:, :2] = turned(xyz[:, :2], -yaw)
    return Cloud(xyz.astype(np.float32))


def test_a_site_knows_turn_plan_floor_and_crown_of_a_room() -> None:
    site = survey(room(4.0, 6.0, 0.4, np.random.default_rng(4)))
    assert site.yaw == pytest.approx(0.4, abs=0.01)
    assert site.spans == pytest.approx([4.0, 6.0], abs=0.02)
    assert site.walled.all()
    assert site.crown == pytest.approx(2.0, abs=0.02)
    level = np.abs(site.normals[:, 2]) > 0.9
    assert site.points[level, 2].min() > -2.8  # the floor is gone


def test_a_bare_vault_ends_where_its_points_end() -> None:
    cloud = Cloud(Sail(5.0, 4.0, 0.7).sample(200_000, np.random.default_rng(5)).xyz.astype(np.float32))
    site = survey(cloud)
    assert not site.walled.any()
    ends = turned(site.ends[:, :2], site.yaw)
    assert np.abs(ends).max(axis=0) == pytest.approx([2.5, 2.0], abs=0.01)


@pytest.mark.parametrize(
    "xyz",
    [np.zeros((3, 3)), np.ones((5000, 3)), np.linspace([0, 0, 0], [5, 0, 0], 5000)],
    ids=["three points", "one place", "a line"],
)
def test_what_has_no_surface_is_refused(xyz: np.ndarray) -> None:
    with pytest.raises(NoVaultError, match="no vault found"):
        survey(Cloud(xyz.astype(np.float32)))


def test_a_scan_needs_places_with_a_surface() -> None:
    along = np.random.default_rng(6).uniform(0, 5, (5000, 1)) * [1.0, 0.5, 0.2]
    with pytest.raises(NoVaultError, match="at least 100"):
        thin_scan(Cloud(along.astype(np.float32)))


def test_products_are_added_to_the_bands_of_a_matrix_where_the_whole_of_it_has_them() -> None:
    rng, bands, whole = np.random.default_rng(3), np.zeros((6, 12)), np.zeros((12, 12))
    for first in (0, 2, 6):
        columns = first + np.sort(rng.permutation(6)[:4])
        products = rng.normal(size=(4, 4))
        products += products.T
        add_to_bands(bands, columns, products)
        whole[np.ix_(columns, columns)] += products
    for below, band in enumerate(bands):
        assert band[: 12 - below] == pytest.approx(np.diag(whole, -below))
