"""A groin-vaulted bay repeated along a nave, with build123d. Writes nave.step: an assembly with names and colours.

Usage: python examples/10_nave.py [FOLDER] [--bays N]
"""

import argparse
import copy
from pathlib import Path

from build123d import Align, Box, Color, Compound, Pos, export_step

from families import Groin, Segmental

BAYS = 4
SPAN, PITCH, SPRINGING = 7.0, 5.0, 5.0  # m
THICKNESS = 0.25  # m
PIER = 700  # mm, side of a pier, with a corner of the vault over its middle
STANDING = (Align.CENTER, Align.CENTER, Align.MIN)


def main(out: Path, bays: int) -> None:
    # Wall arches along the nave are semicircles of 5 m; the arches across it rise as high over 7 m.
    vault = Groin(SPAN, PITCH, Segmental(PITCH / 2 / SPAN))
    web = vault.solid(THICKNESS)
    web.label = "bay"
    pier = Box(PIER, PIER, 1000 * SPRINGING, align=STANDING)
    pier.label, pier.color = "pier", Color("tan")

    piers = [
        Pos(side * 1000 * SPAN / 2, 1000 * PITCH * (k - 0.5), 0) * copy.copy(pier)
        for k in range(bays + 1)
        for side in (-1, 1)
    ]
    webs = [Pos(0, 1000 * PITCH * k, 1000 * SPRINGING) * copy.copy(web) for k in range(bays)]
    nave = Compound(label="nave", children=[*piers, *webs])
    export_step(nave, out / "nave.step")

    rise = vault.derived_values()
    print(f"arches across {rise['rise_x']:.3f} m, along the walls {rise['rise_y']:.3f} m, crown {rise['rise']:.3f} m")
    print(f"{bays} bays of {web.volume / 1e9:.3f} m³ each, on {2 * (bays + 1)} piers: {out / 'nave.step'}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", nargs="?", type=Path, default=Path("out"))
    parser.add_argument("--bays", type=int, default=BAYS)
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    main(given.folder, given.bays)
