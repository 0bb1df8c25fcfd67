"""All sheets of a model, and their files."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from vaultcad.drawings.building_sheet import building_sheets
from vaultcad.drawings.cad import write_dxf
from vaultcad.drawings.paper import write_pdf, write_svg
from vaultcad.drawings.sheet import Sheet, Wish
from vaultcad.drawings.vault_sheet import vault_sheet
from vaultcad.model import Model
from vaultcad.sections.section import Section

CAD, PAGES = "drawings.dxf", "drawings.pdf"


def sheets(
    model: Model, wish: Wish | None = None, vaults: Sequence[int] = (), sections: Sequence[Section] = ()
) -> list[Sheet]:
    """One a vault, after those of the whole building where there is more than one; or of some vaults alone, from 1.

    sections: what `vaultcad.sections.cuts.sections` shows of the scan by the planes of each genesis; may be left out.

    Raises:
        NoSuchVaultError: there is no such vault.
        DrawingError: a sheet does not fit as it is wished for.
    """
    for number in vaults:
        model.check_number(number)
    return [*_sheets(model, wish or Wish(), vaults, sections)]


def _sheets(model: Model, wish: Wish, vaults: Sequence[int], sections: Sequence[Section]) -> Iterator[Sheet]:
    if not vaults and len(model.vaults) > 1:
        yield from building_sheets(model, wish)
    for number in vaults or range(1, len(model.vaults) + 1):
        yield vault_sheet(model, number, wish, sections)


def write_drawings(made: Sequence[Sheet], place: str, folder: Path) -> None:
    """Write one DXF and one PDF of all sheets, and an SVG of each, into a folder that exists."""
    write_dxf(made, folder / CAD, place)
    write_pdf(made, folder / PAGES)
    for sheet in made:
        write_svg(sheet, folder / svg_name(sheet))


def svg_name(sheet: Sheet) -> str:
    """Of a sheet's own file."""
    return f"{sheet.name}.svg"
