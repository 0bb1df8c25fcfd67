"""The first modelling route of the paper, of vaults in a scan: surfaces, sheet, nets, and how far the stone is off."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vaultcad.errors import NoSurfaceError, VaultcadError
from vaultcad.labelled_scan import LabelledScan
from vaultcad.measure.chessboard import on_black
from vaultcad.measure.deviation import summarise
from vaultcad.model import FittedVault, Model
from vaultcad.nurbs.freeform import FreeForm, free_form
from vaultcad.nurbs.net import QuadNet, nets
from vaultcad.nurbs.sheet import Sheet, sheet_of
from vaultcad.one_thread import one_thread
from vaultcad.uncertain import Deviation

NET = 0.25  # m, distance of the lines of a net, unless another is asked for
MOST_POINTS = 300_000  # of a vault that make its surfaces, evenly over the scan; a cell of them has its fill of fewer


@dataclass(frozen=True, eq=False)
class Off:
    """How far points are from surfaces: all of them, and those of each component by its id."""

    whole: Deviation
    components: dict[int, Deviation]


@dataclass(frozen=True, eq=False)
class FreeVault:
    """One vault: its number from 1, its surfaces, and how far its points are from them.

    through: of the points that the surfaces run through. withheld: of every other square of them, from surfaces through
    the rest alone; None where too few points are left for these.
    """

    number: int
    fitted: FittedVault
    form: FreeForm
    sheet: Sheet
    nets: tuple[QuadNet, ...]
    through: Off
    withheld: Off | None

    @property
    def measured(self) -> FittedVault:
        """The vault as it was fitted, with what withheld points say of its free surfaces."""
        if self.withheld is None:
            return self.fitted
        told = self.withheld.components
        components = tuple(replace(one, nurbs=told.get(one.id)) for one in self.fitted.components)
        return replace(self.fitted, nurbs=self.withheld.whole, components=components)


@dataclass(frozen=True, eq=False)
class FreeRoute:
    """Vaults by free surfaces. net: distance of the lines of their nets [m]. left_out: why others are missing."""

    model: Model
    net: float
    vaults: tuple[FreeVault, ...]
    left_out: tuple[str, ...] = ()

    @property
    def measured(self) -> Model:
        """The model with what withheld points say of the free surfaces of its vaults."""
        vaults = list(self.model.vaults)
        for one in self.vaults:
            vaults[one.number - 1] = one.measured
        return replace(self.model, vaults=tuple(vaults))


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
        except NoSurfaceError as error:
            left_out.append(f"vault {number} has no free surfaces: {error}")
    if not found:
        raise VaultcadError("; ".join(left_out) or "the scan has no vault")
    return FreeRoute(scan.model, net, tuple(found), tuple(left_out))


def _free_vault(scan: LabelledScan, number: int, net: float) -> FreeVault:
    fitted, which = scan.model.vaults[number - 1], scan.of(number)
    which = which[:: -(-len(which) // MOST_POINTS) or 1]
    xyz, component = scan.in_frame(fitted, which), scan.component[which]
    form = free_form(fitted.vault, xyz, component)
    sheet = sheet_of(form)
    if not sheet.valid:  # edges cross, where surfaces all but touch
        other = free_form(fitted.vault, xyz, component, led=True)
        if (led := sheet_of(other)).valid:
            form, sheet = other, led
    return FreeVault(
        number, fitted, form, sheet, nets(form, net), _off(form, xyz, component), _withheld(form, xyz, component)
    )


def _off(form: FreeForm, xyz: NDArray[np.float64], component: NDArray[np.uint16]) -> Off:
    distance = form.distance(xyz, component)
    known = np.isfinite(distance)
    ids = np.unique(component[known]).tolist()
    parts = {k: summarise(distance[known & (component == k)]) for k in ids}
    return Off(summarise(distance[known]), parts)


def _withheld(form: FreeForm, xyz: NDArray[np.float64], component: NDArray[np.uint16]) -> Off | None:
    """How far the points on the white squares are from surfaces through those on the black ones."""
    black = on_black(xyz)
    try:
        other = free_form(form.vault, xyz[black], component[black], led=form.led)
    except NoSurfaceError:
        return None
    return None if black.all() else _off(other, xyz[~black], component[~black])
