"""What a fit writes besides its usual files, where it is asked for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from segmentation.cloud import Cloud
    from vaultcad.nurbs.route import FreeRoute
    from vaultcad.pipeline import Result

COLOURED = "deviation"  # and a suffix
Writer = Callable[[Path], None]


@dataclass(frozen=True)
class Further:
    """Free surfaces with nets of so many metres, or none; sheets to scale; a cloud in colours of a format, or none."""

    net: float | None
    drawings: bool
    coloured: str | None

    @property
    def names(self) -> tuple[str, ...]:
        """Of the files."""
        names: list[str] = []
        if self.net is not None:
            from vaultcad.export.nurbs_files import NURBS_WRITERS

            names += NURBS_WRITERS
        if self.drawings:
            from vaultcad.drawings.bundle import CAD, PAGES

            names += [CAD, PAGES]
        return (*names, *(() if self.coloured is None else (f"{COLOURED}.{self.coloured}",)))

    def writers(
        self, result: Result, cloud: Cloud, stage: Callable[[str, str], None]
    ) -> tuple[dict[str, Writer], FreeRoute | None]:
        """By the names, and the free surfaces."""
        from vaultcad.labelled_scan import labelled_scan

        told: dict[str, Writer] = {}
        surfaces: FreeRoute | None = None
        scan = labelled_scan(result.model, cloud, result.labels)
        if self.net is not None:
            from vaultcad.export.nurbs_files import NURBS_WRITERS
            from vaultcad.nurbs.route import free_route

            stage("measuring", "free surfaces")
            surfaces = free_route(scan, self.net)
            told |= {name: partial(write, surfaces) for name, write in NURBS_WRITERS.items()}
        if self.drawings:
            from vaultcad.drawings.bundle import CAD, PAGES, sheets
            from vaultcad.drawings.cad import write_dxf
            from vaultcad.drawings.paper import write_pdf
            from vaultcad.export.buildable import buildable
            from vaultcad.sections.cuts import sections

            stage("measuring", "sections")
            made = sheets(buildable(result.model), sections=sections(scan))
            told |= {CAD: lambda path: write_dxf(made, path, result.model.place), PAGES: partial(write_pdf, made)}
        if self.coloured is not None:
            from vaultcad.export.coloured_cloud import write_coloured

            told[f"{COLOURED}.{self.coloured}"] = partial(write_coloured, cloud, result.labels)
        return told, surfaces
