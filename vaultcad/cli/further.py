"""What a fit writes besides its usual files, where it is asked for."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from segmentation.cloud import Cloud
    from vaultcad.drawings.sheet import Sheet
    from vaultcad.labelled_scan import LabelledScan
    from vaultcad.model import Model
    from vaultcad.nurbs.route import FreeRoute
    from vaultcad.pipeline import Result
    from vaultcad.sections.section import Section

COLOURED = "deviation"  # and a suffix
SECTIONS, UNROLLED = "sections", "unrolled"  # folders
Writer = Callable[[Path], None]


class Asked(NamedTuple):
    """Writers by the names of what they write; `sheets` are given the model as drawn; the free surfaces, if any."""

    more: dict[str, Writer]
    sheets: dict[str, Callable[[Model, Path], None]]
    surfaces: FreeRoute | None


@dataclass(frozen=True)
class Further:
    """What is asked for."""

    net: float | None  # m, of free surfaces
    sections: bool
    unrolled: bool
    drawings: bool
    coloured: str | None  # the format of a cloud

    @property
    def names(self) -> tuple[str, ...]:
        """Of the files and folders."""
        names: list[str] = []
        if self.net is not None:
            from vaultcad.export.nurbs_files import NURBS_WRITERS

            names += NURBS_WRITERS
        if self.sections:
            names.append(SECTIONS)
        if self.unrolled:
            names.append(UNROLLED)
        if self.drawings:
            from vaultcad.drawings.bundle import CAD, PAGES

            names += [CAD, PAGES]
        return (*names, *(() if self.coloured is None else (f"{COLOURED}.{self.coloured}",)))

    def asked(self, result: Result, cloud: Cloud, stage: Callable[[str, str], None]) -> Asked:
        """What is to be written of a result."""
        from vaultcad.labelled_scan import labelled_scan

        scan = labelled_scan(result.model, cloud, result.labels)
        asked = Asked({}, self._sheets(scan), None)
        if self.net is not None:
            from vaultcad.export.nurbs_files import NURBS_WRITERS
            from vaultcad.nurbs.route import free_route

            stage("measuring", "free surfaces")
            asked = asked._replace(surfaces=(surfaces := free_route(scan, self.net)))
            asked.more.update((name, partial(write, surfaces)) for name, write in NURBS_WRITERS.items())
        if self.unrolled:
            asked.more[UNROLLED] = partial(_write_maps, scan)
        if self.coloured is not None:
            from vaultcad.export.coloured_cloud import write_coloured

            asked.more[f"{COLOURED}.{self.coloured}"] = partial(write_coloured, cloud, result.labels)
        return asked

    def _sheets(self, scan: LabelledScan) -> dict[str, Callable[[Model, Path], None]]:
        """Sections and sheets, which share the cuts."""
        sheets: dict[str, Callable[[Model, Path], None]] = {}

        @cache
        def cuts() -> tuple[Section, ...]:
            from vaultcad.sections.cuts import sections

            return tuple(sections(scan))

        if self.sections:
            from vaultcad.export.section_files import write_sections

            sheets[SECTIONS] = lambda drawn, path: write_sections(drawn, cuts(), path)
        if self.drawings:
            from vaultcad.drawings import bundle
            from vaultcad.drawings.cad import write_dxf
            from vaultcad.drawings.paper import write_pdf

            made: list[Sheet] = []

            def all_of(drawn: Model) -> Sequence[Sheet]:
                if not made:
                    made.extend(bundle.sheets(drawn, sections=cuts()))
                return made

            sheets[bundle.CAD] = lambda drawn, path: write_dxf(all_of(drawn), path, drawn.place)
            sheets[bundle.PAGES] = lambda drawn, path: write_pdf(all_of(drawn), path)
        return sheets


def _write_maps(scan: LabelledScan, folder: Path) -> None:
    """Of all that the scan has: that it is without colour is no news."""
    from vaultcad.unrolled.maps import write_maps

    folder.mkdir()
    write_maps(scan, folder)
