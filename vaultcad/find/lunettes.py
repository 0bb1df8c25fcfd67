"""Lunettes begun where stone goes back behind a barrel: first guesses tell too little of small or shifted ones."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from families import Barrel, Elliptical, Lunette, Pointed, Segmental, Semicircular, Vault
from families.declaration.parameters import Range
from vaultcad.find.recognise import Start
from vaultcad.fit.freedom import RECTANGLE
from vaultcad.fit.solve import Placed

Array = NDArray[np.float64]

SEVERAL = 2  # pockets: one may be a door's
OPPOSITE = 0.5  # of their width, within which pockets are opposite each other along the axis
ARCHES = (Semicircular, Segmental, Elliptical, Pointed)  # of lunettes that spring with the barrel


def lunettes_at(barrel: Placed, pockets: Sequence[Array]) -> Start | None:
    """The barrel with a row of lunettes where stone goes back behind it; None where that is no row.

    Args:
        barrel: the vault as it is without them.
        pockets: points (n, 3) of each place, in the vault's frame [m].
    """
    vault = barrel.vault
    if not isinstance(vault, Barrel) or vault.slope or vault.splay or len(pockets) < SEVERAL:
        return None
    ways = tuple(Placed(one, barrel.pose) for one in _rows(vault, pockets))
    return Start(ways, (RECTANGLE,) if vault.skew is None else ()) if ways else None


def _rows(vault: Barrel, pockets: Sequence[Array]) -> Iterator[Vault]:
    """The barrel with rows of lunettes of several arches, as wide and as high as the pockets mostly are."""
    along = np.array([[places[:, 1].min(), places[:, 1].max()] for places in pockets])
    width, top = float(np.median(np.ptp(along, axis=1))), float(np.median([places[:, 2].max() for places in pockets]))
    middles = np.sort(along.mean(axis=1))
    rows = np.split(middles, np.flatnonzero(np.diff(middles) > OPPOSITE * width) + 1)
    centres = np.array([row.mean() for row in rows])
    apart = np.diff(centres)
    pitch = float(np.median(apart)) if len(apart) else vault.length
    count = round(float(np.ptp(centres)) / pitch) + 1
    most = _range("count").high
    if count > most or not 0 < top < vault.rise:
        return
    shift = float(centres[0] + centres[-1]) / 2
    pitch = min(float(np.ptp(centres)) / (count - 1) if count > 1 else pitch, (vault.length - 2 * abs(shift)) / count)
    slack = (vault.length - count * pitch) / 2
    shares = {"pitch_ratio": pitch * count / vault.length, "shift_ratio": shift / slack if slack > 0 else 0.0}
    shares = {name: _within(name, share) for name, share in shares.items()}  # a row that ends with the barrel
    for kind in ARCHES:
        profile = kind.over(top / width) or kind()
        rise = min(profile.rise(width / 2), top)
        plain = Lunette(vault.span, vault.length, vault.profile, count, lunette_profile=profile)
        widest = plain.replaced({**shares, "width_ratio": 1.0}).lunette_span
        free = vault.rise - rise
        ratios = {**shares, "width_ratio": width / widest, "springing_ratio": (top - rise) / free}
        yield plain.replaced({name: _within(name, value) for name, value in ratios.items()})


def _range(name: str) -> Range:
    return next(p.range for p in Lunette().parameters() if p.name == name)


def _within(name: str, value: float) -> float:
    """The nearest that a parameter may be."""
    return float(np.clip(value, _range(name).low, _range(name).high))
