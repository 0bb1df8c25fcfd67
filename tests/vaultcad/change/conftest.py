"""A room with a barrel vault, scanned before and after its walls gave, and fitted."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from families import Barrel, Semicircular
from segmentation.cloud import Cloud
from vaultcad.model import Model
from vaultcad.pipeline import FitSettings, fit_scan
from vaultcad.scanner import ScannerSettings, VirtualScan, scan

VAULT = Barrel(span=4.4, length=5.0, profile=Semicircular())
STILL = ScannerSettings(points=25_000, settlement=0.0, noise=0.002, yaw=0.3, openings=1, furniture=1, tie_rods=1)
MOVED = replace(STILL, crown_fall=0.03, spread_x=0.02)
AGAIN = replace(STILL, visit=1, points=33_000)
SUNK = replace(AGAIN, crown_fall=0.01)


def shot(settings: ScannerSettings) -> VirtualScan:
    return scan(VAULT, settings, rng=np.random.default_rng(5))


def fitted(virtual: VirtualScan, **fix: float | str) -> Model:
    settings = FitSettings(families=(Barrel,), fix=fix)
    return fit_scan(Cloud(virtual.xyz.astype(np.float32)), settings).model


@dataclass(frozen=True)
class Visits:
    """The room at first, again, and again when the crown had sunk by 1 cm; and the model of the first."""

    first: VirtualScan
    again: VirtualScan
    sunk: VirtualScan
    model: Model


@pytest.fixture(scope="session")
def visits() -> Visits:
    first = shot(STILL)
    return Visits(first, shot(AGAIN), shot(SUNK), fitted(first))


@pytest.fixture(scope="session")
def settled() -> Model:
    """The room whose crown fell by 3 cm and whose springings are 2 cm apart; kind and springing are known."""
    return fitted(shot(MOVED), profile="semicircular", springing=STILL.wall_height)
