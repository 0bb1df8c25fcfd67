"""Whole buildings for the virtual scanner: declared, raised, settled, scanned, with the truth of every element."""

from vaultcad.scanner.building.declare import read_building
from vaultcad.scanner.building.draw import draw_building
from vaultcad.scanner.building.elements import Arch, Bay, Building, Door, Pier, Style
from vaultcad.scanner.building.place import Place
from vaultcad.scanner.building.survey import BuildingScan, scan_building, write_building

__all__ = [
    "Arch",
    "Bay",
    "Building",
    "BuildingScan",
    "Door",
    "Pier",
    "Place",
    "Style",
    "draw_building",
    "read_building",
    "scan_building",
    "write_building",
]
