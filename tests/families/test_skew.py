"""Skewed plans: four corners anywhere, the vault stretched between them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from families import FAMILIES, Vault
from families.declaration.corners import Skew
from families.solid import brep
from families.solid.mesh import mesh, mesh_solid

SKEW = Skew(0.06, 0.08, -0.05)
EACH = pytest.mark.parametrize("family", FAMILIES, ids=lambda f: f.id)
HALF = np.array([2.0, 3.0])


def skewed(family: type[Vault]) -> Vault:
    return replace(family(), skew=SKEW)


def test_straightening_undoes_bending() -> None:
    xyz = np.random.default_rng(0).uniform(-3, 3, (1000, 3))
    assert SKEW.straightened(SKEW.bent(xyz, HALF), HALF) == pytest.approx(xyz, abs=1e-9)


def test_the_corners_are_where_they_are_said_to_be() -> None:
    south_west, south_east, north_east, north_west = SKEW.corners(HALF)
    assert north_east[0] - north_west[0] == pytest.approx(2 * HALF[0] * (1 + SKEW.taper_x))
    assert south_east[0] - south_west[0] == pytest.approx(2 * HALF[0] * (1 - SKEW.taper_x))
    assert north_east[1] - south_east[1] == pytest.approx(2 * HALF[1] * (1 + SKEW.taper_y))
    assert (north_east + north_west)[0] / 2 - (south_east + south_west)[0] / 2 == pytest.approx(2 * 3.0 * SKEW.shear)


@EACH
def test_no_skew_changes_nothing(family: type[Vault]) -> None:
    plain = family()
    xyz = np.random.default_rng(1).uniform(-3, 3, (2000, 3))
    flat, here = plain.evaluate(xyz, walls=True), replace(plain, skew=Skew()).evaluate(xyz, walls=True)
    assert here.distance == pytest.approx(flat.distance, abs=1e-9)
    assert (here.component == flat.component).all()
    assert set(replace(plain, skew=Skew()).values()) - set(plain.values()) == {"shear", "taper_x", "taper_y"}


@EACH
def test_samples_lie_on_the_skewed_surface_and_a_step_along_the_normal_is_as_long_as_it_says(
    family: type[Vault],
) -> None:
    vault = skewed(family)
    sample = vault.sample(2000, np.random.default_rng(2))
    here = vault.evaluate(sample.xyz)
    assert np.abs(here.distance).max() < 1e-9
    assert np.linalg.norm(here.normal, axis=1) == pytest.approx(1)
    beside = vault.distance(sample.xyz + 1e-4 * here.normal)
    assert np.quantile(np.abs(beside - 1e-4), 0.95) < 1e-6  # at groins the next component is nearer


@EACH
def test_meshes_lie_on_the_skewed_surface_and_close(family: type[Vault]) -> None:
    vault = skewed(family)
    shown = mesh(vault)
    assert np.abs(vault.distance(shown.vertices)).max() < 1e-6
    body = mesh_solid(vault)
    edges = np.sort(np.concatenate([body.triangles[:, k] for k in ([0, 1], [1, 2], [2, 0])]), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()


@EACH
def test_the_solid_encloses_what_its_mesh_does(family: type[Vault]) -> None:
    vault = skewed(family)
    body = mesh_solid(vault, 0.15, 5e-4)
    a, b, c = (body.vertices[body.triangles[:, k]] for k in range(3))
    meshed = float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)
    assert abs(vault.solid(0.15).volume) / 1e9 == pytest.approx(meshed, rel=3e-3)
    assert abs(meshed) > 0.1


def test_faces_of_a_skewed_solid_have_their_names() -> None:
    from families import Groin

    vault = skewed(Groin)
    names = {name for _, name in brep.face_names(brep.masonry(vault, 0.15), vault)}
    assert names == {*vault.components, brep.EXTRADOS, brep.SIDE}
