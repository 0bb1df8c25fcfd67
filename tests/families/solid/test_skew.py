"""Bodies over four corners anywhere; tests/families/declaration/test_corners.py has the numbers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from families import FAMILIES, Vault
from families.declaration.corners import Skew
from families.solid import brep
from families.solid.mesh import mesh, mesh_solid

SKEW = Skew(0.06, 0.08, -0.05)
EACH = pytest.mark.parametrize("family", [cls for cls in FAMILIES if cls.four_corners], ids=lambda f: f.id)


def skewed(family: type[Vault]) -> Vault:
    return replace(family(), skew=SKEW)


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
    body = mesh_solid(vault, 0.15, 1e-3)
    a, b, c = (body.vertices[body.triangles[:, k]] for k in range(3))
    meshed = float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)
    assert abs(vault.solid(0.15).volume) / 1e9 == pytest.approx(meshed, rel=3e-3)
    assert abs(meshed) > 0.1


def test_faces_of_a_skewed_solid_have_their_names() -> None:
    from families import Groin

    vault = skewed(Groin)
    names = {name for _, name in brep.face_names(brep.masonry(vault, 0.15), vault)}
    assert names == {*vault.components, brep.EXTRADOS, brep.SIDE}
