"""How rooms settle: drawn at random, and as it is declared."""

import numpy as np
import pytest

from families import FAMILIES, Vault
from vaultcad.scanner import ScannerSettings
from vaultcad.scanner.room import vault_triangles
from vaultcad.scanner.settle import DeclaredSettlement, draw_settlement

EACH = pytest.mark.parametrize("family", FAMILIES, ids=lambda f: f.id)


@EACH
def test_settlement_has_its_amplitude_is_continuous_and_leaves_the_floor(family: type[Vault]) -> None:
    vault = family()
    vertices = vault_triangles(vault).vertices
    half = (vault.plan.half_x, vault.plan.half_y)
    settle = draw_settlement(vertices, vault.plan, 1.5, 0.03, np.random.default_rng(5))
    assert np.linalg.norm(settle(vertices), axis=1).max() == pytest.approx(0.03)
    rng = np.random.default_rng(6)
    points = rng.uniform([-half[0], -half[1], -3], [half[0], half[1], vertices[:, 2].max()], (20_000, 3))
    close = points + rng.normal(size=points.shape) * 1e-3
    stretch = np.linalg.norm(settle(points) - settle(close), axis=1) / np.linalg.norm(points - close, axis=1)
    assert stretch.max() < 10 * 0.03 / min(half)
    assert not settle(points[points[:, 2] < -1.5]).any()


@EACH
def test_a_declared_settlement_moves_what_it_names_and_leaves_the_foot(family):
    vault = family()
    x, y = vault.plan.half
    settings = ScannerSettings(settlement=0, crown_fall=0.03, spread_x=0.02, one_sided=0.01)
    settlement = DeclaredSettlement.of(settings, vault.plan, vault.top, depth=1.5)
    crown, west, east, foot = settlement(np.array([[0, 0, vault.top], [-x, 0, 0], [x, 0, 0], [x, 0, -1.5]]))
    assert crown[2] == pytest.approx(-0.03 - 0.005)
    assert east[0] - west[0] == pytest.approx(0.02)
    assert west[2] - east[2] == pytest.approx(0.01)
    assert not foot.any()
    twisted = DeclaredSettlement.of(ScannerSettings(settlement=0, twist=0.02), vault.plan, vault.top, depth=1.5)
    corners = twisted(np.array([[x, y, 0], [-x, y, 0]]))
    assert corners[1, 2] - corners[0, 2] == pytest.approx(0.02)
