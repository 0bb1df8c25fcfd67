"""An arcade of pointed arches and the groin-vaulted walk behind it, with CadQuery. Writes arcade.step.

Usage: python examples/11_arcade.py [FOLDER]
"""

import sys
from pathlib import Path

import cadquery as cq

import vaultcad.cadquery  # noqa: F401  # teaches Workplane to make vaults

ARCHES, PITCH, CLEAR = 5, 4000, 3200  # mm: from axis to axis, clear width of an arch
WALL, WALK, SPRINGING, HEIGHT = 600, 3600, 2400, 6200  # mm


def main(out: Path) -> None:
    length = ARCHES * PITCH
    axes = [(PITCH * (k - (ARCHES - 1) / 2), 0) for k in range(ARCHES)]

    # The wall stands along x. Each arch is the room under a pointed barrel, cut out through the wall, and the doorway
    # below it. The vault is told its sizes in metres; the wall, as all in CadQuery, is in millimetres.
    wall = cq.Workplane().box(length, WALL, HEIGHT, centered=(True, True, False))
    doors = cq.Workplane().pushPoints(axes).box(CLEAR, WALL, SPRINGING, centered=(True, True, False))
    arches = (
        cq.Workplane(origin=(0, 0, SPRINGING))
        .pushPoints(axes)
        .vault("botte", span=CLEAR / 1000, length=WALL / 1000, profile="sesto acuto", rise=2.6, combine=False)
    )
    wall = wall.cut(doors).cut(arches)

    # Behind it the walk: a groin vault over each bay, 12 cm thick, standing free so that each can be taken out.
    walk = (
        cq.Workplane(origin=(0, (WALL + WALK) / 2, SPRINGING))
        .pushPoints(axes)
        .vault("crociera", span_x=PITCH / 1000, span_y=WALK / 1000, thickness=0.12, combine=False)
    )
    webs = walk.faces(tag="web_south")
    print(f"{ARCHES} arches; wall {wall.val().Volume() / 1e9:.3f} m³")
    print(f"{walk.size()} vaults; webs over the arches {sum(face.Area() for face in webs.vals()) / 1e6:.3f} m²")

    arcade = cq.Assembly(name="arcade").add(wall, name="wall", color=cq.Color("tan"))
    for k, bay in enumerate(walk.vals(), 1):
        arcade.add(bay, name=f"bay {k}", color=cq.Color("lightgoldenrod"))
    arcade.export(str(out / "arcade.step"))
    print(out / "arcade.step")


if __name__ == "__main__":
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "out")
    folder.mkdir(parents=True, exist_ok=True)
    main(folder)
