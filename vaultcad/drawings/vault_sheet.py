"""The sheet of one vault: sections above, plan below, what is known of it in the title block."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from families.drawing.section import PLANES, outlines
from vaultcad.drawings.fields import scan_fields
from vaultcad.drawings.marks import View
from vaultcad.drawings.plan_view import plan_view
from vaultcad.drawings.section_view import Cut, section_view
from vaultcad.drawings.sheet import Sheet, Wish, lay_out
from vaultcad.model import Assembly, FittedVault, PlacedVault

AT_WALL = 0.998  # of the way to the wall, where the arch on it is taken
SIZES = 6  # of a vault that its title block has room for


def vault_sheet(model: Assembly, number: int, wish: Wish) -> Sheet:
    """The sheet of the vault with that number, from 1.

    Raises:
        DrawingError: it does not fit as it is wished for.
    """
    placed = model.vaults[number - 1]
    cuts = tuple(middle_cuts(placed))

    def views(scale: int) -> Sequence[Sequence[View]]:
        sections = [section_view(model, placed, one, scale) for one in cuts]
        return [sections, [plan_view(model, placed, cuts, scale)]]

    title = f"Vault {number}: {placed.vault.title}"
    fields = (*_fields(model, placed), *scan_fields(model))
    return lay_out(f"vault-{number}", title, views, fields, wish, -placed.pose.yaw)


def middle_cuts(placed: PlacedVault) -> Iterator[Cut]:
    """The sections through the middle, along both axes of the vault."""
    vault = placed.vault
    for plane in PLANES:
        lines = tuple(line for line, _ in outlines(vault, plane.across, 0.0))
        along = (1.0, 0.0) if plane.across == 0 else (0.0, 1.0)
        title = f"Section {plane.letter}–{plane.letter}"
        low, high = vault.plan.box
        wall = float((high if plane.looks > 0 else low)[plane.axis]) * AT_WALL
        beyond = tuple(line for line, _ in outlines(vault, plane.across, wall))
        yield Cut(plane.letter, title, (0.0, 0.0), along, lines, tuple(plane.chords(vault)), beyond)


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
    yield "thickness", f"{100 * model.thickness_of(placed):g} cm, assumed: no scan from below shows it"
