"""Several vaults in one scan are each found; one vault is not cut up."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from families import FAMILIES, Barrel, Groin, Lunette, Sail, Segmental, Semicircular
from segmentation import compare
from segmentation.cloud import Cloud
from vaultcad.find.findings import find_vaults
from vaultcad.fit.label import Labels, label
from vaultcad.fit.solve import Placed
from vaultcad.pipeline import fit_scan
from vaultcad.scanner import Bay, ScannerSettings, SceneScan, row, scan_bays
from vaultcad.survey.bays import CeilingGrid
from vaultcad.survey.thinned_scan import thin_scan

ROOMS = ScannerSettings(points=80_000, openings=1, furniture=1)
PIERS = replace(ROOMS, walls="piers", openings=0)
CROSS = Groin(4.5, 4.5, Semicircular(), Semicircular())
AISLE, NAVE = Sail(2.8, 4.5, 0.7), replace(CROSS, span_x=5.0, profile_x=Segmental(0.45))

SCENES: dict[str, tuple[Bay, ...]] = {
    "a nave of three bays": row([CROSS, CROSS, CROSS], PIERS),
    "three rooms": row(
        [Barrel(4, 5, Semicircular()), Groin(5, 5, Segmental(0.35), Segmental(0.35)), Sail(4, 5, 0.6)], ROOMS
    ),
    "a nave with its aisles": tuple(
        replace(bay, settings=replace(PIERS, wall_height=4.2)) if bay.vault is NAVE else bay
        for bay in row([AISLE, NAVE, AISLE], PIERS)
    ),
}


@cache
def scanned(bays: tuple[Bay, ...]) -> SceneScan:
    return scan_bays(bays, yaw=0.4, rng=np.random.default_rng(5))


def found_in(scene: SceneScan) -> tuple[list[Placed], Labels]:
    """The vaults of a scene, and the labels of its points."""
    xyz = scene.xyz.astype(np.float32)
    found = find_vaults(thin_scan(Cloud(xyz)), xyz, FAMILIES, np.random.default_rng(0))
    bands = [(one.placed, one.tolerance) for one in found.vaults]
    arched = [one.band(one.faces(found.arches)) for one in found.arches]
    return [placed for placed, _ in bands], label(xyz, bands, arched)


@pytest.mark.parametrize("name", SCENES)
def test_every_bay_is_found_with_its_family_its_size_and_its_points(name: str) -> None:
    bays, scene = SCENES[name], scanned(SCENES[name])
    vaults, labels = found_in(scene)
    assert len(vaults) == len(bays)
    assert set(np.unique(labels.vault)) == set(range(len(bays) + 1))
    for k, (bay, truth) in enumerate(zip(bays, scene.truths, strict=True), 1):
        # The number of a vault is told by where it stands.
        places = [
            np.hypot(f.pose.x - truth["pose"]["origin"][0], f.pose.y - truth["pose"]["origin"][1]) for f in vaults
        ]
        number = int(np.argmin(places)) + 1
        found = vaults[number - 1]
        assert places[number - 1] < 0.1
        assert found.vault.id == bay.vault.id
        spans = sorted(2 * half for half in (found.vault.plan.half_x, found.vault.plan.half_y))
        assert spans == pytest.approx(
            sorted(2 * half for half in (bay.vault.plan.half_x, bay.vault.plan.half_y)), abs=0.1
        )
        mine = (scene.bay == k) | (labels.vault == number)
        found_labels = np.where(labels.vault == number, labels.component, 0)[mine]
        assert compare(found_labels, np.where(scene.bay == k, scene.component, 0)[mine]).mean_iou > 0.9


def test_lunettes_do_not_cut_up_their_barrel() -> None:
    vault = Lunette(5, 9, Semicircular(), 3, 1.0, 0.0, 0.8, 0.3, Semicircular())
    ((found,), _) = found_in(scanned(row([vault], ROOMS)))
    assert isinstance(found.vault, Lunette)
    assert found.vault.count == 3


def test_a_bay_seen_through_arches_is_found_between_far_walls() -> None:
    from vaultcad.scanner import scan

    virtual = scan(Sail(4.0, 4.5, 0.6), PIERS, rng=np.random.default_rng(2))
    (found,) = fit_scan(Cloud(virtual.xyz.astype(np.float32))).model.vaults
    assert found.vault.id == "sail"
    assert sorted([found.vault.plan.half_x, found.vault.plan.half_y]) == pytest.approx([2.0, 2.25], abs=0.05)


def test_the_ceiling_falls_apart_at_walls_and_valleys() -> None:
    scene = scanned(SCENES["three rooms"])
    ceiling = CeilingGrid.of(thin_scan(Cloud(scene.xyz.astype(np.float32))))
    parts = ceiling.parts(ceiling.room)
    assert len(parts) == 3
    nave = scanned(SCENES["a nave of three bays"])
    ceiling = CeilingGrid.of(thin_scan(Cloud(nave.xyz.astype(np.float32))))
    assert [part.high[0] - part.low[0] for part in ceiling.parts(ceiling.room)] == pytest.approx([4.95] * 3, abs=0.5)


@pytest.mark.parametrize("seed", [0, 2])
def test_the_heads_of_doors_are_no_ceiling(seed: int) -> None:
    rooms = row([Groin(4, 4), Groin(4, 4)], ScannerSettings(points=60_000))
    scene = scan_bays(rooms, rng=np.random.default_rng(seed))
    ceiling = CeilingGrid.of(thin_scan(Cloud(scene.xyz.astype(np.float32))))
    parts = ceiling.parts(ceiling.room)
    assert len(parts) == 2
    for part in parts:
        assert len(ceiling.parts(part)) == 1
