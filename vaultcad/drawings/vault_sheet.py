"""The sheet of one vault: sections above, plan and unrolled intrados below, what is known of it in the title block."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from string import ascii_uppercase

import numpy as np
from numpy.typing import NDArray

from families import Vault
from families.void.upright import Upright, chords, outlines
from vaultcad.drawings.fields import scan_fields
from vaultcad.drawings.marks import View
from vaultcad.drawings.plan_view import plan_view
from vaultcad.drawings.section_view import Cut, section_view
from vaultcad.drawings.sheet import Sheet, Wish, lay_out
from vaultcad.drawings.unrolled_view import unrolled_view
from vaultcad.model import Assembly, FittedVault, PlacedVault
from vaultcad.sections.cut import displaced
from vaultcad.sections.guide import guides
from vaultcad.sections.planes import genesis_planes
from vaultcad.sections.section import Section

Floats = NDArray[np.float64]

AT_WALL = 0.998  # of the way to the wall, where the arch on it is taken
AS_WIDE = 0.5  # of a section, that what is behind it must be to be shown
COARSEST = 50  # scale of a vault's sheet, before its paper grows
MOST_SECTIONS = 4  # on a sheet
SIZES = 6  # of a vault that its title block has room for


def vault_sheet(model: Assembly, number: int, wish: Wish, sections: Sequence[Section] = ()) -> Sheet:
    """The sheet of the vault with that number, from 1; with what its sections show of the scan, where there are any.

    Raises:
        DrawingError: it does not fit as it is wished for.
    """
    placed = model.vaults[number - 1]
    cuts = tuple(cuts_of(placed, [one for one in sections if one.vault == number]))
    laid = unrolled_view(placed) if isinstance(placed, FittedVault) else None

    def views(scale: int) -> tuple[Sequence[View], Sequence[View]]:
        plan = [plan_view(model, placed, cuts, scale), *(() if laid is None else (laid,))]
        return [section_view(model, placed, one, scale) for one in cuts], plan

    title = f"Vault {number}: {placed.vault.title}"
    fields = (*_fields(model, placed), *scan_fields(model))
    return lay_out(f"vault-{number}", title, views, fields, wish, -placed.pose.yaw, COARSEST)


def cuts_of(placed: PlacedVault, sections: Sequence[Section] = ()) -> Iterator[Cut]:
    """The first plane of each kind that the vault's genesis asks for, with what the scan's sections show there."""
    vault = placed.vault
    shown = {section.plane.name: section for section in sections}
    surface = placed.surface if isinstance(placed, FittedVault) else None
    first: dict[str, tuple[str, Upright]] = {}
    for asked in genesis_planes(vault):
        if isinstance(asked.cut, Upright):
            first.setdefault(asked.kind, (asked.name, asked.cut))
    for letter, (kind, (name, plane)) in zip(ascii_uppercase, [*first.items()][:MOST_SECTIONS], strict=False):
        lines, along = guides(vault, plane)
        moved = () if surface is None else (displaced(vault, plane, guide, surface) for guide in along)
        section = shown.get(name)
        yield Cut(
            letter,
            kind,
            plane,
            tuple(line for line, _ in lines),
            tuple(chords(vault.plan, plane)),
            tuple(_beyond(vault, plane)),
            tuple(line.line for line in moved),
            () if section is None else tuple(run.line for run in section.profile),
            () if section is None else section.arches,
        )


def _beyond(vault: Vault, plane: Upright) -> Iterator[Floats]:
    """What is seen behind a section at the wall, if that is about as wide."""
    reach = AT_WALL * float(plane.off(vault.plan.outline()).max())
    (x, y), (a, b) = plane.origin, plane.normal
    behind = Upright((x + reach * a, y + reach * b), plane.direction)
    wide = max(high - low for low, high in chords(vault.plan, plane))
    for line, _ in outlines(vault, behind):
        if np.ptp(line[:, 0]) > AS_WIDE * wide:
            yield line


def _fields(model: Assembly, placed: PlacedVault) -> Iterator[tuple[str, str]]:
    """What is known of a vault; of one that was drawn, its sizes."""
    sizes = [(name, e) for name, e in placed.numbers().items() if e.unit == "m"][:SIZES]
    told = [f"{name} {e.value:.3f}{f' ± {e.std:.3f}' if e.std else ''}{e.marks}" for name, e in sizes]
    for k in range(0, len(told), 3):
        yield "" if k else "sizes, m", ", ".join(told[k : k + 3])
    if isinstance(placed, FittedVault):
        d = placed.deviation
        yield "confidence", f"{placed.confidence:.0%}{f'; {placed.doubt}' if placed.doubt else ''}"
        yield "stone to model", f"rms {1000 * d.rms:.1f} mm, 95 % below {1000 * d.p95:.1f} mm; {d.loa}"
    shell = placed.measured_shell if isinstance(placed, FittedVault) else None
    if shell is None:
        why = "as asked for" if placed.thickness else "assumed: the scan does not show the back"
        yield "thickness", f"{100 * model.thickness_of(placed):g} cm, {why}"
    else:
        off = f"± {100 * (shell.std or 0.0):.1f} cm, as it varies"
        yield "thickness", f"{100 * shell.value:.1f} {off}: measured between both faces"
