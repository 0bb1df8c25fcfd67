"""The layers of sheets: what each holds, and how it looks in CAD and on paper."""

from __future__ import annotations

from dataclasses import dataclass

from families.drawing.deviation_colours import STOPS
from vaultcad.dxf_document import Layer


@dataclass(frozen=True)
class Ink:
    """A layer in CAD, its colour on paper, and its dashes there [mm]."""

    layer: Layer
    colour: str
    dashes: tuple[float, ...] = ()

    @property
    def width(self) -> float:
        """Of its lines [mm]."""
        return self.layer.weight / 100


DASHES = (2.4, 1.2)
DASH_DOTS = (7.0, 1.2, 0.4, 1.2)

INKS: dict[str, Ink] = {
    "STONE": Ink(Layer(7, "CONTINUOUS", 35), "#111111"),  # cut masonry
    "HATCH": Ink(Layer(8, "CONTINUOUS", 9), "#666666"),
    "INTRADOS": Ink(Layer(5, "CONTINUOUS", 50), "#1b4f8f"),  # of the ideal vault
    "BEYOND": Ink(Layer(8, "CONTINUOUS", 18), "#555555"),  # what is seen behind a section
    "AS-BUILT": Ink(Layer(6, "CONTINUOUS", 25), "#a8326e"),  # the same, as the stone stands
    "SCAN": Ink(Layer(3, "CONTINUOUS", 18), "#2f7d4f"),  # the profile of the points
    "OUTLINE": Ink(Layer(7, "CONTINUOUS", 50), "#111111"),  # of vaults in plan
    "ARCHES": Ink(Layer(4, "CONTINUOUS", 25), "#2b6f77"),
    "PIERS": Ink(Layer(7, "CONTINUOUS", 35), "#111111"),
    "GROINS": Ink(Layer(8, "DASHED", 18), "#444444", DASHES),  # overhead: where components meet
    "CONTOURS": Ink(Layer(30, "CONTINUOUS", 9), "#b3763a"),  # of equal height of the intrados
    "INTO-STONE": Ink(Layer(1, "CONTINUOUS", 13), STOPS[-1][1].hex),  # lines of one deviation on the unrolled intrados
    "INTO-ROOM": Ink(Layer(5, "CONTINUOUS", 13), STOPS[0][1].hex),
    "CUTTING": Ink(Layer(1, "DASHDOT", 25), "#9c2f2f", DASH_DOTS),  # where sections are
    "SPRINGING": Ink(Layer(8, "DASHDOT", 13), "#444444", DASH_DOTS),  # and other levels
    "CENTRES": Ink(Layer(4, "CONTINUOUS", 13), "#2b6f77"),  # of arcs, with their radii
    "DIMENSIONS": Ink(Layer(7, "CONTINUOUS", 13), "#333333"),
    "ARROWS": Ink(Layer(8, "CONTINUOUS", 18), "#444444"),  # the way a barrel spans, or up a ramp
    "TEXT": Ink(Layer(7, "CONTINUOUS", 18), "#111111"),
    "FRAME": Ink(Layer(7, "CONTINUOUS", 35), "#111111"),  # of the sheet, its title block, the scale bar
}
