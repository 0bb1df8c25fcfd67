"""Are kinds of arches told apart in sections, and how near to the stone are the lines drawn?

Sections of arches of every kind, settled and with noise, whose springings are known to a few centimetres.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from time import perf_counter

import numpy as np

from bench import section_lines
from bench.figures import Figure, Table, clock, error, label, number, share
from families import Barrel, Elliptical, Profile, Stilted
from families.declaration.usual_arches import DRAWN
from vaultcad.model import said
from vaultcad.scanner.settle import draw_settlement
from vaultcad.sections.arch_curves import KINDS, drawn
from vaultcad.sections.classify import classified
from vaultcad.sections.placed_arch import ArchPoints

FIRST = 70_000  # seed of the first section
CASES = 100  # of each kind
NOISE, SETTLED = 0.003, 0.01  # m
FOOT = 0.05  # m, standard deviation of the springings as they are told
SPACING = 0.02  # m, of the points along an arch
DRAWN_HERE: dict[str, Callable[[np.random.Generator], Profile]] = {
    **DRAWN,
    "stilted": lambda rng: Stilted(rng.uniform(0.56, 0.7)),
    "raised": lambda rng: Elliptical(rng.uniform(0.55, 0.8)),
}
"""How each kind is drawn: stilts higher than springings are uncertain, for lower ones no section can show."""

KIND_COLUMNS = (
    label("true kind", 16),
    number("number"),
    share("likeliest", "number"),
    share("among said", "number"),
    number("said", decimals=2),
    error("rise off", decimals=4),
    number("with arcs"),
    share("radius within 2 std", "with arcs"),
    clock("time", "ms", 1),
)


def options(parser: argparse.ArgumentParser) -> None:
    """Those of this benchmark."""
    parser.add_argument("--cases", type=int, default=CASES, help=f"sections of a kind (sections), default {CASES}")


def run(chosen: argparse.Namespace) -> Iterator[Table]:
    """Kinds by what they truly are, and lines by family."""
    settings: dict[str, Figure] = {"noise mm": 1000 * NOISE, "settled mm": 1000 * SETTLED, "first seed": FIRST}
    yield Table("kinds", "kinds of arches told apart in sections", settings, KIND_COLUMNS, _kinds(chosen.cases))
    settings = {
        "points": section_lines.POINTS,
        "noise mm": 1000 * section_lines.NOISE,
        "settled mm": 1000 * section_lines.SETTLED,
        "first seed": section_lines.FIRST,
    }
    title = "distance of section lines from the stone: along the model, without one, by concave hull"
    yield Table("section lines", title, settings, section_lines.COLUMNS, section_lines.rows())


def drawn_profile(name: str, rng: np.random.Generator) -> Profile:
    """An arch of a kind as builders drew it."""
    return DRAWN_HERE[name](rng)


def arch_points(profile: Profile, span: float, settled: float, rng: np.random.Generator) -> ArchPoints:
    """A section across the middle of a barrel that has settled by so much at most [m], with noise."""
    barrel = Barrel(span, 1.5 * span, profile)
    line = drawn(profile.curve(span / 2), 2001)
    space = np.column_stack([line[:, 0], np.zeros(len(line)), line[:, 1]])
    moved = line.copy()
    if settled:
        whole = barrel.sample(2000, rng).xyz
        moved += draw_settlement(whole, barrel.plan, 1.5, settled, rng)(space)[:, [0, 2]]
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(moved, axis=0), axis=1))])
    kept = np.concatenate([[True], np.diff(length) > 1e-9])
    along = np.arange(SPACING / 2, length[-1], SPACING)
    at = np.column_stack([np.interp(along, length[kept], moved[kept, k]) for k in (0, 1)])
    tangent = np.gradient(at, axis=0)
    normal = np.column_stack([-tangent[:, 1], tangent[:, 0]]) / np.linalg.norm(tangent, axis=1)[:, None]
    at += rng.normal(0, NOISE, len(at))[:, None] * normal
    feet = moved[[0, -1]] + [[0.0, rng.normal(0, FOOT)]]
    return ArchPoints(at, normal, feet, FOOT, span)


def _kinds(cases: int) -> Iterator[tuple[Figure, ...]]:
    whole = []
    for kind in KINDS:
        rows = []
        for k in range(cases):
            rng = np.random.default_rng(FIRST + k)
            profile, span = drawn_profile(kind.name, rng), rng.uniform(3, 8)
            points = arch_points(profile, span, SETTLED, rng)
            began = perf_counter()
            found = classified(points)
            took = perf_counter() - began
            assert found is not None
            names = said(found.odds)
            curve, inside = profile.curve(span / 2), np.nan
            if found.kind == kind.name and found.arcs:
                radius = found.sizes["radius" if "radius" in found.sizes else "crown_radius"]
                inside = abs(radius.value - curve.arcs[-1].radius) <= 2 * (radius.std or 0.0)
            off = abs(found.sizes["rise"].value - curve.rise)
            rows.append((found.kind == kind.name, kind.name in names, len(names), off, inside, took))
        whole += rows
        yield _row(kind.name, rows)
    yield _row("all", whole)


def _row(name: str, rows: list[tuple[bool, bool, int, float, float, float]]) -> tuple[Figure, ...]:
    right, among, said_, off, inside, took = np.array(rows, dtype=np.float64).T
    known = inside[np.isfinite(inside)]
    within = float(known.mean()) if len(known) else None
    shares = float(right.mean()), float(among.mean()), float(said_.mean())
    return name, len(rows), *shares, float(np.median(off)), len(known), within, 1000 * float(took.mean())
