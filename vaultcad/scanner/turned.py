"""The truth of a virtual scan in the words of a fit that stands turned against it."""

from __future__ import annotations

from math import pi

from families import Vault


def quarters(yaw: float, true_yaw: float) -> int:
    """How often a fit is turned by about a right angle against the truth, 0 to 3; yaws in radians."""
    return round((yaw - true_yaw) / (pi / 2)) % 4


def turned(vault: Vault, quarter: int) -> tuple[dict[str, float], dict[str, str]] | None:
    """Sizes and ids of the profiles, by name, of a vault whose x axis is turned by so many right angles.

    None if no vault of the family is the same turned like that.
    """
    sizes, kinds = {**vault.values(), **vault.derived_values()}, vault.kinds
    for turn in [vault.quarter_turn] * (quarter % 2) + [vault.half_turn] * (quarter // 2):
        if turn is None:
            return None
        sizes, kinds = turn.sizes(sizes), turn.names(kinds)
    return sizes, kinds
