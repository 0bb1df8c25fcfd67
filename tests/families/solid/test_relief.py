"""The masonry from the numeric surface alone: closed, and about what the B-Rep is."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from families import FAMILIES, Groin, Segmental, Stilted, Vault
from families.declaration.corners import Skew
from families.solid.grid_mesh import relief
from families.solid.mesh import mesh, mesh_solid

VAULTS = (
    *(cls() for cls in FAMILIES),
    Groin(5.0, 4.0, Segmental(0.4), Stilted(0.55), 0.05, 0.03, 0.02),
    Groin(5.0, 4.0, skew=Skew(0.1, 0.05, -0.05)),
)


@pytest.mark.parametrize("vault", VAULTS, ids=lambda v: v.id)
def test_it_is_closed_and_near_to_the_exact_one(vault: Vault) -> None:
    rough, true = relief(vault, 0.15), mesh_solid(vault, 0.15)
    body = trimesh.Trimesh(rough.vertices, rough.triangles, process=False)
    assert body.is_watertight
    assert body.is_winding_consistent
    assert body.volume > 0
    exact = trimesh.Trimesh(true.vertices, true.triangles, process=False)
    assert np.abs(body.bounds[:, 2] - exact.bounds[:, 2]).max() < 0.02
    inner = rough.triangles[(rough.component > 0) & (rough.component <= len(vault.components))]
    on = rough.vertices[np.unique(inner)]
    on = on[on[:, 2] > 0.01]  # outside the springings there is stone at the foot
    assert np.abs(vault.distance(on)).max() < 1e-4
    smooth = mesh(vault)
    for k in range(1, len(vault.components) + 1):
        share = rough.areas[rough.component == k].sum() / smooth.areas[smooth.component == k].sum()
        plumb = vault.components[k - 1] == "drum"  # is jagged by the steps of the grid
        assert share == pytest.approx(1, abs=0.2 if plumb else 0.1), vault.components[k - 1]
