"""What a building is made of: bays, arches, piers, doors, and who scans it. All in the building's frame, z up [m]."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from families import Profile, Vault
from vaultcad.scanner.building.place import Place
from vaultcad.scanner.settings import ScannerSettings

Array = NDArray[np.float64]
PierKind = Literal["jambs", "square", "round"]
PIERS: tuple[PierKind, ...] = get_args(PierKind)
STEPS = 160  # chords of an arch, about


@dataclass(frozen=True)
class Style:
    """How a bay meets its neighbours: thickness [m] of the arches below the vaults, what their free ends stand on."""

    thickness: float = 0.2
    piers: PierKind = "jambs"


@dataclass(frozen=True)
class Bay:
    """A vault in its place, the middle of its plan on the springing, and the floor [m] under its lowest springing.

    closed: names of the straight sides that are walls whatever stands beyond. windows: in its free walls.
    wall_arches: width [m] of arches before its free walls, 0 for none. group: of bays that are pieces of one vault,
    from 1 up; 0 for none.
    """

    vault: Vault
    place: Place
    floor: float = 0.0
    style: Style = Style()
    closed: tuple[str, ...] = ()
    windows: bool = True
    wall_arches: float = 0.0
    group: int = 0
    name: str = ""

    @property
    def slope(self) -> float:
        """Of springing and floor along y; 0 but over stairs [1]."""
        return self.vault.values().get("slope", 0.0)

    def floor_at(self, xy: Array) -> Array:
        """Height (n,) [m] of the floor under places (n, 2) of the vault's frame."""
        return self.floor + self.vault.lift + self.slope * xy[:, 1]

    @property
    def top(self) -> float:
        """Its highest place [m]."""
        return self.place.z + self.vault.top


@dataclass(frozen=True, eq=False)
class Arch:
    """A masonry arch through a wall or between two bays; x of its place spans it, and z is its springing.

    width: along the way through it. thickness: below the vaults, or of its voussoirs. floor: under it [m].
    intrados, extrados: (n, 2) along x and above the springing, from foot to foot [m].
    jambs: down to which height [m] the foot at either end goes on as a pier. blind: a wall closes its far side.
    """

    place: Place
    width: float
    thickness: float
    floor: float
    intrados: Array
    extrados: Array
    jambs: tuple[float, float]
    blind: bool = False

    @staticmethod
    def of(profile: Profile, span: float, place: Place, width: float, thickness: float, floor: float) -> Arch:
        """By its profile and clear span [m]."""
        intrados = outline(profile, span / 2, profile.rise(span / 2))
        extrados = outline(profile, span / 2 + thickness, profile.rise(span / 2) + thickness)
        return Arch(place, width, thickness, floor, intrados, extrados, (floor, floor))

    @property
    def span(self) -> float:
        """Clear width at the springing [m]."""
        return float(np.ptp(self.intrados[:, 0]))

    @property
    def rise(self) -> float:
        """Crown above the springing [m]."""
        return float(self.intrados[:, 1].max())


def outline(profile: Profile, half_span: float, rise: float) -> Array:
    """An arch as points (n, 2) [m] from foot to foot."""
    from families.void.profile_outline import half_outline

    bows = half_outline(profile.arch(half_span, rise), 0.0, half_span, 0.0)
    traced = [np.column_stack(bow.trace(np.linspace(bow.start, bow.end, STEPS // 2))[:2]) for bow in bows]
    right = np.concatenate([[[half_span, 0.0]], *traced])
    right = right[np.append(True, np.hypot(*np.diff(right, axis=0).T) > 1e-6)]
    return np.concatenate([right * (-1.0, 1.0), right[-2::-1]])


@dataclass(frozen=True)
class Pier:
    """A pier or column that stands free: its place on the floor, the height [m] of its top, kind and breadth [m].

    clear: breadth [m] of the stone about it that is taken away below its top; 0 where none stands there.
    """

    place: Place
    top: float
    kind: PierKind
    size: float
    clear: float = 0.0


@dataclass(frozen=True)
class Door:
    """A straight way through walls: its middle on the floor, its depth along y of the place, width and height [m]."""

    place: Place
    depth: float
    width: float = 1.2
    height: float = 2.2


@dataclass(frozen=True)
class Building:
    """All that is built and how it is scanned.

    stations: places (k, 3) [m] of the scanner; where there are none, `settings.stations` places are found.
    yaw [rad] and origin [m] place it in the file. rods: tie rods in its arches. pews: boxes on its floors.
    """

    name: str
    bays: tuple[Bay, ...]
    arches: tuple[Arch, ...] = ()
    piers: tuple[Pier, ...] = ()
    doors: tuple[Door, ...] = ()
    rods: bool = False
    pews: int = 0
    yaw: float = 0.0
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    stations: tuple[tuple[float, float, float], ...] = ()
    settings: ScannerSettings = field(default_factory=ScannerSettings)
