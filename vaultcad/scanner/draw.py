"""Random vaults of realistic sizes and random scans of them: what tests and benchmarks are fed with."""

from __future__ import annotations

from math import pi

import numpy as np

from families import Vault, family
from families.declaration.usual_arches import either
from vaultcad.find.identity import is_its_family
from vaultcad.scanner.places import needed
from vaultcad.scanner.settings import ScannerSettings


def draw(kind: type[Vault] | str, rng: np.random.Generator) -> tuple[Vault, ScannerSettings]:
    """A vault of a family, given as class or by any of its names, and how it is to be scanned.

    Spans of 2.5 to 8 m; noise up to 5 mm, settlement up to 5 cm, 1 to 3 stations, holes up to 15 %, whole rooms and
    cropped scans, walls and piers, near and projected coordinates.

    Raises:
        ValueError: no such family.

    >>> vault, settings = draw("botte", np.random.default_rng(1))
    >>> vault.id, 2.5 <= vault.span <= 8, settings.stations
    ('barrel', True, 1)
    """
    cls = family(kind) if isinstance(kind, str) else kind
    while not is_its_family(vault := cls.drawn(rng)):
        pass  # a dome without a drum may come out as a sail
    return vault, _settings(vault, rng)


def _settings(vault: Vault, rng: np.random.Generator) -> ScannerSettings:
    stands_on_walls = vault.plan.on_wall_x or vault.plan.on_wall_y
    four_sided = len(vault.plan.sides) == 4
    piers, far = rng.random() < 0.3, rng.random() < 0.35
    place = (rng.uniform(2e5, 8e5), rng.uniform(4e6, 6e6), rng.uniform(0, 900))
    return ScannerSettings(
        stations=max(int(rng.integers(1, 4)), needed(vault.plan)),
        noise=rng.uniform(0.0006, 0.005),
        mixed=rng.uniform(0.1, 0.4),
        registration_shift=rng.uniform(0.001, 0.004),
        relief=rng.uniform(0, 0.003),
        settlement=rng.uniform(0.005, 0.05),
        holes=either(rng, 0.5, 0.0, 0.02, 0.15),
        walls="piers" if piers and four_sided and not stands_on_walls else "walls",
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
