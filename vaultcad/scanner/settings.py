"""What is scanned and with what: every setting of the virtual scanner, declared once with its range and unit."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite, pi
from typing import Annotated, Literal, get_args

from families.declaration.parameters import Parametric, Range

Walls = Literal["walls", "piers"]


@dataclass(frozen=True)
class ScannerSettings(Parametric):
    """Room, settlement, instrument and place of a virtual scan.

    The instrument's defaults are those of a FARO Focus: range noise of 0.6 mm at 10 m, ranging error of ±2 mm at 25 m,
    angular accuracy of 19 arc seconds. Settlement of real vaults is 2 to 5 cm.

    Raises:
        ValueError: a value outside its range; names the field, the value and the limits.
    """

    points: Annotated[int, Range(1_000, 200_000_000, "1", "points wanted from all stations together, within 10 %")] = (
        1_600_000
    )
    stations: Annotated[int, Range(1, 12, "1", "positions of the scanner")] = 2
    visit: Annotated[int, Range(0, 1000, "1", "0 at first; later visits to the same room set the scanner up anew")] = 0
    station_height: Annotated[float, Range(0.3, 3, "m", "height of the scanner above the floor")] = 1.6

    noise: Annotated[float, Range(0, 0.05, "m", "standard deviation of a range at 10 m, surface hit squarely")] = 0.0006
    ranging_error: Annotated[float, Range(0, 0.05, "m", "limit of a station's systematic range error at 25 m")] = 0.002
    angle_noise: Annotated[float, Range(0, 0.01, "rad", "standard deviation of either angle of a beam")] = 9e-5
    mixed: Annotated[float, Range(0, 1, "1", "share of the beams at depth edges that mix near and far")] = 0.25
    dropout: Annotated[float, Range(0, 0.5, "1", "reflectance × cos(incidence) at which 1 / e are lost")] = 0.02
    registration_shift: Annotated[
        float, Range(0, 0.1, "m", "standard deviation of the shift of a further station against the first, each axis")
    ] = 0.002
    registration_turn: Annotated[
        float, Range(0, 0.02, "rad", "standard deviation of the turn of a further station about each axis")
    ] = 0.0003

    relief: Annotated[float, Range(0, 0.05, "m", "standard deviation of the relief of plaster and stone")] = 0.0015
    settlement: Annotated[float, Range(0, 0.3, "m", "largest displacement of the vault from its ideal shape")] = 0.03
    crown_fall: Annotated[float, Range(-0.3, 0.3, "m", "fall of the crown, beside the drawn settlement")] = 0.0
    spread_x: Annotated[float, Range(-0.3, 0.3, "m", "widening of the span along x at the springing, likewise")] = 0.0
    spread_y: Annotated[float, Range(-0.3, 0.3, "m", "widening of the span along y at the springing, likewise")] = 0.0
    one_sided: Annotated[float, Range(-0.3, 0.3, "m", "by which the side at +x sinks against that at -x")] = 0.0
    twist: Annotated[float, Range(-0.3, 0.3, "m", "by which two opposite corners sink against the others")] = 0.0
    holes: Annotated[float, Range(0, 0.6, "1", "share of the vault's points that patches without points take away")] = (
        0.0
    )

    walls: Walls = "walls"  # "piers": open on all sides, on four piers with transverse arches
    wall_height: Annotated[float, Range(1.2, 30, "m", "springing above the floor")] = 3.0
    openings: Annotated[int, Range(0, 12, "1", "doors and windows tried; those that find no room are left out")] = 3
    tie_rods: Annotated[int, Range(0, 12, "1", "iron rods across the room, just above the springing")] = 2
    furniture: Annotated[int, Range(0, 12, "1", "boxes along the walls")] = 3
    lamp: bool = True
    cornice: bool = False
    scaffold: bool = False

    crop: bool = False  # keep only the vault and what is within `crop_margin` below its springing
    crop_margin: Annotated[float, Range(0, 5, "m", "what a cropped scan keeps below the springing")] = 0.4
    yaw: Annotated[float, Range(-pi, pi, "rad", "turn of the vault's x axis about z, from the file's x axis")] = 0.0
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)  # floor under the middle of the plan, in file coordinates [m]

    def __post_init__(self) -> None:
        """Check the numbers as every family does, then the rest."""
        super().__post_init__()
        if self.walls not in get_args(Walls):
            raise ValueError(f"walls = {self.walls!r} is not one of {', '.join(map(repr, get_args(Walls)))}")
        if len(self.origin) != 3 or not all(isfinite(v) and abs(v) <= 1e8 for v in self.origin):
            raise ValueError(f"origin = {self.origin!r} must be three finite coordinates within ±1e8 m")
