"""The first modelling route of the paper, of vaults in a scan: surfaces, sheet, nets, and how far the stone is off."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vaultcad.errors import VaultcadError
from vaultcad.labelled_scan import LabelledScan
from vaultcad.measure.deviation import summarise
from vaultcad.model import FittedVault, Model
from vaultcad.nurbs.freeform import FreeForm, free_form
from vaultcad.nurbs.net import QuadNet, nets
from vaultcad.nurbs.sheet import Sheet, sheet_of
from vaultcad.one_thread import one_thread
from vaultcad.uncertain import Deviation

NET = 0.25  # m, distance of the lines of a net, unless another is asked for


@dataclass(frozen=True, eq=False)
class FreeVault:
    """One vault: its number from 1, its surfaces, and the distances of its points to them by component id."""

    number: int
    fitted: FittedVault
    form: FreeForm
    sheet: Sheet
    nets: tuple[QuadNet, ...]
    deviation: Deviation
    components: dict[int, Deviation]


@dataclass(frozen=True, eq=False)
class FreeRoute:
    """Vaults by free surfaces. net: distance of the lines of their nets [m]. left_out: why others are missing."""

    model: Model
    net: float
    vaults: tuple[FreeVault, ...]
    left_out: tuple[str, ...] = ()


@one_thread
def free_route(scan: LabelledScan, net: float = NET, numbers: Sequence[int] = ()) -> FreeRoute:
    """Free surfaces through the vaults of a scan with these numbers, of all by default.

    Raises:
        NoSuchVaultError: there is no vault of that number.
        VaultcadError: none has free surfaces.
    """
    for number in numbers:
        scan.model.check_number(number)
    found, left_out = [], []
    for number in numbers or range(1, len(scan.model.vaults) + 1):
        try:
            found.append(_free_vault(scan, number, net))
        except ValueError as error:
            left_out.append(f"vault {number} has no free surfaces: {error}")
    if not found:
        raise VaultcadError("; ".join(left_out) or "the scan has no vault")
    return FreeRoute(scan.model, net, tuple(found), tuple(left_out))


def _free_vault(scan: LabelledScan, number: int, net: float) -> FreeVault:
    fitted = scan.model.vaults[number - 1]
    which = scan.of(number)
    xyz, component = scan.in_frame(fitted, which), scan.component[which]
    form = free_form(fitted.vault, xyz, component)
    sheet = sheet_of(form)
    if not sheet.valid:  # edges cross, where surfaces all but touch
        other = free_form(fitted.vault, xyz, component, led=True)
        if (led := sheet_of(other)).valid:
            form, sheet = other, led
    distance = form.distance(xyz, component)
    known = np.isfinite(distance)
    ids = np.unique(component[known]).tolist()
    return FreeVault(
        number,
        fitted,
        form,
        sheet,
        nets(form, net),
        summarise(distance[known]),
        {k: summarise(distance[known & (component == k)]) for k in ids},
    )
