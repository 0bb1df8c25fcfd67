"""The files of sections, by their names."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from families.drawing.png import write_png
from families.drawing.svg import document
from vaultcad.export.section_drawing import section_drawing
from vaultcad.export.section_dxf import write_section_dxf
from vaultcad.export.section_json import write_section_json
from vaultcad.model import Model
from vaultcad.sections.section import Section

SECTIONS = "sections.json"
Writer = Callable[[Model, Sequence[Section], Path], None]
WRITERS: dict[str, Writer] = {
    SECTIONS: write_section_json,
    "sections.dxf": write_section_dxf,
}
PIXELS = 120.0  # of drawings, a metre
UNDER_TITLE = 0.95  # of the height of pictures
INCH = 100.0  # pixels of one, in pictures


def write_sections(model: Model, sections: Sequence[Section], folder: Path) -> None:
    """Write all files of sections and a drawing of each into a new folder."""
    folder.mkdir()
    for name, write in WRITERS.items():
        write(model, sections, folder / name)
    write_drawings(sections, folder, pictures=False)


def drawn_names(sections: Sequence[Section], suffix: str) -> list[str]:
    """Of the drawings, one a section."""
    return [f"{section.id}{suffix}" for section in sections]


def write_drawings(sections: Sequence[Section], folder: Path, *, pictures: bool) -> None:
    """Write each section as SVG, and as PNG too where pictures are wanted."""
    for section, svg, png in zip(sections, drawn_names(sections, ".svg"), drawn_names(sections, ".png"), strict=True):
        drawing = section_drawing(section)
        (folder / svg).write_text(document(drawing, PIXELS), encoding="utf-8")
        if pictures:
            size = (PIXELS * drawing.size[0] / INCH, PIXELS * drawing.size[1] / INCH)
            write_png(drawing, folder / png, size, INCH, top=UNDER_TITLE, look={})
