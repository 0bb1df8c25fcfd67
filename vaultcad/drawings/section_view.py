"""A vault cut by a vertical plane, as a view of a sheet: stone, intrados, springing, centres of arcs, sizes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from families.void.upright import Upright
from vaultcad.drawings.marks import Cross, Dimension, Hatch, Mark, Path, View, Word, circle_of, view_of
from vaultcad.export.component_bodies import Body
from vaultcad.export.drawing import cut
from vaultcad.export.geometry import bodies
from vaultcad.fitted_arcs import OFF, fitted_arcs
from vaultcad.model import Assembly, PlacedVault, said
from vaultcad.sections.section import SectionArch

Floats = NDArray[np.float64]

BESIDE_JOINTS = 1e-5  # m from the plane at which stone is cut, as triangles may end on the plane itself
SAME_CIRCLE = 0.02  # m by which centres and radii of the pieces of one circle differ
FLATTEST = 60.0  # m; arcs of a larger radius are no arcs that a mason drew
LONG_ARC = 0.25  # of the clear width; shorter arcs tell no centre
LEVEL_LINE = 16.0  # mm on the paper by which the lines of levels begin left of the view
APART = 0.01  # m by which a section is higher than the crown where it says so
BESIDE = 0.4  # of the way from a centre to the middle of its arc, level, from which on its radius stands beside that
CLEAR = 6.0  # mm between the radii of two arcs, of which one is told where they all but coincide
AWAY = 9.0  # mm on the paper from the view to its dimensions


@dataclass(frozen=True)
class Cut:
    """What a section shows, in (u, z) [m] of its plane, z from the springing, under a letter.

    intrados, beyond, as_built, scan: rows (n, 2), open; beyond is what is seen behind it: the arch at the wall. chords:
    where it enters and leaves the plan. arches: those that the scan's line shows, which tell radii and kinds.
    """

    letter: str
    kind: str
    plane: Upright
    intrados: tuple[Floats, ...]
    chords: tuple[tuple[float, float], ...]
    beyond: tuple[Floats, ...] = ()
    as_built: tuple[Floats, ...] = ()
    scan: tuple[Floats, ...] = ()
    arches: tuple[SectionArch, ...] = ()

    @property
    def title(self) -> str:
        """Which it is."""
        return f"Section {self.letter}–{self.letter}, {self.kind}"

    @property
    def says(self) -> str:
        """What its arches may be."""
        return "; ".join(dict.fromkeys(" or ".join(said(arch.odds)) for arch in self.arches))


def section_view(model: Assembly, placed: PlacedVault, section: Cut, scale: int) -> View:
    """The view, for a sheet at one to `scale`, which says how far off dimensions are."""
    vault, thickness, up = placed.vault, model.thickness_of(placed), placed.pose.z + float(model.origin[2])
    stone = [row for body in bodies(vault, thickness) for row in _cut_rows(body, section)]
    marks: list[Mark] = [Hatch("HATCH", (row,)) for row in stone]
    marks += [_path("STONE", row, closed=True) for row in stone]
    inner = [_path("INTRADOS", row) for row in section.intrados]
    behind = [_path("BEYOND", row) for row in section.beyond]
    marks += behind + inner
    marks += [_path("AS-BUILT", row) for row in section.as_built]
    marks += [_path("SCAN", row) for row in section.scan]
    view = view_of(section.title, marks, section.says)
    mm = scale / 1000.0
    left, right = float(view.low[0]), float(view.high[0])
    out = AWAY * mm
    crown = vault.lift + vault.derived_values()["rise"]
    top = max(float(row[:, 1].max()) for row in section.intrados)
    levels = [(vault.lift, "springing")]
    if crown - top > APART:  # which this plane does not meet
        crown = top
    else:
        levels.append((crown, "crown"))
    if top > levels[-1][0] + APART:
        levels.append((top, "highest"))
    for level, name in levels:
        begin = left - LEVEL_LINE * mm
        view.marks.append(Path("SPRINGING", np.array([[begin, level], [right + out / 3, level]])))
        view.marks.append(Word("TEXT", (begin, level + 0.7 * mm), f"{level + up:+.3f}", 2.0, across=-1, up=-1))
        view.marks.append(Word("TEXT", (begin, level - 0.9 * mm), name, 1.6, across=-1, up=1))
    foot = float(view.low[1]) - out
    for a, b in section.chords:
        view.marks.append(Dimension("DIMENSIONS", (a, 0.0), (b, 0.0), (a, foot)))
    plumb = (right + out, 0.0)
    view.marks.append(Dimension("DIMENSIONS", (right, vault.lift), (right, crown), plumb, np.pi / 2))
    if (crown, "crown") in levels:
        view.marks.append(Dimension("DIMENSIONS", (right, crown), (right, crown + thickness), plumb, np.pi / 2))
    if section.arches:
        view.marks += _arcs(section.arches, foot, mm)
    else:
        view.marks += _circles(inner + behind, section.chords, foot, mm)
    return view


def _path(layer: str, row: Floats, *, closed: bool = False) -> Path:
    corners, bulges = fitted_arcs(np.concatenate([row, row[:1]]) if closed else row, OFF)
    return Path(layer, corners[:-1], bulges[:-1], closed=True) if closed else Path(layer, corners, bulges)


def _cut_rows(body: Body, section: Cut) -> Iterator[Floats]:
    """Closed rows (n, 2) of a body where the plane cuts it."""
    plane, points = section.plane, body.vertices
    turned = np.column_stack([plane.along(points), plane.off(points), points[:, 2]])
    for row in cut(Body(body.id, body.name, turned, body.triangles, body.intrados_area), 1, BESIDE_JOINTS):
        yield row[:, [0, 2]]


def _circles(paths: Sequence[Path], chords: Sequence[tuple[float, float]], foot: float, mm: float) -> Iterator[Mark]:
    """The centres of the long arcs, where they are above `foot`, and their radii; pieces of a circle tell it once."""
    told: list[tuple[Floats, float]] = []
    words: list[Floats] = []
    long = LONG_ARC * max(q - p for p, q in chords)
    for path in paths:
        for k, bulge in enumerate(path.bulges[: len(path.points) - 1]):
            a, b = path.points[k], path.points[k + 1]
            if abs(bulge) < 1e-6 or np.hypot(*(b - a)) < long:
                continue
            centre, radius = circle_of(a, b, bulge)
            if radius > FLATTEST or any(np.hypot(*(centre - c)) + abs(radius - r) < SAME_CIRCLE for c, r in told):
                continue
            told.append((centre, radius))
            middle = (a + b) / 2 - np.array([a[1] - b[1], b[0] - a[0]]) * bulge / 2
            if all(np.hypot(*(middle - word)) > CLEAR * mm for word in words):
                words.append(middle)
                yield _radius(middle, _unit(middle - centre), f"R {radius:.3f}", mm)
            if centre[1] > foot:
                yield Cross("CENTRES", (float(centre[0]), float(centre[1])))


def _arcs(arches: Sequence[SectionArch], foot: float, mm: float) -> Iterator[Mark]:
    """The same of the arches that the stone shows, with how sure their radii are."""
    for arch in arches:
        for arc in arch.arcs:
            centre, radius = np.array([arc.u.value, arc.z.value]), arc.radius.value
            if radius > FLATTEST:
                continue
            angle = (arc.start + arc.end) / 2
            way = np.array([np.cos(angle), np.sin(angle)])
            sure = f" ± {arc.radius.std:.3f}" if arc.radius.std else ""
            yield _radius(centre + radius * way, way, f"R {radius:.3f}{sure}", mm)
            if centre[1] > foot:
                yield Cross("CENTRES", (arc.u.value, arc.z.value))


def _radius(middle: Floats, way: Floats, text: str, mm: float) -> Word:
    """What a radius is, within its arc, whose middle (2,) looks that way (2,): beside haunches, below crowns."""
    x, y = (middle - 3.0 * mm * way).tolist()
    beside = int(np.sign(way[0])) if abs(way[0]) > BESIDE else 0
    return Word("CENTRES", (x, y), text, 2.0, across=beside, up=0 if beside else 1)


def _unit(way: Floats) -> Floats:
    found: Floats = way / np.hypot(*way)
    return found
