"""The sheet of a building: its plan with all bays, arches and piers, and what stands in each."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from vaultcad.drawings.fields import scan_fields
from vaultcad.drawings.marks import Mark, Path, View, Word, view_of
from vaultcad.drawings.plan_view import HEAD, outline_path
from vaultcad.drawings.sheet import Sheet, Wish, lay_out
from vaultcad.export.building_plan import arrow
from vaultcad.export.plan_shape import plan_shape
from vaultcad.measure.building import Building, building_of
from vaultcad.model import FittedPier, Model


def building_sheets(model: Model, wish: Wish) -> Iterator[Sheet]:
    """One a storey, in the scan's local frame, its y axis upwards.

    Raises:
        DrawingError: one does not fit as it is wished for.
    """
    building = building_of(model)
    for storey, vaults in enumerate(building.storeys, 1):
        many = len(building.storeys) > 1
        name = f"plan-{storey}" if many else "plan"
        title = f"Plan of storey {storey}" if many else "Plan"
        families = sorted({model.vaults[k - 1].vault.title for k in vaults})
        fields = (("vaults", f"{len(vaults)}: {', '.join(families)}"), *scan_fields(model))

        def views(
            scale: int, storey: int = storey, vaults: tuple[int, ...] = vaults, title: str = title
        ) -> tuple[Sequence[View], Sequence[View]]:
            return [], [view_of(title, [*_marks(model, building, storey, vaults, scale / 1000.0)])]

        yield lay_out(name, title, views, fields, wish, 0.0)


def _marks(model: Model, building: Building, storey: int, vaults: Sequence[int], mm: float) -> Iterator[Mark]:
    up = float(model.origin[2])
    for k in vaults:
        placed = model.vaults[k - 1]
        shape = plan_shape(model, placed)
        yield from (outline_path("OUTLINE", outline) for outline in shape.outlines)
        yield from (Path("GROINS", groin) for groin in shape.groins)
        yield from (Path("ARROWS", line) for line in arrow(shape, HEAD * mm))
        (x, y), (row, place) = shape.middle.tolist(), building.bay(k)
        yield Word("TEXT", (x, y + 2.2 * mm), f"{k}  {row}{place}", 3.0)
        springing, crown = placed.pose.z + up, placed.pose.z + placed.vault.top + up
        yield Word("TEXT", (x, y - 2.2 * mm), f"{springing:+.3f} {crown:+.3f}", 1.8)
    for k, arch in enumerate(model.arches, 1):
        if building.storey_of_arch(arch) == storey:
            shape = plan_shape(model, arch)
            yield from (outline_path("ARCHES", outline) for outline in shape.outlines)
            x, y = shape.middle.tolist()
            yield Word("ARCHES", (x, y), f"a{k}", 1.8)
    if storey == 1:
        yield from (pier_path(pier) for pier in model.piers)


def pier_path(pier: FittedPier) -> Path:
    """A pier in plan, round or with four sides."""
    width, depth, _ = pier.size
    out = pier.pose.placement()[:2]
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * [width / 2, depth / 2]
    round_ = pier.plan == "round"
    if round_:
        corners = np.array([[-width / 2, 0.0], [width / 2, 0.0]])
    points = corners @ out[:, :2].T + out[:, 3]
    return Path("PIERS", points, (1.0, 1.0) if round_ else (), closed=True)
