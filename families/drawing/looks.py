"""How drawings look, whatever writes them."""

from __future__ import annotations

from dataclasses import dataclass

SLAB = 0.03  # [m] to either side of a section from which points are shown
MOST_DOTS = 4000  # of a section
CLOSER = 0.6  # of the way from the middle to the wall: where a section is cut a second time
MARGIN = 0.2  # around what is drawn, for dimensions, in parts of its larger side
CLEAR = 0.3  # of the margin, in which points are still shown
OUTSIDE = 0.6  # of the margin: how far outside dimensions are
LETTER = 0.27  # of the margin: the height of letters where they grow with the drawing
TITLE_WIDTH = 70  # letters of a line of the title, in pictures
INK, PAPER = "#222222", "#ffffff"  # in pictures; pages have an ink of their own
HALO = 3.0  # [pt] of paper around letters that stand over something


@dataclass(frozen=True)
class Look:
    """Of lines, dots or letters: width or diameter [pt], opacity of the ink, dashes [pt]; within lines, of the fill."""

    width: float = 0.0
    ink: float = 1.0
    dashes: tuple[float, ...] = ()
    fill: float = 0.0
    bold: bool = False
    halo: bool = False


LOOKS = {
    "stone": Look(0.6, fill=0.5),  # cut, or seen from above
    "closer": Look(0.6, ink=0.5),  # cut nearer to the wall
    "intrados": Look(2.2),  # the room's outline, in the components' colours
    "surface": Look(0.8),  # lines on the intrados, in the components' colours
    "edge": Look(0.8),  # between components
    "unseen": Look(fill=1.0),
    "cutting": Look(0.7, ink=0.7, dashes=(10, 3, 2, 3)),
    "projected": Look(0.6, ink=0.8, dashes=(5, 3)),  # overhead, seen in a plan
    "arrow": Look(0.6, ink=0.8),
    "springing": Look(0.6, ink=0.7, dashes=(6, 3)),
    "dimension": Look(0.6, ink=0.7),
    "scan": Look(1.2),  # points at the cut, or of components
    "scan-closer": Look(1.0, ink=0.5),  # at the second cut, or on walls
    "deviation": Look(2.2),  # points moved away by their enlarged deviations
    "letter": Look(bold=True),
    "size": Look(),
    "label": Look(bold=True, halo=True),  # over what is drawn
}
