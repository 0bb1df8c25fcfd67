"""One colour a component, the same in every file that shows it."""

from __future__ import annotations

from dataclasses import dataclass

# Muted, told apart by the colour-blind, readable on white and on black (after Paul Tol, "Colour schemes", 2021).
COMPONENTS = (
    (204, 102, 119),
    (68, 119, 170),
    (221, 204, 119),
    (68, 170, 153),
    (170, 68, 153),
    (153, 153, 51),
    (136, 204, 238),
    (238, 136, 102),
    (17, 119, 51),
    (187, 187, 187),
    (136, 34, 85),
    (102, 102, 204),
)
STONE = (200, 190, 175)  # extrados, cuts and whatever belongs to no component


@dataclass(frozen=True)
class Colour:
    """An sRGB colour, 8 bits a channel."""

    red: int
    green: int
    blue: int

    @property
    def hex(self) -> str:
        """As CSS writes it."""
        return f"#{self.red:02x}{self.green:02x}{self.blue:02x}"

    @property
    def unit(self) -> tuple[float, float, float]:
        """Channels from 0 to 1."""
        return self.red / 255, self.green / 255, self.blue / 255


def colour(component: int) -> Colour:
    """The colour of a component's id; 0 is stone. There are twelve, then they come again."""
    return Colour(*(COMPONENTS[(component - 1) % len(COMPONENTS)] if component else STONE))
