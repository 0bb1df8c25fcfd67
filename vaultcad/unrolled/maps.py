"""All maps of the unrolled vaults of a scan, in a folder: pictures, values, lines, and what they lie by."""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Mapping, Sequence
from math import degrees
from pathlib import Path
from typing import Any, NamedTuple

from families.unrolled.gores import MOST_DISTORTED
from families.unrolled.sheet import Leaf, Sheet
from vaultcad.labelled_scan import LabelledScan
from vaultcad.one_thread import one_thread
from vaultcad.unrolled.contours import Contour, contours
from vaultcad.unrolled.drawn_lines import write_sheet
from vaultcad.unrolled.pictures import MEASURED, write_picture, write_values
from vaultcad.unrolled.raster import WHAT, lay_scan, pixel_for, raster

UNROLLED = "unrolled.json"
SCHEMA = 1
ABOUT = (
    "unrolled intrados by vaultcad, in metres, as seen from above, parts turned as in plan; model.json alone gives the "
    "same sheets again"
)


class Written(NamedTuple):
    """What could not be made, in words, and what was, as in the file `UNROLLED`."""

    notes: tuple[str, ...]
    sheets: tuple[Mapping[str, Any], ...]


@one_thread
def write_maps(
    scan: LabelledScan,
    folder: Path,
    numbers: Sequence[int] = (),
    *,
    pixel: float | None = None,
    what: Collection[str] = WHAT,
    progress: Callable[[str], None] = lambda name: None,
) -> Written:
    """Write the maps of vaults, by their 1-based numbers, or of all.

    Raises:
        NoSuchVaultError: there is no such vault.
        ExportError: a sheet would have too many pixels.
        OSError: a file cannot be written.
    """
    notes: list[str] = []
    told: list[dict[str, Any]] = []
    for number in numbers or range(1, len(scan.model.vaults) + 1):
        scan.model.check_number(number)
        progress(f"vault {number}")
        laid = lay_scan(scan, number)
        # Lines of both are drawn whatever pictures are asked for.
        chosen = [name for name in WHAT if name in {*what, *MEASURED}]
        found = raster(laid, pixel or pixel_for(laid), chosen)
        up = float(scan.model.origin[2])
        raised = {"height": up}
        lines: list[Contour] = []
        files = []
        for name in chosen:
            if name not in found.channels:
                notes.append(f"vault {number}: the scan has no {name}")
                continue
            if name in what:
                path = folder / f"vault-{number}-{name}.png"
                write_picture(found, name, path)
                files += [path.name, path.with_suffix(".pgw").name]
                if name in MEASURED:
                    write_values(found, name, path.with_suffix(".tif"), raised.get(name, 0.0))
                    files.append(path.with_suffix(".tif").name)
            if name in MEASURED:
                lines += contours(found, name, raised.get(name, 0.0))
        write_sheet(laid.sheet, lines, folder / f"vault-{number}.dxf", f"unrolled sheet of vault {number}")
        files.append(f"vault-{number}.dxf")
        told.append({"vault": number, "pixel": found.pixel, "files": files, **plain_sheet(laid.sheet)})
    whole = {"schema": SCHEMA, "about": ABOUT, "unit": "m", "sheets": told}
    (folder / UNROLLED).write_text(json.dumps(whole, indent=1) + "\n", encoding="utf-8")
    return Written(tuple(notes), tuple(told))


def plain_sheet(sheet: Sheet) -> dict[str, Any]:
    """What a sheet is made of, as plain values: body, coordinates and place of each part, and how true it is."""
    return {
        "family": sheet.vault.id,
        "bounds": [round(value, 6) for value in sheet.bounds],
        "distortion": sheet.distortion,
        "distortion_limit": MOST_DISTORTED,
        "distorted_more": sheet.beyond,
        "parts": [_plain_leaf(leaf) for leaf in sheet.leaves],
    }


def _plain_leaf(leaf: Leaf) -> dict[str, Any]:
    chart = leaf.chart
    a0, a1, b0, b1 = chart.development.box
    return {
        "component": leaf.name,
        "body": chart.region.row,
        "laid": chart.development.kind,
        "a": [a0, a1],
        "b": [b0, b1],
        "turn": degrees(leaf.placement.turn),
        "shift": list(leaf.placement.shift),
        "distortion": chart.distortion,
        "distorted_more": chart.beyond,
        "area": chart.surface,
    }
