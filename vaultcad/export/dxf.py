"""plan.dxf: the plan as architects draw it, in metres from the model's origin; a layer for each kind of line."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from vaultcad.dxf_document import Layer, add_layers, dxf_document
from vaultcad.export.building_plan import arrow
from vaultcad.export.plan_shape import PlanShape, plan_shape
from vaultcad.measure.building import building_of
from vaultcad.model import Model

if TYPE_CHECKING:
    from ezdxf.document import Drawing
    from ezdxf.layouts import Modelspace

LETTER, FINE = 0.25, 0.15  # m, heights of numbers and of the rest
HEAD = 0.15  # m, half of an arrow's head


LAYERS = {
    "VAULTS": Layer(7, "CONTINUOUS", 35),  # their outlines
    "GROINS": Layer(8, "DASHED", 18),  # overhead: where components meet
    "ARCHES": Layer(4, "CONTINUOUS", 25),
    "NUMBERS": Layer(1, "CONTINUOUS", 18),  # of bays and arches
    "HEIGHTS": Layer(3, "CONTINUOUS", 18),  # of springings and crowns
    "ARROWS": Layer(8, "CONTINUOUS", 18),  # the way a barrel spans, or up a ramp
}


def write_dxf(model: Model, path: Path) -> None:
    """Write the plan of all vaults and arches; those of a second storey have layers of their own, as VAULTS-2."""
    with dxf_document(path, model.place) as document:
        _draw(document, model)


def _draw(document: Drawing, model: Model) -> None:
    building, up, space = building_of(model), float(model.origin[2]), document.modelspace()
    for storey, vaults in enumerate(building.storeys, 1):
        suffix = f"-{storey}" if storey > 1 else ""
        on = {name: f"{name}{suffix}" for name in LAYERS}
        add_layers(document, LAYERS, suffix)
        for k in vaults:
            placed = model.vaults[k - 1]
            shape = plan_shape(model, placed)
            _outline(space, shape, on["VAULTS"])
            for groin in shape.groins:
                space.add_lwpolyline(groin.tolist(), dxfattribs={"layer": on["GROINS"]})
            for line in arrow(shape, HEAD):
                space.add_lwpolyline(line.tolist(), dxfattribs={"layer": on["ARROWS"]})
            row, place = building.bay(k)
            springing, crown = placed.pose.z + up, placed.pose.z + placed.vault.top + up
            _text(space, shape, f"{k}  {row}{place}", on["NUMBERS"], LETTER, 1.0)
            _text(space, shape, f"{springing:+.3f} {crown:+.3f}", on["HEIGHTS"], FINE, -1.5)
        for k, arch in enumerate(model.arches, 1):
            if building.storey_of_arch(arch) == storey:
                shape = plan_shape(model, arch)
                _outline(space, shape, on["ARCHES"])
                _text(space, shape, f"a{k}", on["NUMBERS"], FINE, 0.0)


def _outline(space: Modelspace, shape: PlanShape, layer: str) -> None:
    for outline in shape.outlines:
        corners = [(x, y, bulge) for (x, y), bulge in zip(outline.corners.tolist(), outline.bulges, strict=True)]
        space.add_lwpolyline(corners, format="xyb", close=True, dxfattribs={"layer": layer})


def _text(space: Modelspace, shape: PlanShape, text: str, layer: str, height: float, lines: float) -> None:
    """A line of text about the middle of what it tells of, so many of its lines above it."""
    from ezdxf.enums import TextEntityAlignment

    at = shape.middle + np.array([0.0, lines * height])
    entity = space.add_text(text, height=height, dxfattribs={"layer": layer})
    entity.set_placement(tuple(at.tolist()), align=TextEntityAlignment.MIDDLE_CENTER)
