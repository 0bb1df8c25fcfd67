"""What makes a family, and an arch: a vault that has lost it is another's, which says the same of it, and better."""

from __future__ import annotations

from collections.abc import Callable
from math import asin, degrees, sqrt
from typing import Any

from families import Dome, Elliptical, Groin, Lunette, Mirror, Stilted, Vault

PLANE = 0.1  # a mirror's plane is at least this share of the shorter span, else it is a trough
LEVEL_GROIN = 0.8  # the lower barrel of a groin vault rises to this share of the higher, else it is a row of lunettes
CROWN = 0.95  # lunettes stay below this share of their barrel's rise, else they are groin vaults in a row
CREASE = 8.0  # degrees between a dome and its pendentives at the ring, else they are one sphere: a sail
STEEP = 0.9  # rise / span above which nobody draws an ellipse or stilts an arch: the rest of it is wall
DRUM = 0.03  # and the drum / radius below which there is none


def is_its_family(vault: Vault) -> bool:
    """Whether a vault has what makes its family, and arches such as are built."""
    arches = [value for value in vars(vault).values() if isinstance(value, Elliptical | Stilted)]
    return all(arch.rise_ratio <= STEEP for arch in arches) and RULES.get(type(vault), lambda vault: True)(vault)


def _mirror(vault: Mirror) -> bool:
    """There is a plane: coves that all but meet are a trough's."""
    height = vault.rise

    def visible(run: float, radius: float) -> float:
        """Run of a cove up to the plane [m]."""
        centre = vault.cove_rise - radius
        return run - sqrt(max(0.0, radius**2 - (height - centre) ** 2))

    plane_x = vault.span_x - 2 * visible(vault.run_x, vault.radius_x)
    plane_y = vault.span_y - 2 * visible(vault.run_y, vault.radius_y)
    return min(plane_x, plane_y) >= PLANE * min(vault.span_x, vault.span_y)


def _groin(vault: Groin) -> bool:
    """Its barrels are about equally high."""
    return min(vault.rise_x, vault.rise_y) >= LEVEL_GROIN * max(vault.rise_x, vault.rise_y)


def _lunette(vault: Lunette) -> bool:
    """Its lunettes are lower than the barrel."""
    return vault.lunette_springing + vault.lunette_rise <= CROWN * vault.rise


def _dome(vault: Dome) -> bool:
    """It has a drum, or another curve than its pendentives: with neither it is a sail."""
    curve = vault.profile.curve(vault.radius)
    if vault.drum_ratio > DRUM or not curve.arcs:
        return True
    arc = curve.arcs[0]
    dome = degrees(asin(min(1.0, max(-1.0, -arc.z / arc.radius))))  # slopes at the ring, from the vertical
    pendentives = degrees(asin((vault.ring_height + vault.pendentive_ratio * vault.radius) / vault.pendentive_radius))
    return abs(dome - pendentives) > CREASE or len(curve.arcs) > 1 or abs(arc.u) > 0


RULES: dict[type[Vault], Callable[[Any], bool]] = {Mirror: _mirror, Groin: _groin, Lunette: _lunette, Dome: _dome}
