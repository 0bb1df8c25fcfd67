"""plan.dxf: the plan as architects draw it, in metres from the model's origin; a layer for each kind of line."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from datetime import datetime
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from segmentation.io.stamp import stamp
from vaultcad.export.building_plan import arrow
from vaultcad.export.plan_shape import PlanShape, plan_shape
from vaultcad.measure.building import building_of
from vaultcad.model import Model

if TYPE_CHECKING:
    from ezdxf.document import Drawing
    from ezdxf.layouts import Modelspace

RELEASE = "R2010"
METRES = 6  # $INSUNITS
LETTER, FINE = 0.25, 0.15  # m, heights of numbers and of the rest
DASH = (0.3, 0.2, -0.1)  # m: the pattern's length, a dash, a gap
FIXED = datetime(2000, 1, 1)  # what ezdxf writes when it is told to write no time
HEAD = 0.15  # m, half of an arrow's head


class Layer(NamedTuple):
    """A layer: colour of AutoCAD's index, line type, weight of its lines [1/100 mm]."""

    colour: int
    linetype: str
    weight: int


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
    import ezdxf
    from ezdxf.tools.juliandate import juliandate

    told = StringIO()
    with _without_clock():
        document = ezdxf.new(RELEASE, units=METRES)
        document.header["$MEASUREMENT"] = 1  # metric
        document.header.custom_vars.append("place", model.place)
        document.linetypes.add("DASHED", DASH, description="dashed __ __ __")
        _draw(document, model)
        for name in sorted(document.entitydb.dxf_types_in_use()):  # ezdxf adds them as a set has them
            document.classes.add_class(name)
        document.write(told)
    text = told.getvalue().replace(f"\n{juliandate(FIXED)}\n", f"\n{juliandate(stamp().replace(tzinfo=None))}\n")
    path.write_text(text, encoding="utf-8", newline="\n")


@contextmanager
def _without_clock() -> Iterator[None]:
    """Elsewhere ezdxf writes the time, and identities by chance."""
    import ezdxf

    kept = ezdxf.options.write_fixed_meta_data_for_testing
    ezdxf.options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        ezdxf.options.write_fixed_meta_data_for_testing = kept


def _draw(document: Drawing, model: Model) -> None:
    building, up, space = building_of(model), float(model.origin[2]), document.modelspace()
    for storey, vaults in enumerate(building.storeys, 1):
        suffix = f"-{storey}" if storey > 1 else ""
        on = {name: f"{name}{suffix}" for name in LAYERS}
        for name, layer in LAYERS.items():
            document.layers.add(on[name], color=layer.colour, linetype=layer.linetype, lineweight=layer.weight)
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
