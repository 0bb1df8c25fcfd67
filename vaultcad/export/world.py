"""World file for CAD, as GIS programs read it: where two points of model.step lie in the coordinates of the scan.

Each line has a point of the drawing and the same point on the map, "x,y X,Y" (Esri, "World files for CAD datasets").
"""

from __future__ import annotations

from pathlib import Path

from families.declaration.units import MM
from vaultcad.model import Assembly

APART = 1000.0  # m between the two points


def write_world(model: Assembly, path: Path) -> None:
    """Write the two lines: millimetres of STEP, then the unit of the scan."""
    x, y = (float(v) for v in model.origin[:2])
    rows = [f"{MM * along:.10g},0 {(x + along) / model.unit:.10f},{y / model.unit:.10f}" for along in (0.0, APART)]
    path.write_text("\n".join(rows) + "\n", encoding="ascii")
