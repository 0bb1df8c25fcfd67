"""In which coordinates places go back to whoever scanned: those of the scan's file, or metres with z up."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from segmentation.cloud import Up, turn_back
from segmentation.units import unit_of
from vaultcad.model import Model

Array = NDArray[np.float64]
Coordinates = Literal["file", "metres"]
"""`file`: as CloudCompare has the scan, with its axes and its unit. `metres`: turned z up, in metres."""


def placed(model: Model, xyz: Array, coordinates: Coordinates) -> Array:
    """Points (n, 3) [m] with z up, the model's origin added to them, in those coordinates."""
    if coordinates == "metres":
        return xyz
    up, scale = _file(model)
    turned: Array = turn_back(xyz, up) / scale
    return turned


def says(model: Model, coordinates: Coordinates) -> str:
    """In words which they are."""
    if coordinates == "metres":
        return "metres, z up"
    up, scale = _file(model)
    units = list(dict.fromkeys(unit_of(float(unit)) or f"units of {unit:g} m" for unit in scale))
    return f"those of {model.scan.name}: {', '.join(units)}, {up} up"


def _file(model: Model) -> tuple[Up, Array]:
    """The axis of the scan's file that is up, and its unit along each of its axes [m]."""
    up: Up = model.settings.get("up", "z")
    return up, np.array(model.settings.get("scale", [model.unit] * 3), np.float64)
