"""The whole way on virtual scans of rooms: family, component IoU, deviation, time."""

from __future__ import annotations

import argparse
import time
from dataclasses import replace

import numpy as np

from families import FAMILIES
from segmentation import compare
from segmentation.cloud import Cloud
from vaultcad.errors import VaultcadError
from vaultcad.pipeline import fit_scan
from vaultcad.scanner import draw, scan

FIRST = 1000  # seed of the first room


def run(chosen: argparse.Namespace) -> None:
    """One row a room, then the confusion matrix."""
    ids = [family.id for family in FAMILIES]
    confusion = np.zeros((len(ids), len(ids) + 1), int)
    ious = []
    print(f"\nvirtual scans of rooms, {chosen.rooms} of them, {chosen.points // 4:,} points")
    print(f"{'seed':>5} {'true':8} {'found':8} {'IoU':>6} {'mm':>6} {'s':>6}")
    for k in range(chosen.rooms):
        true = FAMILIES[k % len(FAMILIES)]
        rng = np.random.default_rng(FIRST + k)
        try:
            vault, settings = draw(true, rng)
            virtual = scan(vault, replace(settings, points=chosen.points // 4), rng=rng)
        except VaultcadError as error:
            print(f"{FIRST + k:5} {true.id:8} could not be scanned: {error}")
            continue
        start = time.perf_counter()
        try:
            result = fit_scan(Cloud(virtual.xyz.astype(np.float32)))
        except VaultcadError as error:
            confusion[ids.index(true.id), -1] += 1
            print(f"{FIRST + k:5} {true.id:8} refused: {error}")
            continue
        seconds, fitted = time.perf_counter() - start, result.model.vaults[0]
        iou = compare(result.labels.component, virtual.component).mean_iou
        ious.append(iou)
        confusion[ids.index(true.id), ids.index(fitted.vault.id)] += 1
        mean = 1000 * fitted.deviation.mean
        print(f"{FIRST + k:5} {true.id:8} {fitted.vault.id:8} {iou:6.3f} {mean:6.1f} {seconds:6.1f}", flush=True)
    print(f"\nright {np.trace(confusion)} of {confusion.sum()}, mean IoU {np.mean(ious):.3f}; rows true, columns found")
    print(" " * 9 + " ".join(f"{name:>8}" for name in [*ids, "refused"]))
    for name, row in zip(ids, confusion, strict=True):
        print(f"{name:8} " + " ".join(f"{count:8}" for count in row))
