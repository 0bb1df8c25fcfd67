"""Vaults and scans as they are drawn, what is written of them, and settings that are refused."""

import json

import numpy as np
import pytest

from families import FAMILIES, Barrel, Sail, Vault
from vaultcad.scanner import ScannerSettings, draw, scan, vault_of
from vaultcad.scanner.truth import case

EACH = pytest.mark.parametrize("family", FAMILIES, ids=lambda f: f.id)


@EACH
def test_case_gives_the_vault_back(family: type[Vault]) -> None:
    for seed in range(5):
        vault, settings = draw(family, np.random.default_rng(seed))
        written = json.loads(json.dumps(case(vault, settings, np.zeros((1, 3)), 0.004, 1000)))
        assert vault_of(written) == vault
        assert written["pose"]["origin"][2] == settings.origin[2] + settings.wall_height
        assert settings == draw(family.id, np.random.default_rng(seed))[1]


@EACH
def test_draws_are_realistic_and_varied(family: type[Vault]) -> None:
    drawn = [draw(family, np.random.default_rng(seed)) for seed in range(60)]
    for vault, settings in drawn:
        assert isinstance(vault, family)
        assert (2.5 if family.four_corners else 1.5) <= vault.plan.width <= 9
        assert settings.noise <= 0.005
        assert settings.settlement <= 0.05
        assert settings.holes <= 0.15
        if vault.plan.on_wall_x or vault.plan.on_wall_y:
            assert settings.walls == "walls"
    for name in ("stations", "crop", "lamp", "cornice", "scaffold", "openings"):
        assert len({getattr(settings, name) for _, settings in drawn}) > 1
    assert {settings.origin == (0, 0, 0) for _, settings in drawn} == {True, False}


@pytest.mark.parametrize(
    ("field", "value", "limit"),
    [
        ("points", 10, "1000"),
        ("noise", float("nan"), "0.05"),
        ("stations", 0, "1"),
        ("stations", 1.5, "12"),
        ("noise", -0.001, "0.05"),
        ("settlement", 1.0, "0.3"),
        ("holes", 0.9, "0.6"),
        ("wall_height", 0.5, "1.2"),
        ("yaw", 4.0, "3.14"),
        ("walls", "glass", "piers"),
        ("origin", (0.0, float("nan"), 0.0), "finite"),
        ("origin", (0.0, 0.0), "three"),
    ],
)
def test_a_bad_setting_is_refused_by_name_value_and_limit(field: str, value: object, limit: str) -> None:
    with pytest.raises(ValueError, match=field) as refused:
        ScannerSettings(**{field: value})  # type: ignore[arg-type]
    shown = f"{value:g}" if isinstance(value, float | int) else repr(value)
    assert shown in str(refused.value)
    assert limit in str(refused.value)


def test_settings_that_do_not_suit_the_vault_are_refused() -> None:
    with pytest.raises(ValueError, match=r"walls = 'piers'.*barrel"):
        scan(Barrel(), ScannerSettings(walls="piers"), rng=np.random.default_rng(0))
    with pytest.raises(ValueError, match="station_height = 3 m"):
        scan(Sail(3, 3, 0.3), ScannerSettings(wall_height=2.5, station_height=3), rng=np.random.default_rng(0))
    with pytest.raises(ValueError, match="no vault family is called 'igloo'"):
        draw("igloo", np.random.default_rng(0))
