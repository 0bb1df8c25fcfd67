"""Webs between ribs: arches as their profiles have them, distances, samples."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from families import BasketHandle, Elliptical, Pointed, Profile, Segmental, Semicircular, Stilted, Vault
from families.declaration.corners import Skew
from families.declaration.pieces import Piece, Web
from families.declaration.profiles import UNSTILTED
from families.kinds.rib import Rib
from families.kinds.umbrella import Umbrella
from families.solid import brep
from families.solid.arches import arch_parameters, half_arches
from families.solid.occ.shapes import faces, inner_points, volume
from families.void import body_table, webs
from families.void.profile_outline import half_outline
from families.void.sampling import sample
from families.void.sampling_strips import strips
from fuzz.bodies import BOX, stone_of, volume_of
from fuzz.vaults import anywhere

VAULTS: tuple[Vault, ...] = (
    Rib(),
    Rib(5.0, 4.0, Pointed(0.65), Pointed(0.8)),
    *(Rib(5.0, 4.0, profile(), profile(), Semicircular()) for profile in Rib.kinds_for("profile_x")),
    *(Rib(4.0, 4.0, Pointed(0.8), Pointed(0.8), profile()) for profile in Rib.kinds_for("profile_diagonal")),
    Rib(5.0, 4.0, Segmental(0.3), Segmental(0.3), Pointed(0.6), ridge_bow=1.0),
    Rib(5.0, 4.0, skew=Skew(0.05, 0.06, -0.04)),
    Umbrella(),
    Umbrella(6, 2.0, Pointed(), Pointed()),
    Umbrella(12, 2.0, Semicircular(), Elliptical(0.3)),
)


def named(vault: Vault) -> str:
    return "-".join([vault.id, *vault.kinds.values(), *(f"{value:g}" for value in vault.values().values())])


WIDTHS = ("radius", "span_x", "span_y")  # [m]

EACH = pytest.mark.parametrize("vault", VAULTS, ids=named)


@pytest.mark.parametrize("profile", [kind() for kind in UNSTILTED], ids=lambda p: p.id)
@pytest.mark.parametrize("rise", [0.3, 0.9, 1.0, 1.4, 2.5])
def test_arches_are_as_their_profiles_have_them(profile: Profile, rise: float) -> None:
    # Over level diagonals that are nothing the arch at the wall is the profile's own.
    flat = Elliptical(0.1).arch(10.0, 1e-9)
    web = Web((1.0, 5.0), (-1.0, 5.0), flat, 10.0, profile, rise, ("web",))
    table = body_table.pack((Piece((web,)),), ("web",))
    for bow in half_outline(profile.arch(1.0, rise), 0.0, 1.0, 0.0):
        u, z, _, _ = bow.trace(np.linspace(bow.start, bow.end, 40)[1:-1])
        assert webs.web_heights(np.full(38, 5.0), u, table) == pytest.approx(z, abs=1e-7)


@EACH
def test_samples_lie_on_the_surface_and_a_step_along_the_normal_is_as_long_as_it_says(vault: Vault) -> None:
    points = sample(vault, 4000, np.random.default_rng(1))
    assert np.abs(vault.distance(points.xyz)).max() < 1e-9
    assert vault.plan.distance(points.xyz[:, :2]).max() < 1e-9
    assert {vault.components[k - 1] for k in points.component} == set(vault.components)
    assert np.linalg.norm(points.normals, axis=1) == pytest.approx(1.0)
    for step in (1e-4, -1e-4):
        beside = vault.distance(points.xyz - step * points.normals)
        assert np.quantile(np.abs(beside - step), 0.95) < 2e-6


@EACH
def test_the_distance_near_by_never_says_much_more_than_there_is(vault: Vault) -> None:
    from scipy.spatial import cKDTree

    rng = np.random.default_rng(2)
    points = sample(vault, 6000, rng).xyz
    other = (points + rng.normal(0, 0.05, points.shape))[:800]
    other = other[(other[:, 2] > 0) & (vault.plan.distance(other[:, :2]) < -0.05)]
    nearest = cKDTree(points).query(other)[0]
    assert (np.abs(vault.distance(other)) <= 1.2 * nearest + 0.01).mean() > 0.97
    assert vault.distance(np.array([[0.1, 0.05, 0.5]]))[0] < -0.1  # no wall stands under a rib


@EACH
def test_beside_their_wall_webs_are_as_far_as_they_are(vault: Vault) -> None:
    points = sample(vault, 4000, np.random.default_rng(4))
    beside = vault.plan.distance(points.xyz[:, :2]) > -0.05 * vault.plan.width
    xyz, normals = points.xyz[beside], points.normals[beside]
    for off in (0.004, 0.02):  # into the stone, also behind the wall
        assert np.median(np.abs(vault.distance(xyz - off * normals) - off)) < 0.03 * off
    # Nor does it leap where a wall is: a web that is a little wider is nearer by no more than that.
    wider = vault.replaced({name: size * 1.0003 for name, size in vault.values().items() if name in WIDTHS})
    moved = np.abs(wider.distance(xyz - 0.01 * normals) - vault.distance(xyz - 0.01 * normals))
    assert np.quantile(moved, 0.99) < 0.002


@EACH
def test_columns_are_void_below_and_stone_above(vault: Vault) -> None:
    xy = np.random.default_rng(3).uniform(-1, 1, (1000, 2)) * vault.plan.half
    xy = xy[vault.plan.distance(xy) < -1e-3]
    z = np.linspace(0.001, 1.2 * max(vault.derived_values().values()) + 0.2, 150)
    column = np.column_stack([np.repeat(xy, 150, axis=0), np.tile(z, len(xy))])
    inside = (vault.distance(column) < 0).reshape(-1, 150)
    assert (np.diff(inside.astype(int), axis=1) <= 0).all()
    assert not inside[:, -1].any()


def test_ribs_and_wall_arches_are_where_they_are_said_to_be() -> None:
    vault = Rib(5.0, 4.0, Pointed(0.65), Pointed(0.8))
    share = np.linspace(-0.99, 0.99, 21)
    radius = np.hypot(2.5, 2.0)
    rib = np.column_stack([2.5 * share, 2.0 * share, radius * np.sqrt(1 - share**2)])
    assert vault.distance(rib) == pytest.approx(0.0, abs=1e-9)
    assert vault.rise == pytest.approx(radius)
    wall = vault.profile_x.curve(2.5)
    u, z, _, _ = half_outline(wall, 0.0, 2.5, 0.0)[0].trace(np.linspace(0.05, 0.8, 20))
    south = np.column_stack([u, np.full(20, -2.0), z])
    assert vault.distance(south) == pytest.approx(0.0, abs=1e-7)


def test_a_web_over_level_diagonals_of_one_kind_is_a_barrel() -> None:
    # Elliptical diagonals over a square and semicircular wall arches: a groin vault of two half cylinders.
    vault = Rib(4.0, 4.0, Semicircular(), Semicircular(), Elliptical(2 / np.hypot(4, 4)))
    x, y = np.random.default_rng(4).uniform(-1.99, 1.99, (2, 2000))
    z = np.sqrt(4 - np.minimum(np.abs(x), np.abs(y)) ** 2)
    assert vault.distance(np.column_stack([x, y, z])) == pytest.approx(0.0, abs=1e-6)


def test_the_area_of_a_web_is_that_of_a_half_cylinder_s() -> None:
    vault = Rib(4.0, 4.0, Semicircular(), Semicircular(), Elliptical(2 / np.hypot(4, 4)))
    area = sum(strip.area for part in vault.pieces()[0].parts for strip in strips(part, vault.plan))
    assert area == pytest.approx((pi - 2) * 16, rel=1e-3)


def test_umbrella_vaults_are_as_high_as_their_ridges() -> None:
    for vault in (v for v in VAULTS if isinstance(v, Umbrella)):
        (row,) = (body_table.pack((Piece((part,)),), vault.components) for part in vault.pieces()[0].parts[:1])
        along = np.linspace(0, row[0, body_table.DEPTH], 4001)
        assert vault.top == pytest.approx(webs.web_heights(along, 0 * along, row).max(), abs=1e-6)


def test_a_place_at_the_foot_of_a_level_arch_is_told_from_its_crown() -> None:
    poles, weights = half_arches(Elliptical(), np.full(3, 1e-6), steep=False)
    beside = 1.0 + np.array([-1e-10, 0.0, 1e-10])
    assert arch_parameters(poles, weights, np.column_stack([beside, 0 * beside])) == pytest.approx(1.0, abs=1e-4)


def integral(vault: Vault, n: int = 200) -> float:
    """Volume [m³] under the webs, by Gauss over the angles by which their ribs and arches rise."""
    at, weight = np.polynomial.legendre.leggauss(n)
    angle, weight = (at + 1) * pi / 4, weight * pi / 4
    total = 0.0
    for part in vault.pieces()[0].parts:
        row = body_table.pack((Piece((part,)),), vault.components)
        depth, middle, half = row[0, body_table.DEPTH], row[0, body_table.MIDDLE], row[0, body_table.HALF]
        v, u = (column.ravel() for column in np.meshgrid(np.sin(angle), -np.cos(2 * angle), indexing="ij"))
        z = webs.web_heights(v * depth, v * (middle + half * u), row).reshape(n, n)
        share = np.outer(np.cos(angle) * weight * np.sin(angle), 2 * np.sin(2 * angle) * weight)
        total += depth * half * float((z * share).sum())
    return total


@EACH
def test_the_solid_is_as_large_as_the_numeric_surface_says(vault: Vault) -> None:
    shape = brep.void(vault)
    assert volume(shape) / 1e9 == pytest.approx(integral(vault), rel=1e-5)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("family", [Rib, Umbrella])
def test_anywhere_in_their_ranges_the_solid_is_sound_and_on_the_numeric_surface(family: type[Vault], seed: int) -> None:
    vault = anywhere(family, seed)
    room = brep.void(vault)  # in which OpenCASCADE finds no fault
    stone = brep.masonry(vault, 0.15)
    inner = inner_points(list(faces(room)))
    shown = [name in vault.components for _, name in brep.face_names(room, vault)]
    assert np.abs(vault.distance(inner[shown])).max() < 1e-7
    assert volume(room) / 1e9 == pytest.approx(integral(vault), rel=1e-4)
    size, deviation = volume_of(vault, stone_of(vault, 0.15), 0.15, BOX[:50_000])
    assert volume(stone) / 1e9 == pytest.approx(size, abs=5 * deviation)


@pytest.mark.parametrize(
    ("family", "name", "kind"),
    [(Rib, "profile_x", Stilted()), (Rib, "profile_y", BasketHandle()), (Umbrella, "profile", Stilted())],
)
def test_arches_on_which_webs_cannot_stand_are_refused(family: type[Vault], name: str, kind: Profile) -> None:
    with pytest.raises(ValueError, match=f"{name} = '{kind.id}' cannot be in an? {family.title}; there are semicirc"):
        family().with_arches({name: kind})
