"""Vaults that between them show every family, profile and kind of junction."""

from families import (
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


def name(vault: Vault) -> str:
    """Family and what differs from its defaults, for the names of tests."""
    default, values = type(vault)().values(), vault.values()
    changed = [f"{key}={value:g}" for key, value in values.items() if default.get(key) != value]
    return "-".join([vault.id, *(getattr(vault, f).id for f in ("profile", "profile_x") if hasattr(vault, f)), *changed])
