"""An account of what hangs over the rooms of a scan: how much of it is what, every square metre."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from segmentation.notes import Note
from vaultcad.fit.label import ArchBand, label
from vaultcad.fit.solve import Placed
from vaultcad.survey.parting import LEVEL_NORMAL
from vaultcad.survey.patches import Patches

Array = NDArray[np.float64]

SMALL = 1.0  # m², of a patch, below which it is clutter
LEVEL = 0.7  # share of a patch that is level, from which on it is flat
KINDS = ("vault", "arch", "flat", "clutter", "unexplained")
BENT = 0.15  # share of what is bent and no clutter that may be unexplained without a word
CELL = 1.0  # m, of the plan, in which the most of it is looked for


def account(
    hung: Patches, vaults: Sequence[tuple[Placed, float]], arches: Sequence[ArchBand]
) -> tuple[dict[str, float], Array]:
    """Areas [m²] of what hangs, `area` in all and those of `KINDS`, which add up to it.

    Also the places (n, 2) of what is unexplained [m]. What no vault or arch explains is clutter where its patch is
    small, and flat where most of its patch is level.

    Args:
        hung: the patches over rooms.
        vaults: each with its tolerance [m].
        arches: where their points lie.
    """
    labels = label(hung.points, vaults, arches)
    sizes = np.bincount(hung.patch, minlength=hung.count)
    level = np.bincount(hung.patch, np.abs(hung.normals[:, 2]) > LEVEL_NORMAL, hung.count) > LEVEL * sizes
    kind = np.select(
        [labels.vault > 0, labels.arch > 0, (hung.areas < SMALL)[hung.patch], level[hung.patch]],
        [KINDS.index(name) for name in ("vault", "arch", "clutter", "flat")],
        KINDS.index("unexplained"),
    )
    areas = np.bincount(kind, minlength=len(KINDS)) * hung.spacing**2
    told = dict(zip(KINDS, areas.tolist(), strict=True))
    return {"area": float(areas.sum()), **told}, hung.points[kind == KINDS.index("unexplained"), :2]


def missed(ceiling: Mapping[str, float], places: Array) -> Iterator[Note]:
    """What is to be said of a ceiling if much of it is bent and unexplained, at places (n, 2) of the scan [m]."""
    lost = ceiling["unexplained"]
    if lost <= BENT * (ceiling["vault"] + ceiling["arch"] + lost):
        return
    _, where, counts = np.unique(np.floor(places / CELL), axis=0, return_inverse=True, return_counts=True)
    x, y = np.median(places[where.ravel() == counts.argmax()], axis=0).tolist()
    text = f"{lost:.0f} m² over rooms are bent and no vault was found there, most of them about ({x:.1f}, {y:.1f}): "
    yield Note("ceiling", text + "look at them, or scan all of their bays")
