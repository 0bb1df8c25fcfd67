"""The intrados laid flat, as a view of a sheet: its parts, and lines of how far the stone is from the ideal vault."""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil, floor

import numpy as np
from numpy.typing import NDArray

from families.declaration.pieces import Web
from families.drawing.deviation_colours import CONVENTION
from families.unrolled.gores import MOST_DISTORTED
from families.unrolled.sheet import Leaf, Sheet, unrolled
from vaultcad.displacement import Displacement
from vaultcad.drawings.marks import Mark, Path, View, Word, view_of
from vaultcad.drawings.plan_view import inside, lengths
from vaultcad.model import FittedVault
from vaultcad.unrolled.contours import round_step

Floats = NDArray[np.float64]

CELL = 0.1  # m, between places at which the displacement is taken: it is smooth over a metre
MOST_LEVELS = 8  # between the least and the largest
LEAST_STEP = 0.001  # m between two levels
LONG = 0.8  # m of a line that may have its number


def unrolled_view(fitted: FittedVault) -> View | None:
    """The view of a vault's as-built surface; None where it has none, or has webs, which come in dozens of strips.

    Parts lie as in plan, each in its true lengths as far as can be; the view says how far.
    """
    webs = any(isinstance(part, Web) for piece in fitted.vault.pieces() for part in piece.parts)
    if fitted.surface is None or webs:
        return None
    sheet = unrolled(fitted.vault)
    told = [(leaf, *_displaced(sheet, leaf, fitted.surface)) for leaf in sheet.leaves]
    values = np.concatenate([off[np.isfinite(off)] for *_, off in told])
    low, high = (float(end) for end in np.quantile(values, (0.01, 0.99)))
    step = max(round_step((high - low) / MOST_LEVELS), LEAST_STEP)
    marks: list[Mark] = [Path("OUTLINE", row) for leaf, *_ in told for row in _outline(leaf)]
    true = f"lengths within {100 * min(sheet.distortion, MOST_DISTORTED):.1f} %"
    view = view_of("Intrados unrolled", marks, f"stone off the ideal vault in mm: {CONVENTION}; {true}")
    numbered = set[int]()
    for leaf, s, t, off in told:
        for level in range(ceil(low / step), floor(high / step) + 1):
            for line in _lines(leaf, s, t, off, level * step):
                layer = "INTO-STONE" if level > 0 else "INTO-ROOM" if level < 0 else "CONTOURS"
                view.marks.append(Path(layer, line))
                if level not in numbered and lengths(line).sum() > LONG:
                    numbered.add(level)
                    view.marks.append(_number(layer, line, f"{1000 * level * step:+g}"))
    return view


def _displaced(sheet: Sheet, leaf: Leaf, surface: Displacement) -> tuple[Floats, Floats, Floats]:
    """A grid over a part of a sheet, s (n,) and t (m,) [m], and how far the stone is off there (m, n) [m]."""
    s0, t0, s1, t1 = leaf.outline.bounds
    s, t = (np.linspace(a, b, max(2, ceil((b - a) / CELL) + 1)) for a, b in ((s0, s1), (t0, t1)))
    places = np.stack(np.meshgrid(s, t), axis=-1)
    xyz = leaf.surface(places.reshape(-1, 2))
    off, known = np.full(len(xyz), np.nan), np.isfinite(xyz).all(axis=1)
    off[known] = np.einsum("nc,nc->n", surface(xyz[known]), sheet.normals(xyz[known]))
    return s, t, off.reshape(places.shape[:2])


def _outline(leaf: Leaf) -> Iterator[Floats]:
    for part in getattr(leaf.outline, "geoms", [leaf.outline]):
        for ring in (part.exterior, *part.interiors):
            yield np.asarray(ring.coords)


def _lines(leaf: Leaf, s: Floats, t: Floats, off: Floats, level: float) -> Iterator[Floats]:
    from contourpy import contour_generator

    for line in contour_generator(s, t, np.ma.masked_invalid(off), name="serial").lines(level):
        yield from inside(line, leaf.outline)


def _number(layer: str, line: Floats, text: str) -> Word:
    """On the middle of a line, upright."""
    k = len(line) // 2 - 1
    (x0, y0), (x1, y1) = line[k].tolist(), line[k + 1].tolist()
    turn = float(np.arctan2(y1 - y0, x1 - x0))
    return Word(layer, ((x0 + x1) / 2, (y0 + y1) / 2), text, 1.8, angle=turn - np.pi * round(turn / np.pi))
