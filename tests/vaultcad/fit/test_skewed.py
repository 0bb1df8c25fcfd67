"""A room with four corners anywhere is fitted with its corners, a rectangle that has settled without."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from families import Barrel, Groin, Segmental, Vault
from families.declaration.corners import Skew
from families.solid.mesh import mesh_solid
from segmentation.cloud import Cloud
from vaultcad.pipeline import FitSettings, Result, fit_scan
from vaultcad.scanner import ScannerSettings, scan

SKEW = Skew(0.05, 0.06, -0.04)
ROOM = ScannerSettings(points=60_000, settlement=0.01, furniture=1, openings=1)


def fitted(vault: Vault, *free: str, rectangular: bool = False) -> Result:
    """The scan of a room, bent with its walls and all; floor under the middle at the origin."""
    xyz = scan(vault, ROOM, rng=np.random.default_rng(3)).xyz.astype(np.float64)
    (x, y), (half_x, half_y) = xyz[:, :2].T.copy(), vault.plan.half.tolist()
    xyz[:, 0] = x * (1 + SKEW.taper_x * y / half_y) + SKEW.shear * y
    xyz[:, 1] = y * (1 + SKEW.taper_y * x / half_x)
    return fit_scan(Cloud(xyz.astype(np.float32)), FitSettings((type(vault),), free=free, rectangular=rectangular))


VAULTS = (Groin(4.5, 5.0, Segmental(0.35), Segmental(0.315)), Barrel(4.0, 6.0, Segmental(0.4)))


@pytest.mark.parametrize("vault", VAULTS, ids=lambda v: v.id)
def test_free_corners_are_found(vault: Vault) -> None:
    model = fitted(vault).model
    (found,) = model.vaults
    local = np.column_stack([found.vault.corners, np.zeros(4), np.ones(4)]) @ found.pose.placement().T
    true = replace(vault, skew=SKEW).corners
    off = np.linalg.norm(local[:, None, :2] - true[None], axis=2)
    assert off.min(axis=1).max() < 0.03  # whichever axis came out as x
    assert found.deviation.rms < 0.01
    assert [note.code for note in model.notes] == ["corners"]


@pytest.mark.parametrize("vault", VAULTS, ids=lambda v: v.id)
def test_a_rectangle_that_has_settled_stays_one(vault: Vault) -> None:
    xyz = scan(vault, replace(ROOM, settlement=0.03), rng=np.random.default_rng(3)).xyz
    model = fit_scan(Cloud(xyz), FitSettings((type(vault),))).model
    assert model.vaults[0].vault.skew is None
    assert not model.notes


def test_a_plan_stays_a_rectangle_where_it_must() -> None:
    model = fitted(Barrel(4.0, 6.0, Segmental(0.4)), rectangular=True).model
    assert model.vaults[0].vault.skew is None
    assert not model.notes


def test_a_skewed_vault_is_written_and_read_back(tmp_path: Path) -> None:
    import trimesh
    from build123d import import_step

    from vaultcad.export.bundle import write_all

    result = fitted(Barrel(4.0, 6.0, Segmental(0.4)), "rectangle")
    write_all(replace(result.model, drawn="ideal"), tmp_path / "out", segments=lambda path: path.write_bytes(b""))
    (found,) = result.model.vaults
    solid = import_step(tmp_path / "out" / "model.step")
    body = mesh_solid(found.vault, result.model.thickness)
    a, b, c = (body.vertices[body.triangles[:, k]] for k in range(3))
    assert abs(solid.volume) / 1e9 == pytest.approx(np.einsum("ij,ij->", a, np.cross(b, c)) / 6, rel=3e-3)
    drawn = trimesh.load(tmp_path / "out" / "model.glb", force="scene").extents[[0, 2, 1]]  # glTF is y up
    assert np.array([*solid.bounding_box().size]) / 1000 == pytest.approx(drawn, abs=0.01)
    assert found.parameters["shear"].std is not None
