"""What two scans say of a change, in a sentence or two."""

from __future__ import annotations

import numpy as np

from vaultcad.change.two_dates import ScanChange, VaultChange
from vaultcad.deformation import Movement


def in_words(change: ScanChange) -> list[str]:
    """A line a vault."""
    several = len(change.vaults) > 1
    return [(f"vault {one.number}: " if several else "") + _of_vault(one) for one in change.vaults]


def _of_vault(one: VaultChange) -> str:
    cells = one.cells
    if len(cells.change) == 0:
        return "it is not in both scans."
    if not one.changed:
        return f"no change larger than {1000 * cells.detectable:.1f} mm."
    where = int(np.argmax(np.where(cells.changed, np.abs(cells.change), 0)))
    most, std = 1000 * float(cells.change[where]), 1000 * float(cells.std[where])
    share, way = float(cells.changed.mean()), "into the stone" if most > 0 else "into the room"
    parts = [f"{share:.0%} of it changed, at most by {abs(most):.1f} ± {1.96 * std:.1f} mm {way}"]
    parts += [_figure(m) for m in one.movements if m.certain and m.name in ("crown settlement",)]
    parts += [_figure(m) for m in one.movements if m.certain and m.name.startswith("spread along")]
    return "; ".join(parts) + "."


def _figure(one: Movement) -> str:
    size = f"{1000 * abs(one.value):.1f} ± {1000 * one.limit:.1f} mm"
    if one.name == "crown settlement":
        return f"the crown went {one.direction} by {size}"
    return f"the springings moved {one.direction} {one.name.removeprefix('spread ')} by {size}"
