"""Vaults for the arguments `any_vault` (every family, profile and kind of junction) and `default_vault` of tests."""

import pytest

from families import (
    FAMILIES,
    PROFILES,
    Barrel,
    BasketHandle,
    Dome,
    Elliptical,
    Groin,
    Lunette,
    Mirror,
    Pointed,
    Sail,
    Segmental,
    Semicircular,
    Stilted,
    Trough,
    Vault,
)

OF_EVERY_PROFILE: tuple[Vault, ...] = tuple(
    vault
    for profile in PROFILES
    for vault in (
        Barrel(4.0, 7.0, profile()),
        Lunette(5.0, 6.0, profile(), count=2, width_ratio=0.7, lunette_profile=profile()),
        Trough(4.0, 6.0, profile()),
        Groin(4.0, 5.0, profile(), profile()),
        Dome(2.5, profile()),
    )
)

SPECIAL: tuple[Vault, ...] = (
    Sail(5.0, 3.0, 0.6),
    Sail(4.0, 4.0, 1.0),
    Lunette(5.0, 9.0, Segmental(0.3), 2, pitch_ratio=0.7, shift_ratio=0.5, springing_ratio=1.0),
    Lunette(4.0, 6.0, Semicircular(), 2, width_ratio=1.0, springing_ratio=0.0, lunette_profile=Pointed()),
    Trough(4.0, 4.0, south_ratio=1.0, north_ratio=1.0),
    Trough(4.0, 6.0, Pointed(), south_ratio=1.0, north_ratio=1.0),
    Trough(4.0, 6.0, south_ratio=1.0, north_ratio=0.4),
    Mirror(),
    Mirror(plane_ratio=0.6),
    Mirror(4.0, 4.0, run_x_ratio=1.0, run_y_ratio=1.0, plane_ratio=0.7),
    Groin(4.0, 6.0, Semicircular(), Elliptical(1 / 3)),
    Groin(5.0, 5.0, Pointed(0.7), Segmental(0.3)),
    Groin(4.0, 4.0, crown_rise_ratio=0.1, offset_x_ratio=0.1),
    Groin(4.0, 4.0, Stilted(), BasketHandle(), offset_x_ratio=0.2, offset_y_ratio=0.05),
    Dome(3.0, drum_ratio=0.0, pendentive_ratio=0.8),
)


GROUPS: dict[str, tuple[Vault, ...]] = {
    "default_vault": tuple(family() for family in FAMILIES),
    "any_vault": (*(family() for family in FAMILIES), *OF_EVERY_PROFILE, *SPECIAL),
    "special_vault": SPECIAL,
}


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """A test with an argument of `GROUPS` runs on each of its vaults."""
    for argument in GROUPS.keys() & set(metafunc.fixturenames):
        metafunc.parametrize(argument, GROUPS[argument], ids=name)


def name(vault: Vault) -> str:
    """Family and what differs from its defaults."""
    default, values = type(vault)().values(), vault.values()
    profiles = [getattr(vault, field).id for field in ("profile", "profile_x") if hasattr(vault, field)]
    return "-".join([vault.id, *profiles, *(f"{k}={v:g}" for k, v in values.items() if default.get(k) != v)])
