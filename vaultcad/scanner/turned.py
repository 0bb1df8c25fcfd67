"""The truth of a virtual scan in the words of a fit that stands turned against it."""

from __future__ import annotations

from math import pi

from families import Dome, Groin, Mirror, Sail, Trough, Vault

ALIKE_TURNED = (Sail, Groin, Mirror)  # a quarter turn changes their x and y
ROUND = (Dome,)  # and nothing in these


def quarters(yaw: float, true_yaw: float) -> int:
    """How often a fit is turned by about a right angle against the truth, 0 to 3; yaws in radians."""
    return round((yaw - true_yaw) / (pi / 2)) % 4


def turned(vault: Vault, quarter: int) -> tuple[dict[str, float], dict[str, str]] | None:
    """Sizes and ids of the profiles, by name, of a vault whose x axis is turned by so many right angles.

    None if no vault of the family is the same turned like that.
    """
    sizes = {**vault.values(), **vault.derived_values()}
    profiles = vault.kinds
    if quarter % 2 and not isinstance(vault, ALIKE_TURNED + ROUND):
        return None
    if quarter % 2 and isinstance(vault, ALIKE_TURNED):
        sizes = {_exchanged(k, "x", "y"): v for k, v in sizes.items()}
        profiles = {_exchanged(k, "x", "y"): v for k, v in profiles.items()}
    if quarter == 2:
        if isinstance(vault, Trough):
            sizes = {_exchanged(k, "south", "north"): v for k, v in sizes.items()}
        sizes |= {name: -sizes[name] for name in ("shift_ratio", "shift") if name in sizes}
    return sizes, profiles


def _exchanged(name: str, one: str, other: str) -> str:
    """A name with one of its words replaced by the other: rise_ratio_x and rise_ratio_y."""
    pair = {one: other, other: one}
    return "_".join(pair.get(word, word) for word in name.split("_"))
