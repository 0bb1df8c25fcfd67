"""The piers and columns under the arches and vaults of a scan, with how sure they are."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from vaultcad.fit.section import INDEPENDENT, Section, section_of
from vaultcad.measure.deviation import summarise
from vaultcad.model import FittedArch, FittedPier, FittedVault
from vaultcad.pose import Pose
from vaultcad.survey.piers import Shaft, shafts_under
from vaultcad.survey.thinned_scan import Thin
from vaultcad.uncertain import Covariance, Estimate

Array = NDArray[np.float64]

SAME, STOREY = 0.3, 1.0  # m in plan between two that are one pier, and between their feet
LEVEL, SURE = 0.1, 2.0  # m between springings on one capital, and standard deviations
LEAST = 1e-3  # m, by which a springing is unsure
MEANING = {
    "diameter": "of the shaft",
    "width": "of the shaft, along its x",
    "depth": "of the shaft, along its y",
    "height": "from the floor to the springing",
}


def piers_under(vaults: Sequence[FittedVault], arches: Sequence[FittedArch], thin: Thin) -> tuple[FittedPier, ...]:
    """What stands free under the ends of arches and the corners of vaults, the lowest springing first.

    Half piers along a wall are the wall's. thin: the scan, in the frame of vaults and arches.
    """
    places, stds = _supports(vaults, arches)
    piers: list[FittedPier] = []
    for shaft in sorted(shafts_under(places, thin), key=lambda shaft: float(places[shaft.supports, 2].min())):
        section = section_of(shaft.points[:, :2], shaft.normals[:, :2])
        if section is not None:
            pier = _fitted(section, shaft, places[shaft.supports, 2], stds[shaft.supports])
            if not any(_same(pier.pose, other.pose) for other in piers):
                piers.append(pier)
    return tuple(piers)


def _same(one: Pose, other: Pose) -> bool:
    return float(np.hypot(one.x - other.x, one.y - other.y)) < SAME and abs(one.z - other.z) < STOREY


def _supports(vaults: Sequence[FittedVault], arches: Sequence[FittedArch]) -> tuple[Array, Array]:
    """(s, 3) where arches and vaults spring [m], and how unsure those heights are (s,) [m]."""

    def ends() -> Iterator[tuple[FittedVault, Array]]:
        for arch in arches:
            yield arch, np.outer([-1, 1], [arch.vault.plan.half[0], 0.0])
        for vault in vaults:
            yield vault, vault.vault.corners

    places, stds = [np.empty((0, 3))], [np.empty(0)]
    for fitted, corners in ends():
        local = np.column_stack([corners, np.zeros(len(corners)), np.ones(len(corners))])
        places.append(local @ fitted.pose.placement()[:3].T)
        std = 0.0 if fitted.covariance is None else fitted.covariance.stds()["z"]
        stds.append(np.full(len(corners), std))
    return np.concatenate(places), np.concatenate(stds)


def _fitted(section: Section, shaft: Shaft, springings: Array, stds: Array) -> FittedPier:
    lowest = springings[(springings + SURE * stds).argmin()]  # no guess tells
    capital = np.abs(springings - lowest) < LEVEL + SURE * stds
    weight = 1 / np.maximum(stds[capital], LEAST) ** 2
    weight /= weight.sum()
    top = float(weight @ springings[capital])
    # What one of them misses, its neighbours miss too: their mean is no surer than the surest.
    above = float(stds[capital].min() ** 2 + weight @ (springings[capital] - top) ** 2)
    foot, below = float(shaft.floor.mean()), float(shaft.floor.var() / INDEPENDENT)

    names = ("x", "y", "z", "yaw", *section.names[2 + ("yaw" in section.names) :], "height")
    own, at = [names.index(name) for name in section.names], (names.index("z"), names.index("height"))
    matrix = np.zeros((len(names), len(names)))
    matrix[np.ix_(own, own)] = section.covariance
    matrix[np.ix_(at, at)] = [[below, -below], [-below, below + above]]
    covariance = Covariance(names, matrix)

    values = dict(zip(section.names, section.values.tolist(), strict=True)) | {"height": top - foot}
    known = covariance.stds()
    return FittedPier(
        plan=section.plan,
        pose=Pose(values["x"], values["y"], foot, values.get("yaw", 0.0)),
        parameters={name: Estimate(values[name], "m", known[name], MEANING[name]) for name in names[4:]},
        points=int(shaft.counts.sum()),
        deviation=summarise(section.residuals),
        covariance=covariance,
    )
