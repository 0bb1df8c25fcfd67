"""A room cut out of a block of stone by a vault, with build123d. Writes room.step and intrados.step, in millimetres.

Usage: python examples/09_room_under_a_vault.py [FOLDER]
"""

import sys
from pathlib import Path

from build123d import Align, Box, Pos, export_step

from families import ideal

WALL, SPRINGING, TOP = 600, 2800, 400  # mm: walls, springing above the floor, stone above the crown
STANDING = (Align.CENTER, Align.CENTER, Align.MIN)


def main(out: Path) -> None:
    # Families are made in metres; their bodies are in millimetres, as CAD has them.
    vault = ideal("volta a specchio", span_x=6, span_y=4.5, run_x=1.2, run_y=1.2, cove_rise=1.2)
    print(vault)
    wide, deep, rise = 6000, 4500, 1000 * vault.derived_values()["rise"]

    block = Box(wide + 2 * WALL, deep + 2 * WALL, SPRINGING + rise + TOP, align=STANDING)
    walls = Box(wide, deep, SPRINGING, align=STANDING)
    door = Pos(0, -deep / 2 - WALL / 2, 0) * Box(1200, WALL, 2200, align=STANDING)
    window = Pos(wide / 2 + WALL / 2, 0, 1000) * Box(WALL, 1400, 1500, align=STANDING)
    vaulted = Pos(0, 0, SPRINGING) * vault.void()
    room = block - walls - vaulted - door - window
    room.label = "room under a mirror vault"
    export_step(room, out / "room.step")
    air = walls.volume + vaulted.volume
    print(f"{room.volume / 1e9:.3f} m³ of stone around {air / 1e9:.3f} m³ of air")

    # What the room sees of the vault: one labelled, coloured child a component, to be painted or measured.
    intrados = Pos(0, 0, SPRINGING) * vault.intrados()
    export_step(intrados, out / "intrados.step")
    for part in intrados.children:
        print(f"{part.label:12} {part.area / 1e6:7.3f} m²")


if __name__ == "__main__":
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "out")
    folder.mkdir(parents=True, exist_ok=True)
    main(folder)
