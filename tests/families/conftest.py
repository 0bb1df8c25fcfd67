"""Vaults for arguments of tests: `any_vault` (every family, profile and kind of junction), `default_vault`, and
`textbook_vault` (those with a formula for their height that a test can write down)."""

from math import pi

import pytest

from families import (
    FAMILIES,
    PROFILES,
    Annular,
    Barrel,
    BasketHandle,
    Cloister,
    Conch,
    Dome,
    Elliptical,
    Groin,
    Lunette,
    Mirror,
    Pointed,
    Rib,
    Rotunda,
    Sail,
    Segmental,
    Semicircular,
    Stilted,
    Trough,
    Umbrella,
    Vault,
)
from families.declaration.corners import Skew

OF_EVERY_PROFILE: tuple[Vault, ...] = tuple(
    vault
    for profile in PROFILES
    for vault in (
        Barrel(4.0, 7.0, profile()),
        Lunette(5.0, 6.0, profile(), count=2, width_ratio=0.7, lunette_profile=profile()),
        Trough(4.0, 6.0, profile()),
        Groin(4.0, 5.0, profile(), profile()),
        Dome(2.5, profile()),
        Cloister(8, 2.5, profile()),
        Conch(2.5, profile()),
        Annular(4.0, 0.6, 2.0, profile()),
        Rotunda(2.5, profile(), 0.3),
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
    Cloister(3, 2.0),
    Cloister(12, 3.0, Pointed(), 0.4),
    Cloister(6, 2.5, Semicircular(), 0.0, 1.1),
    Conch(2.0, Pointed()),
    Annular(5.0, 0.5, 2 * pi),
    Annular(5.0, 0.5, 4.2, Pointed()),
    Annular(3.0, 1.7, 0.8, Segmental()),
    Rotunda(2.0, Stilted(), 0.5),
)

RIBBED: tuple[Vault, ...] = (
    Rib(4.0, 3.0, Segmental(0.2), Pointed(1.2), BasketHandle(), ridge_bow=1.0),
    Rib(4.0, 5.0, Elliptical(), Semicircular(), Pointed()),
    Umbrella(3, 2.0, BasketHandle(), Elliptical()),
)

OPENED: tuple[Vault, ...] = (
    Cloister(8, 3.0, crossing=1),
    Cloister(8, 3.0, Pointed(), 0.3, crossing=1),
    Cloister(8, 3.0, crossing=2),
    Cloister(8, 3.0, Segmental(), 0.4, 0.9, 2),
    Barrel(4.0, 6.0, Pointed(), slope=-0.3),
    Barrel(4.0, 3.0, Segmental(), splay=0.5),
    Barrel(4.0, 3.0, slope=0.2, splay=-0.3),
    *(family(skew=Skew(0.06, 0.08, -0.05)) for family in FAMILIES if family.four_corners),
)


# Webs are bent without end in the corners where they spring; test_webs.py has what can be said of them there.
EVEN = tuple(family() for family in FAMILIES if family not in (Rib, Umbrella))

GROUPS: dict[str, tuple[Vault, ...]] = {
    "even_vault": EVEN,
    "any_even_vault": (*EVEN, *OF_EVERY_PROFILE, *SPECIAL, *(vault for vault in OPENED if not isinstance(vault, Rib))),
    "default_vault": tuple(family() for family in FAMILIES),
    "any_vault": (*(family() for family in FAMILIES), *OF_EVERY_PROFILE, *SPECIAL, *OPENED, *RIBBED),
    "textbook_vault": (*EVEN, *OF_EVERY_PROFILE, *SPECIAL),
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
