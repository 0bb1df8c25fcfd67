"""The plan of a building, drawn from its model: bays with their numbers, projected groins, arches, arrows."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from families.declaration.palette import STONE, Colour
from families.drawing.deviation_colours import LIMITS, shade
from families.drawing.looks import LETTER
from families.drawing.sheet import Drawing
from vaultcad.export.palette import colour
from vaultcad.export.plan_shape import PlanShape, plan_shape
from vaultcad.export.seen import Seen
from vaultcad.measure.building import Building, building_of
from vaultcad.model import FittedVault, Model

Floats = NDArray[np.float64]

MARGIN = 0.055  # around a building, in parts of its larger side
HEAD = 0.35  # of a letter, a half of an arrow's head
BARS = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0)  # m that the scale may be long
BAR = 0.25  # of the plan's width at most


class Colouring(NamedTuple):
    """How bays are coloured, what of each is written in it, and what the drawing says of it."""

    colour: Callable[[FittedVault], Colour]
    text: Callable[[FittedVault], str]
    title: str


def family_colours(model: Model) -> Mapping[str, Colour]:
    """A colour for each family of a model, by its id, in the order in which they come."""
    return {name: colour(k) for k, name in enumerate(dict.fromkeys(v.vault.id for v in model.vaults), 1)}


def building_plans(model: Model, seen: Sequence[Seen] = ()) -> Iterator[Drawing]:
    """Two plans a storey, with bays coloured by family, and by deviation, and with the walls that the scan shows."""
    building, up = building_of(model), float(model.origin[2])
    kinds = family_colours(model)
    limit = next((v for v in LIMITS if v >= max(f.deviation.rms for f in model.vaults)), LIMITS[-1])
    colourings = (
        Colouring(
            lambda fitted: kinds[fitted.vault.id],
            lambda fitted: f"{fitted.pose.z + up:+.2f} {fitted.pose.z + fitted.vault.top + up:+.2f}",
            "by family, with heights of springing and crown",
        ),
        Colouring(
            lambda fitted: shade(fitted.deviation.rms, limit),
            lambda fitted: f"{1000 * fitted.deviation.rms:.1f} mm",
            f"by rms deviation, red from {1000 * limit:g} mm on",
        ),
    )
    shapes = [plan_shape(model, fitted) for fitted in model.vaults]
    for floor in range(1, len(building.storeys) + 1):
        of = f"storey {floor}: " if len(building.storeys) > 1 else ""
        for colouring in colourings:
            title = f"Plan, {of}bays coloured {colouring.title}; dashed: groins overhead; arrows: span, or up a ramp"
            yield _plan(model, building, floor, shapes, seen, colouring._replace(title=title))


def _plan(
    model: Model,
    building: Building,
    floor: int,
    shapes: Sequence[PlanShape],
    seen: Sequence[Seen],
    colouring: Colouring,
) -> Drawing:
    numbers = building.storeys[floor - 1]
    arches = {
        k: plan_shape(model, arch) for k, arch in enumerate(model.arches, 1) if building.storey_of_arch(arch) == floor
    }
    rows = [row for k in numbers for row in shapes[k - 1].rows] + [row for arch in arches.values() for row in arch.rows]
    reach = np.concatenate(rows)
    drawing = Drawing(reach.min(axis=0), reach.max(axis=0), colouring.title, MARGIN)
    letter = LETTER * drawing.margin
    for one in (one for k, one in enumerate(seen, 1) if k in numbers):
        out = one.fitted.pose.placement()[:2]
        drawing.dots(one.walls @ out[:, :3].T + out[:, 3], "scan-closer")
    for k in numbers:
        drawing.area(shapes[k - 1].rows, "stone", colouring.colour(model.vaults[k - 1]), building.name(k))
    for number, arch in arches.items():
        drawing.area(arch.rows, "stone", Colour(*STONE), f"arch {number}")
    for k in numbers:
        for groin in shapes[k - 1].groins:
            drawing.line(groin, "projected")
        for line in arrow(shapes[k - 1], HEAD * letter):
            drawing.line(line, "arrow")
    for k in numbers:
        row, place = building.bay(k)
        middle, up = shapes[k - 1].middle, np.array([0.0, 0.65 * letter])
        drawing.text(middle + up, f"{k} · {row}{place}", "label")
        drawing.text(middle - up, colouring.text(model.vaults[k - 1]), "label")
    _scale(drawing)
    return drawing


def arrow(shape: PlanShape, head: float) -> list[Floats]:
    """An arrow's lines (n, 2) with heads of a size [m]; none if the vault has no arrow."""
    if shape.arrow is None:
        return []
    ends = (shape.arrow, shape.arrow[::-1]) if shape.both else (shape.arrow,)
    rows = [shape.arrow]
    for tail, tip in ends:
        along = (tip - tail) / np.hypot(*(tip - tail))
        across = np.array([-along[1], along[0]])
        rows.append(np.stack([tip - head * (2 * along + across), tip, tip - head * (2 * along - across)]))
    return rows


def _scale(drawing: Drawing) -> None:
    """A bar of a round length below the plan."""
    wide = float(drawing.high[0] - drawing.low[0])
    long = max((bar for bar in BARS if bar <= BAR * wide), default=BARS[0])
    x, y = float(drawing.low[0]), float(drawing.low[1]) - drawing.margin / 2
    drawing.dimension((x, y), (x + long, y))
