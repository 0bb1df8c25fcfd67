"""What a section line is made of: whole arches, arcs that are part of one, and straight lines, each measured."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from families import Vault
from families.declaration.pieces import BarrelPart, Turned
from vaultcad.sections.classify import classified
from vaultcad.sections.cut import Stations
from vaultcad.sections.field_fit import MovedPoints, as_it_stands, fit_curve
from vaultcad.sections.guide import STEP, Guide
from vaultcad.sections.placed_arch import ArchPoints
from vaultcad.sections.section import SectionArc, SectionArch, SectionPart
from vaultcad.uncertain import Estimate

Floats = NDArray[np.float64]

STRAIGHT = 0.004  # of its length, that a straight line bulges at most
SHORTEST = 0.3  # m, of what is measured
UNEVEN = 0.1  # of the span, by which the feet of an arch differ in height at most
RISES = 0.5  # of the height of its crown over the lower foot, that of an arch over the higher one
SEEN = 0.6  # of its cells that the scan must see
AT_END = 0.01  # m from an end of the line: there an arch springs, or is cut by a wall
BESIDE = 0.12  # m from an end of the line: just inside a wall an arch begins beside its springing
AT_BASE = 0.05  # m from the height where a profile of the family springs
SURE_FOOT = 0.02  # m, least deviation of a foot's height
FLATTEST = 20.0  # radius by length of what is still an arc
WIDE = 100.0  # lengths: of an arc's centre and radius nothing is known beforehand


@dataclass(frozen=True)
class _Span:
    """Samples of a guide from the first to before the last. curved: or straight. arch: whether it goes up and down."""

    first: int
    last: int
    curved: bool
    arch: bool = False


def measured(
    vault: Vault, guide: Guide, found: Stations, grid: float, foot_std: float
) -> tuple[list[SectionArch], list[SectionPart]]:
    """The arches of a section line, and its other parts; `foot_std` [m] of the springing's height."""
    arches, parts = [], []
    for span in _spans(guide):
        own = np.flatnonzero((found.sample >= span.first) & (found.sample < span.last))
        own = own[np.lexsort((found.s[own], guide.piece[found.sample[own]]))]
        line = guide.at[span.first : span.last]
        length = float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum())
        if length < SHORTEST or len(own) * grid < SEEN * length:
            continue
        at, normal = found.at(guide)[own], guide.normal[found.sample[own]]
        names = tuple(dict.fromkeys(vault.components[k - 1] for k in guide.component[span.first : span.last].tolist()))
        arch = None
        if span.arch and (feet := _feet(vault, guide, span)) is not None:
            std = max(foot_std, SURE_FOOT)
            arch = classified(ArchPoints(at, normal, feet[np.argsort(feet[:, 0])], std, vault.plan.width), names)
        if arch is not None:
            arches.append(arch)
        elif (part := _part(at, normal, vault.plan.width, names, curved=span.curved)) is not None:
            parts.append(part)
    return arches, parts


def _spans(guide: Guide) -> list[_Span]:
    """Where a guide bends, is straight, and where two halves make an arch."""
    runs: list[_Span] = []
    for piece in guide.pieces():
        inner = np.flatnonzero(np.diff(guide.component[piece])) + 1 + piece.start
        smooth: list[_Span] = []
        for a, b in pairwise([piece.start, *inner.tolist(), piece.stop]):
            curved = _bulge(guide.at[a:b]) > STRAIGHT
            joins = smooth and curved and smooth[-1].curved
            smooth.append(_Span(smooth.pop().first if joins else a, b, curved))
        runs += smooth
    runs = [_Span(run.first, run.last, run.curved, run.curved and _up_and_down(guide, run)) for run in runs]
    found: list[_Span] = []
    for run in runs:
        if found and (both := _halves(guide, found[-1], run)) is not None:
            found[-1] = both
        else:
            found.append(run)
    return found


def _bulge(line: Floats) -> float:
    """Farthest from the chord, by its length."""
    chord = line[-1] - line[0]
    size = float(np.hypot(*chord))
    off = line - line[0]
    return float(np.abs(off[:, 0] * chord[1] - off[:, 1] * chord[0]).max() / max(size, 1e-9) ** 2)


def _up_and_down(guide: Guide, run: _Span) -> bool:
    z = guide.at[run.first : run.last, 1]
    low, high = sorted((float(z[0]), float(z[-1])))
    width = abs(float(guide.at[run.last - 1, 0] - guide.at[run.first, 0]))
    return bool(high - low < UNEVEN * width and z.max() - high > RISES * (z.max() - low))


def _halves(guide: Guide, left: _Span, right: _Span) -> _Span | None:
    """The arch of which two spans are the halves, if they are."""
    meets = np.hypot(*(guide.at[left.last - 1] - guide.at[right.first])) < 3 * STEP
    halves = all(run.curved and not run.arch for run in (left, right))
    rises, falls = (float(guide.at[run.last - 1, 1] - guide.at[run.first, 1]) for run in (left, right))
    both = _Span(left.first, right.last, curved=True, arch=True)
    return both if meets and halves and rises > 0 > falls and _up_and_down(guide, both) else None


def _feet(vault: Vault, guide: Guide, span: _Span) -> Floats | None:
    """Springings of an arch (2, 2): ends of the line, or where a profile of the family begins; None if not both are."""
    bases = [p.base for piece in vault.pieces() for p in piece.parts if isinstance(p, BarrelPart | Turned)]

    def foot(own: Floats, end: float) -> Floats | None:
        if abs(own[0] - end) < AT_END:
            return own
        if abs(own[0] - end) < BESIDE:
            return np.array([end, vault.lift])
        return own if bases and min(abs(own[1] - base) for base in bases) < AT_BASE else None

    feet = foot(guide.at[span.first], guide.chord[0]), foot(guide.at[span.last - 1], guide.chord[1])
    return None if feet[0] is None or feet[1] is None else np.array(feet)


def _part(at: Floats, normal: Floats, width: float, names: tuple[str, ...], *, curved: bool) -> SectionPart | None:
    if len(at) < 3:
        return None
    if curved and (arc := _arc(at, normal, width)) is not None:
        part, rms = arc
        return SectionPart("arc", part, part.points(), rms, names)
    middle = at.mean(axis=0)
    along = np.linalg.svd(at - middle, full_matrices=False)[2][0]
    reach = (at - middle) @ along
    ends = middle + np.array([[reach[0]], [reach[-1]]]) * along
    off = (at - middle) @ np.array([-along[1], along[0]])
    return SectionPart("straight", None, ends, float(np.sqrt((off**2).mean())), names)


def _arc(at: Floats, normal: Floats, width: float) -> tuple[SectionArc, float] | None:
    """The circle through points (n, 2) from left to right, as it stands, and the rms [m] of these from it."""
    start = np.linalg.lstsq(np.column_stack([2 * at, np.ones(len(at))]), (at**2).sum(axis=1), rcond=None)[0]
    length = float(np.linalg.norm(np.diff(at, axis=0), axis=1).sum())
    square = float(start[2] + start[:2] @ start[:2])
    if square <= 0 or sqrt(square) > FLATTEST * length:
        return None
    first = np.array([*start[:2], sqrt(square)])

    def residuals(values: Floats) -> Floats:
        return np.asarray(np.linalg.norm(at - values[:2], axis=1) - values[2], np.float64)

    def slopes(values: Floats, here: Floats) -> Floats:
        return np.column_stack([-(at - values[:2]) / (here + values[2])[:, None], -np.ones(len(at))])

    step = max(1, len(at) // 48)
    kept = slice(None, None, step)
    middle, whole = at.mean(axis=0), at
    at = at[kept]
    moved = MovedPoints.of(at - middle, normal[kept], length / 2, max(float(np.ptp(whole[:, 1])), 1e-2), width)
    known = first, np.full(3, WIDE * length)
    fit = as_it_stands(fit_curve(moved, residuals, slopes, first, *known), moved, residuals, slopes, *known)
    std = np.sqrt(np.maximum(np.diag(fit.covariance), 0.0)).tolist()
    meanings = "centre of the arc", "centre of the arc above the vault's springing", "radius of the arc"
    u, z, radius = (Estimate(v, "m", s, m) for v, s, m in zip(fit.values.tolist(), std, meanings, strict=True))
    off = whole[[-1, 0]] - fit.values[:2]
    a, b = np.arctan2(off[:, 1], off[:, 0]).tolist()
    if (normal[0] @ (whole[0] - fit.values[:2])) < 0:  # the stone lies within the circle
        a, b = b, a
    return SectionArc(u, z, radius, a, a + (b - a) % (2 * np.pi)), fit.rms
