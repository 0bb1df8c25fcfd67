"""Ribs as exact bodies [mm]: what is between their soffits and the webs over their parts of the plan."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from OCP.TopoDS import TopoDS_Shape

from families.declaration.palette import colour
from families.declaration.pieces import Piece
from families.declaration.ribs import RibPlan, Ribs, rib_plans
from families.declaration.vault import Vault
from families.solid.bodies import Void
from families.solid.body import body

if TYPE_CHECKING:
    import build123d

NUDGES = (0.0, 3e-5, -3e-5, 1e-4, -1e-4, 3e-4)  # of the width, where surfaces touch just so that no body can be built
LOOKS = np.linspace(0.02, 0.98, 13)  # shares of the way from the middle of a rib's plan to its sides
PER_SIDE = 24  # places on each of these
CLEAR = 1e-4  # [m] that a soffit is below the webs at least


@dataclass(frozen=True)
class RibBody:
    """A rib or boss and its body [mm]."""

    rib: RibPlan
    shape: TopoDS_Shape


def rib_bodies(vault: Vault, ribs: Ribs) -> tuple[RibBody, ...]:
    """The ribs of a vault, then their bosses; they touch, and none cuts another.

    Raises:
        ValueError: no rib can hang under the vault, or none of that section; says why.
    """
    if not vault.rib_lines():
        raise ValueError(f"{vault.called} like this has no lines that ribs could run along; leave the ribs out")
    failure = ValueError()
    for nudge in NUDGES:
        plans = rib_plans(vault.rib_lines(), vault.plan, replace(ribs, width=ribs.width * (1 + nudge)))
        try:
            return tuple(RibBody(rib, _body(vault, rib)) for rib in plans)
        except _VanishingError:
            raise
        except ValueError as error:
            failure = error
    raise failure


def compound(vault: Vault, ribs: Ribs) -> build123d.Compound:
    """The same as children of a compound, labelled, in the colour of stone."""
    import build123d

    stone = build123d.Color(*colour(0).unit)
    made = [build123d.Part(one.shape, label=one.rib.name, color=stone) for one in rib_bodies(vault, ribs)]
    return build123d.Compound(label=f"ribs of {vault.called}", children=made)


class _VanishingError(ValueError):
    """A rib rises above the webs."""


def _body(vault: Vault, rib: RibPlan) -> TopoDS_Shape:
    above = _above(vault, rib)
    if above > -CLEAR:
        deeper = f"{rib.name} does not stand out under the webs everywhere; ribs must be deeper or less wide"
        raise _VanishingError(f"{deeper}, or leave the {rib.kind}s out")
    try:
        return body(Void(vault.pieces(), rib.plan), Void((Piece((rib.soffit,)),), rib.plan))
    except ValueError as error:
        found = f"no exact body of {rib.name} can be built under this vault"
        raise ValueError(f"{found}; leave the {rib.kind}s out, or give ribs of another section") from error


def _above(vault: Vault, rib: RibPlan) -> float:
    """How far the soffit is above the webs where it is highest against them [m]."""
    outline = np.concatenate([side.points(PER_SIDE)[:-1] for side in rib.plan.sides])
    middle = outline.mean(axis=0)
    places = np.concatenate([middle + share * (outline - middle) for share in LOOKS])
    heights = np.array([rib.height(x, y) for x, y in places.tolist()])
    hangs = heights > CLEAR
    return float(vault.distance(np.column_stack([places, heights])[hangs]).max(initial=-np.inf))
