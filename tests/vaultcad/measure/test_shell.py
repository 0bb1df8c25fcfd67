"""The thickness of masonry is measured where a scan shows its back, and assumed, and called so, everywhere else."""

from __future__ import annotations

import numpy as np
import pytest

from families import FAMILIES, Barrel, Vault
from segmentation.cloud import Cloud
from vaultcad.drawings.bundle import sheets
from vaultcad.measure.shell import shell_of
from vaultcad.model_file import fitted_vault, plain_vault
from vaultcad.pipeline import FitSettings, fit_scan
from vaultcad.scanner import draw, scan
from vaultcad.scanner.settings import ScannerSettings

THICK = 0.22  # m
NOISE = 0.003  # m


def back(vault: Vault, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Points of the back of a vault in its frame, where nothing else is nearer, and their normals."""
    intrados = vault.sample(4000, rng).xyz
    way = vault.evaluate(intrados).normal
    there = intrados + (THICK + rng.normal(0, NOISE, len(intrados)))[:, None] * way
    own = np.abs(vault.evaluate(there).distance - THICK) < 0.02
    return there[own], way[own]


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.id)
def test_a_back_tells_the_thickness_and_a_floor_does_not(family: type[Vault]) -> None:
    rng = np.random.default_rng(2)
    vault, _ = draw(family, rng)
    points, normals = back(vault, rng)
    told = shell_of(vault, points, normals)
    assert told is not None
    assert told.value == pytest.approx(THICK, abs=0.006)
    assert told.std is not None
    assert NOISE / 4 < told.std < 0.01
    turned = rng.choice([-1.0, 1.0], len(normals))[:, None] * normals  # whose side nobody knows
    assert shell_of(vault, points, turned) == told
    raised = shell_of(vault, points, normals, lambda at: 0.01 * vault.evaluate(at).normal)  # the intrados has moved up
    assert raised is not None
    assert raised.value == pytest.approx(told.value - 0.01, abs=0.001)
    floor = np.column_stack([rng.uniform(*vault.plan.box, (8000, 2)), np.full(8000, vault.top + 0.15)])
    assert shell_of(vault, floor, np.tile([0.0, 0.0, 1.0], (8000, 1))) is None
    assert shell_of(vault, points[:0], normals[:0]) is None


def test_a_measured_shell_is_drawn_and_said() -> None:
    rng, settings = np.random.default_rng(1), ScannerSettings(points=30_000, settlement=0.0, noise=NOISE)
    vault = Barrel(span=4.2, length=5.0)
    room, (behind, _) = scan(vault, settings, rng=rng), back(vault, rng)
    attic = behind + [0.0, 0.0, settings.wall_height]

    def fitted(points: np.ndarray) -> tuple[str, float]:
        model = fit_scan(Cloud(points.astype(np.float32)), FitSettings(families=(Barrel,))).model
        again = fitted_vault(plain_vault(model.vaults[0]))
        assert again.shell == model.vaults[0].shell
        (sheet,) = sheets(model)
        return dict(sheet.fields)["thickness"], model.thickness_of(model.vaults[0])

    said, thick = fitted(np.concatenate([room.xyz, attic]))
    assert "measured" in said
    assert thick == pytest.approx(THICK, abs=0.006)
    said, thick = fitted(room.xyz)
    assert "assumed" in said
    assert thick == 0.15
