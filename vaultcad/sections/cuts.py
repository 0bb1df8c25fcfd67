"""Sections through a fitted scan: every vault and arch, by the planes that it asks for or by planes by hand."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import nan

import numpy as np
from numpy.typing import NDArray

from families.void.upright import Upright
from vaultcad.errors import VaultcadError
from vaultcad.labelled_scan import LabelledScan
from vaultcad.measure.deviation import summarise
from vaultcad.model import FittedVault
from vaultcad.one_thread import one_thread
from vaultcad.sections.cut import displaced, in_slab, profile, stations, wall_stations
from vaultcad.sections.guide import guides, wall_guide
from vaultcad.sections.parts import measured
from vaultcad.sections.planes import every as planes_every
from vaultcad.sections.planes import genesis_planes, given
from vaultcad.sections.section import Level, ModelLine, ProfileRun, Section, SectionArch, SectionPart, SectionPlane

Floats = NDArray[np.float64]

SLAB, GRID = 0.03, 0.02  # m, to either side of a plane, and of the cells along the line: the paper's
UNSURE_FOOT = 0.05  # m, of springings whose deviation is not known
MOST_DOTS = 4000  # of a section, that are kept for drawings
AROUND = 0.3  # m around a plan, in which walls are looked for


@one_thread
def sections(
    scan: LabelledScan,
    *,
    vault: int | None = None,
    planes: Sequence[tuple[float, float, float]] = (),
    every: float | None = None,
    slab: float = SLAB,
    grid: float = GRID,
) -> tuple[Section, ...]:
    """Cut all vaults and arches of a fitted scan, or one vault.

    Args:
        scan: from `read_labelled_scan` or `labelled_scan`.
        vault: its number from 1.
        planes: x, y [m] in the scan's coordinates and azimuth [rad] from x, in place of those of each genesis.
        every: planes across each vault so far apart [m], likewise.
        slab: half the thickness of a cut [m].
        grid: of the cells in which points are taken together [m].

    Raises:
        NoSuchVaultError: there is no such vault.
        VaultcadError: no plane meets one.
        ValueError: a length is not positive.
    """
    for name, value in (("slab", slab), ("grid", grid)):
        if not value > 0:
            raise ValueError(f"{name} = {value!r} m is no length; give one above 0")
    model = scan.model
    if vault is not None:
        model.check_number(vault)
    local = [(x - float(model.origin[0]), y - float(model.origin[1]), azimuth) for x, y, azimuth in planes]
    found: list[Section] = []
    for number, fitted in enumerate(model.vaults, 1):
        if vault in (None, number):
            asked = (*given(fitted, local), *(planes_every(fitted.vault, every) if every is not None else ()))
            chosen = asked if planes or every is not None else genesis_planes(fitted.vault)
            found += _cuts(scan, fitted, scan.of(number), chosen, f"v{number}", (number, 0), slab, grid)
    for number, arch in enumerate(model.arches, 1):
        if vault is None and not planes and every is None:
            first = genesis_planes(arch.vault)[:1]
            mine = np.flatnonzero(scan.arch == number)
            found += _cuts(scan, arch, mine, first, f"a{number}", (0, number), slab, grid)
    if not found:
        told = "; ".join(f"{x:g},{y:g}" for x, y, _ in planes)
        asked_for = f"planes through {told}" if planes else "the planes that are asked for"
        raise VaultcadError(f"{asked_for}: meet no vault; give places within one, in the scan's coordinates")
    return tuple(found)


def _cuts(
    scan: LabelledScan,
    fitted: FittedVault,
    mine: NDArray[np.int64],
    planes: Sequence[SectionPlane],
    name: str,
    number: tuple[int, int],
    slab: float,
    grid: float,
) -> Iterator[Section]:
    frame, own = fitted.pose.frame(), scan.xyz[mine]
    placement = fitted.pose.placement()
    placement[:3, 3] += scan.model.origin
    spread = {} if fitted.covariance is None else fitted.covariance.stds()
    foot = spread.get("z", 0.0) or UNSURE_FOOT
    for plane in planes:
        told = (f"{name}-{plane.name.replace(' ', '-')}", *number, plane, placement, slab, grid)
        if isinstance(plane.cut, Level):
            yield _level(scan, fitted, plane.cut, frame, told)
        else:
            near = own[in_slab(own, frame, plane.cut, slab)]
            yield _upright(fitted, plane.cut, near @ frame[:, :3].T + frame[:, 3], told, foot)


Told = tuple[str, int, int, SectionPlane, Floats, float, float]


def _upright(fitted: FittedVault, cut: Upright, points: Floats, told: Told, foot: float) -> Section:
    vault, grid = fitted.vault, told[-1]
    lines, along = guides(vault, cut)
    runs: list[ProfileRun] = []
    arches: list[SectionArch] = []
    parts: list[SectionPart] = []
    for guide in along:
        found = stations(vault, cut, guide, points, grid)
        runs += profile(guide, found, grid)
        more_arches, more_parts = measured(vault, guide, found, grid, foot)
        arches += more_arches
        parts += more_parts
    surface = fitted.surface
    moved = () if surface is None else tuple(displaced(vault, cut, guide, surface) for guide in along)
    off = vault.distance(points)
    return Section(
        *told,
        tuple(runs),
        tuple(ModelLine(line, component) for line, component in lines),
        moved,
        tuple(arches),
        tuple(parts),
        vault.components,
        len(points),
        summarise(off) if len(off) else None,
        float(off.mean()) if len(off) else nan,
        float(np.median(off)) if len(off) else nan,
        _thinned(cut.drawn(points)),
        _thinned(off),
    )


def _level(scan: LabelledScan, fitted: FittedVault, cut: Level, frame: Floats, told: Told) -> Section:
    """The walls at the springing, which are no part of the vault: all points count that lie near the plan's sides."""
    slab, grid = told[-2:]
    near = scan.xyz[in_slab(scan.xyz, frame, cut, slab)] @ frame[:, :3].T + frame[:, 3]
    low, high = fitted.vault.plan.box
    points = near[((near[:, :2] > low - AROUND) & (near[:, :2] < high + AROUND)).all(axis=1)]
    lines, guide = wall_guide(fitted.vault.plan)
    found = wall_stations(guide, cut.drawn(points), grid)
    return Section(
        *told,
        profile(guide, found, grid) if len(found.s) else (),
        tuple(ModelLine(line, np.zeros(len(line) - 1, np.uint16)) for line in lines),
        (),
        (),
        (),
        fitted.vault.components,
        int(found.count.sum()),
        summarise(found.offset) if len(found.s) else None,
        float(found.offset.mean()) if len(found.s) else nan,
        float(np.median(found.offset)) if len(found.s) else nan,
        _thinned(found.at(guide)),
        _thinned(found.offset),
    )


def _thinned(drawn: Floats) -> Floats:
    return drawn[:: max(1, -(-len(drawn) // MOST_DOTS))]
