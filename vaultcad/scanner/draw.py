"""Random vaults of realistic sizes and random scans of them: what tests and benchmarks are fed with."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import pi

import numpy as np

from families import (
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
    Profile,
    Rib,
    Rotunda,
    Sail,
    Segmental,
    Semicircular,
    Stilted,
    Trough,
    Umbrella,
    Vault,
    family,
)
from vaultcad.find.identity import is_its_family
from vaultcad.scanner.settings import ScannerSettings

Random = np.random.Generator

# As builders chose them, not over the whole range of the parameters.
PROFILE: dict[str, Callable[[Random], Profile]] = {
    "semicircular": lambda rng: Semicircular(),
    "segmental": lambda rng: Segmental(rng.uniform(0.2, 0.45)),
    "pointed": lambda rng: Pointed(rng.uniform(0.55, 0.9)),
    "basket-handle": lambda rng: BasketHandle(rng.uniform(0.28, 0.42), rng.uniform(0.5, 0.8)),
    "elliptical": lambda rng: Elliptical(rng.uniform(0.25, 0.45)),
    "stilted": lambda rng: Stilted(rng.uniform(0.52, 0.65)),
}


def draw(kind: type[Vault] | str, rng: np.random.Generator) -> tuple[Vault, ScannerSettings]:
    """A vault of a family, given as class or by any of its names, and how it is to be scanned.

    Spans of 2.5 to 8 m; noise up to 5 mm, settlement up to 5 cm, 1 to 3 stations, holes up to 15 %, whole rooms and
    cropped scans, walls and piers, near and projected coordinates.

    Raises:
        ValueError: no such family.
    """
    cls = family(kind) if isinstance(kind, str) else kind
    while not is_its_family(vault := VAULT[cls.id](rng)):
        pass  # a dome without a drum may come out as a sail
    return vault, _settings(vault, rng)


def _profile(rng: Random, *kinds: str) -> Profile:
    return PROFILE[str(rng.choice(kinds or list(PROFILE)))](rng)


def _either(rng: Random, chance: float, value: float, low: float, high: float) -> float:
    """`value` with some probability, else one between low and high."""
    chosen, other = rng.random() < chance, float(rng.uniform(low, high))
    return value if chosen else other


def _sail(rng: Random) -> Vault:
    span = rng.uniform(3, 6.5)
    return Sail(span, span * rng.uniform(0.85, 1.2), rng.uniform(0.35, 1))


def _barrel(rng: Random) -> Vault:
    span = rng.uniform(2.5, 7)
    return Barrel(span, span * rng.uniform(1, 2.2), _profile(rng))


def _lunette(rng: Random) -> Vault:
    count, ratio = int(rng.integers(1, 5)), _either(rng, 0.6, 1.0, 0.8, 0.98)
    plain = Lunette(
        span=rng.uniform(3.2, 7),
        length=count * rng.uniform(max(2, 2.6 / count), 3.2) / ratio,
        profile=_profile(rng, "semicircular", "segmental", "basket-handle", "elliptical"),
        count=count,
        pitch_ratio=ratio,
        shift_ratio=_either(rng, 0.6, 0.0, -0.8, 0.8),
        width_ratio=rng.uniform(0.6, 0.95),
        springing_ratio=0.0,
        lunette_profile=_profile(rng, "semicircular", "segmental", "pointed"),
    )
    # Lunettes reach well up into the barrel, at least to half its rise.
    crown = rng.uniform(0.5, 0.85) * plain.rise
    return replace(plain, springing_ratio=max(0.0, (crown - plain.lunette_rise) / (plain.rise - plain.lunette_rise)))


def _trough(rng: Random) -> Vault:
    span, profile = rng.uniform(3, 6), _profile(rng, "semicircular", "segmental", "basket-handle", "elliptical")
    if rng.random() < 0.2:
        return Trough(span, span * rng.uniform(0.9, 1.1), profile, 1.0, 1.0)
    length = span * rng.uniform(1.3, 2.2)
    south = min(0.95, rng.uniform(0.7, 1.2) * span / length)
    return Trough(span, length, profile, south, _either(rng, 0.7, south, 0.8 * south, south))


def _mirror(rng: Random) -> Vault:
    span_x, span_y = rng.uniform(3, 6), rng.uniform(3.5, 8)
    run = rng.uniform(0.25, 0.65) * min(span_x, span_y) / 2
    return Mirror(
        span_x,
        span_y,
        2 * run / span_x,
        _either(rng, 0.6, 1.0, 0.85, 1.1) * 2 * run / span_y,
        rise_ratio=_either(rng, 0.4, 1.0, 0.6, 1),
        plane_ratio=_either(rng, 0.5, 1.0, 0.6, 0.9),
    )


def _groin(rng: Random) -> Vault:
    span_x = rng.uniform(3, 7)
    span_y = span_x * _either(rng, 0.3, 1.0, 0.85, 1.2)
    profile, other = _profile(rng), _profile(rng)
    # Most crowns are level: the second arch takes the rise of the first, if its kind can.
    level = type(other).over(profile.rise(span_x / 2) / span_y)
    chosen = level if level is not None and rng.random() < 0.8 else profile
    return Groin(
        span_x,
        span_y,
        profile,
        chosen,
        crown_rise_ratio=_either(rng, 0.6, 0.0, 0.03, 0.15),
        offset_x_ratio=_either(rng, 0.7, 0.0, 0.02, 0.06),
        offset_y_ratio=_either(rng, 0.7, 0.0, 0.02, 0.06),
    )


def _dome(rng: Random) -> Vault:
    return Dome(
        rng.uniform(1.4, 3.5),
        _profile(rng, "semicircular", "segmental", "pointed"),
        _either(rng, 0.25, 0.0, 0.2, 0.7),
        _either(rng, 0.6, 0.0, 0.1, 0.5),
    )


VAULT: dict[str, Callable[[Random], Vault]] = {
    Sail.id: _sail,
    Barrel.id: _barrel,
    Lunette.id: _lunette,
    Trough.id: _trough,
    Mirror.id: _mirror,
    Groin.id: _groin,
    Dome.id: _dome,
    Cloister.id: Cloister.drawn,
    Conch.id: Conch.drawn,
    Annular.id: Annular.drawn,
    Rotunda.id: Rotunda.drawn,
    Rib.id: Rib.drawn,
    Umbrella.id: Umbrella.drawn,
}


def _settings(vault: Vault, rng: Random) -> ScannerSettings:
    stands_on_walls = vault.plan.on_wall_x or vault.plan.on_wall_y
    piers, far = rng.random() < 0.3, rng.random() < 0.35
    place = (rng.uniform(2e5, 8e5), rng.uniform(4e6, 6e6), rng.uniform(0, 900))
    return ScannerSettings(
        stations=int(rng.integers(1, 4)),
        noise=rng.uniform(0.0006, 0.005),
        mixed=rng.uniform(0.1, 0.4),
        registration_shift=rng.uniform(0.001, 0.004),
        relief=rng.uniform(0, 0.003),
        settlement=rng.uniform(0.005, 0.05),
        holes=_either(rng, 0.5, 0.0, 0.02, 0.15),
        walls="piers" if piers and not stands_on_walls else "walls",
        wall_height=rng.uniform(2.2, 4.5),
        openings=int(rng.integers(0, 6)),
        tie_rods=int(rng.integers(0, 4)),
        furniture=int(rng.integers(0, 6)),
        lamp=bool(rng.random() < 0.6),
        cornice=bool(rng.random() < 0.3),
        scaffold=bool(rng.random() < 0.25),
        crop=bool(rng.random() < 0.3),
        crop_margin=rng.uniform(0.2, 1.2),
        yaw=rng.uniform(-pi, pi),
        origin=(round(place[0], 2), round(place[1], 2), round(place[2], 2)) if far else (0.0, 0.0, 0.0),
    )
