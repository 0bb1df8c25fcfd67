"""An ideal vault: its parameters, its numeric surface, its solid. Writes groin.step.

Usage: python examples/01_ideal_vault.py [FOLDER]
"""

import sys
from math import pi
from pathlib import Path

import numpy as np

from families import Groin
from families.declaration.parameters import derived_declarations


def main(out: Path) -> None:
    vault = Groin(span_x=6.0, span_y=6.0)
    values = vault.values()
    for p in vault.parameters():
        print(f"{p.name:18} {values[p.name]:8.3f} {p.range.unit:2} {p.range.meaning}")
    sizes = vault.derived_values()
    for name, declared in derived_declarations(Groin).items():
        print(f"{name:18} {sizes[name]:8.3f} {declared.unit:2} {declared.meaning}")

    # The numeric surface: how far points are from it (positive in the stone), and which web they belong to.
    points = np.array([[0.0, 0.0, 2.9], [0.0, -2.0, 3.1], [2.0, 0.0, 3.0]])
    surface = vault.evaluate(points)
    for point, distance, component in zip(points, surface.distance, surface.component, strict=True):
        print(f"{point} lies {1000 * distance:+.1f} mm from {vault.components[component - 1]}")

    # The same vault as exact solids, in millimetres as CAD has them.
    from build123d import export_step

    intrados, solid = vault.intrados(), vault.solid(thickness=0.2)
    area = sum(web.area for web in intrados.children) / 1e6
    print(f"intrados {area:.6f} m², by the formula (π - 2) s² {(pi - 2) * 36:.6f} m²")
    print(f"masonry {solid.volume / 1e9:.3f} m³")
    export_step(solid, out / "groin.step")


if __name__ == "__main__":
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "out")
    folder.mkdir(parents=True, exist_ok=True)
    main(folder)
