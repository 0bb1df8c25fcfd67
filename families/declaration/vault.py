"""The base of all families: parameters, components, and the numeric surface they share."""

from __future__ import annotations

import os
from abc import abstractmethod
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, ClassVar, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from families.declaration.constraints import Constraint
from families.declaration.corners import Skew
from families.declaration.facts import demand_facts
from families.declaration.footprint import RECTANGLE, Footprint
from families.declaration.parameters import Parametric
from families.declaration.pieces import Piece
from families.declaration.plan import Plan
from families.declaration.profiles import PROFILES, Profile
from families.declaration.ribs import RibLine, Ribs
from families.declaration.symmetry import Symmetry

if TYPE_CHECKING:
    import build123d

    from families.void.sampling import Sample

SCHEMA = 1  # of a vault as plain values
IDENTITY = np.eye(3, 4)
CHUNK = 1 << 17  # points that a thread takes at once
Found = TypeVar("Found")


@dataclass(frozen=True)
class Surface:
    """Where points stand against a vault: signed distance (n,) [m], component (n,), unit normal (n, 3) into the stone.

    Distances are positive in the stone and negative in the room. Component 0 is wall, else 1 + index in `components`.
    """

    distance: NDArray[np.float64]
    component: NDArray[np.uint16]
    normal: NDArray[np.float64]


@dataclass(frozen=True)
class Vault(Parametric):
    """A vault in its frame: origin at the centre of the plan on the springing, x and y along its sides, z up [m].

    A family is a frozen dataclass of this base that declares all that is known of it; nothing stands anywhere else.
    What has no default here is in `families.declaration.facts`, and a class without it is refused. `catalogue.register`
    makes it known by its names.
    """

    id: ClassVar[str]
    title: ClassVar[str]
    aliases: ClassVar[Mapping[str, tuple[str, ...]]]  # language code -> names
    glossary: ClassVar[tuple[tuple[str, str], ...]] = ()  # terms, and what they mean, for people who read its report
    roof_type: ClassVar[str]  # of IfcRoofTypeEnum
    # Length that people measure -> the one parameter that it decides, monotonic in it; each after those it hangs on.
    ratios: ClassVar[Mapping[str, str]]
    held: ClassVar[Mapping[str, str]] = {}  # further lengths that a fit can hold, likewise
    stands_for: ClassVar[Mapping[str, Callable[[float], Mapping[str, float]]]] = {}  # length -> what holding it holds
    constraints: ClassVar[tuple[Constraint, ...]] = ()  # in the order in which a fit tries them
    usual: ClassVar[Mapping[str, tuple[float, float]]] = {}  # mean and deviation of parameters that are let go
    alike: ClassVar[tuple[str, ...]] = ()  # the arches that are mostly of one kind
    arch_kinds: ClassVar[Mapping[str, tuple[type[Profile], ...]]] = {}  # of arches that cannot be of every kind
    raised: ClassVar[tuple[str, ...]] = ()  # the arches that spring higher than the vault itself
    quarter_turn: ClassVar[Symmetry | None]  # what a turn by 90° changes; None if it is none of the family then
    half_turn: ClassVar[Symmetry | None] = Symmetry()  # what a turn by 180° changes, likewise

    four_corners: ClassVar[bool] = True  # whether its plan has four corners, which may be free
    stands_over: ClassVar[str] = RECTANGLE  # shape of the ground that a fit looks for it over, of `footprint.SHAPES`

    supple: ClassVar[bool] = False  # whether it bends so far that it passes for others: a fit tries it where they fail
    pliant: ClassVar[bool] = False  # whether its webs take up a movement by their own shape: one scan tells none

    variants: ClassVar[tuple[str, ...]] = ()  # whole numbers that say which of several kinds it is: a fit tries each

    skew: Skew | None = field(default=None, kw_only=True)  # where the plan is no rectangle

    def __init_subclass__(cls, **given: Any) -> None:
        """See that nothing is missing. Raises TypeError with a sentence that says what is."""
        super().__init_subclass__(**given)
        demand_facts(cls, Vault)

    def __post_init__(self) -> None:
        """Refuse values that cannot be.

        Raises:
            ValueError: one is outside its range, an arch is of a kind that the family does not have there, or free
                corners are given to a plan that has not four.
        """
        for name in self.arch_kinds:
            arch, kinds = getattr(self, name), self.kinds_for(name)
            if type(arch) not in kinds:
                there = ", ".join(kind.id for kind in kinds)
                raise ValueError(f"{name} = {arch.id!r} cannot be in {self.called}; there are {there}")
        if self.skew is not None and not self.four_corners:
            raise ValueError(f"the plan of {self.called} has no four corners that could be free")
        super().__post_init__()

    @property
    @abstractmethod
    def components(self) -> tuple[str, ...]:
        """Names of the components; the id of one is 1 + its index."""

    @property
    @abstractmethod
    def plan(self) -> Plan:
        """The region that it covers, and where its stone may stand on walls."""

    @abstractmethod
    def pieces(self) -> tuple[Piece, ...]:
        """The void, from which the numeric surface and the solid are both made."""

    def rib_lines(self) -> tuple[RibLine, ...]:
        """The lines under which ribs may run, those first at whose sides others end; none where none are known."""
        return ()

    @classmethod
    @abstractmethod
    def first_guesses(cls, over: Footprint) -> Iterator[Self]:
        """Vaults over ground that a scan shows, of the shape it stands over: so many that a fit can begin from one."""

    @classmethod
    @abstractmethod
    def drawn(cls, rng: np.random.Generator) -> Self:
        """A vault with sizes as builders chose them, for virtual scans."""

    @classmethod
    def kinds_for(cls, arch: str) -> tuple[type[Profile], ...]:
        """The kinds of which an arch can be, by the name of its field."""
        return cls.arch_kinds.get(arch, PROFILES)

    @property
    def called(self) -> str:
        """One of its kind: a groin vault."""
        return f"{'an' if self.title[0] in 'aeiou' else 'a'} {self.title}"

    @property
    def top(self) -> float:
        """Its highest place above the springing [m]: the crown, unless that climbs."""
        return self.derived_values()["rise"]

    @property
    def itself(self) -> bool:
        """Whether it has what makes its family; one that has lost it is another's, which says the same, and better."""
        return True

    @property
    def may_be_several(self) -> bool:
        """Whether it looks like several vaults in a row."""
        return False

    def contradiction(self, points: NDArray[np.float64], own: NDArray[np.float64], tolerance: float) -> str:
        """Why it cannot be what was scanned, though it fits; empty if it can.

        Args:
            points: (n, 3) of the scan over its site, in the vault's frame [m].
            own: (m, 3) those of them above the springing that lie on it.
            tolerance: how far points of it may be off [m].
        """
        return ""

    def evaluate(
        self, xyz: NDArray[np.floating], *, frame: NDArray[np.float64] = IDENTITY, walls: bool = False
    ) -> Surface:
        """Signed distance, component and normal of points (n, 3) [m].

        Args:
            xyz: the points.
            frame: (3, 4) rigid motion that brings the points into the vault's frame.
            walls: the vault on its walls: points nearer to a wall, or below the springing, have component 0.

        >>> from families import Groin
        >>> vault = Groin(span_x=6, span_y=6)
        >>> here = vault.evaluate(np.array([[0.0, -2.0, 2.9], [2.0, 0.0, 3.2]]))
        >>> here.distance.round(3).tolist(), [vault.components[k - 1] for k in here.component]
        ([-0.1, 0.2], ['web_south', 'web_east'])
        """
        from families.void import body_table, kernel

        table = body_table.pack(self.pieces(), self.components)
        plan = body_table.pack_plan(self.plan if walls else None)
        parts = _in_threads(lambda points: kernel.surface(points, frame, table, plan), _points(xyz))
        if len(parts) == 1:
            return Surface(*parts[0])
        return Surface(*(np.concatenate(column) for column in zip(*parts, strict=True)))

    def distance(
        self, xyz: NDArray[np.floating], *, frame: NDArray[np.float64] = IDENTITY, walls: bool = False
    ) -> NDArray[np.float64]:
        """Signed distances (n,) [m] of points (n, 3), positive in the stone.

        >>> from families import Barrel
        >>> Barrel(span=4, length=6).distance(np.array([[0.0, 0.0, 1.5], [0.0, 0.0, 2.25]])).tolist()
        [-0.5, 0.25]
        """
        from families.void import body_table, kernel

        table = body_table.pack(self.pieces(), self.components)
        plan = body_table.pack_plan(self.plan if walls else None)
        parts = _in_threads(lambda points: kernel.distances(points, frame, table, plan), _points(xyz))
        return parts[0] if len(parts) == 1 else np.concatenate(parts)

    @property
    def profiles(self) -> dict[str, Profile]:
        """The arches that it is made with, by the names of their fields."""
        return {name: value for name, value in vars(self).items() if isinstance(value, Profile)}

    @property
    def kinds(self) -> dict[str, str]:
        """The ids of their kinds, likewise."""
        return {name: arch.id for name, arch in self.profiles.items()}

    def plain(self) -> dict[str, Any]:
        """The whole vault as plain values, ready for JSON; `from_plain` reads it.

        >>> from families import Sail
        >>> Sail(span_x=4).plain()["parameters"]
        {'span_x': 4.0, 'span_y': 5.0, 'rise_ratio': 0.8}
        >>> Vault.from_plain(Sail(span_x=4).plain()) == Sail(span_x=4)
        True
        """
        return {"schema": SCHEMA, "family": self.id, "profiles": self.kinds, "parameters": self.values()}

    @classmethod
    def from_plain(cls, told: Mapping[str, Any]) -> Self:
        """The vault that `plain` tells of; profiles and parameters that are left out are as in an ideal one.

        Raises:
            ValueError: an unknown name, a value of another kind or outside its range, or a vault of another class.
        """
        from families import catalogue

        vault = catalogue.from_plain(told)
        if not isinstance(vault, cls):
            raise ValueError(f"family = {told['family']!r} is no {cls.title}")
        return vault

    def with_arches(self, profiles: Mapping[str, Profile]) -> Self:
        """The same with other profiles, by the names of the fields."""
        changed: dict[str, Any] = dict(profiles)
        return replace(self, **changed)

    @property
    def lift(self) -> float:
        """Height [m] of the arches' feet above the springing in the middle of the plan; not 0 on ramps."""
        return 0.0

    @property
    def corners(self) -> NDArray[np.float64]:
        """The corners of the plan (n, 2) [m], counterclockwise from south west."""
        return self.plan.corners

    def over(
        self, half_x: float, half_y: float, *, on_wall_x: bool = False, on_wall_y: bool = False, taper: float = 0.0
    ) -> Plan:
        """The plan of these half extents [m], or that of four free corners which stands for it.

        `taper`: by as much more are both halves of the north side longer than in the middle, as a share.
        """
        if self.skew is None and not taper:
            return Plan.rectangle(half_x, half_y, on_wall_x, on_wall_y)
        corners = (self.skew or Skew()).corners(half_x, half_y, taper)
        return Plan.polygon(corners, (on_wall_y, on_wall_x, on_wall_y, on_wall_x))

    def intrados(self) -> build123d.Compound:
        """The intrados [mm]: one labelled, coloured face or shell a component."""
        from families.solid import brep

        return brep.intrados(self)

    def void(self) -> build123d.Part:
        """The room under the vault [mm], above the springing and within the plan, to be cut out of a block.

        >>> from math import pi
        >>> from families import Barrel
        >>> round(Barrel(span=4, length=6).void().volume / 1e9 / pi, 6)
        12.0
        """
        from families.solid import brep

        return brep.room(self)

    def solid(self, thickness: float = 0.15) -> build123d.Part:
        """The masonry [mm] between the intrados and an extrados with all radii larger by `thickness` [m].

        >>> from math import pi
        >>> from families import Barrel
        >>> round(Barrel(span=4, length=6).solid(0.5).volume / 1e9 / pi, 6)  # (2.5² - 2²) / 2 x 6 m
        6.75
        """
        from families.solid import brep

        return brep.solid(self, thickness)

    def ribs(self, section: Ribs | None = None) -> build123d.Compound:
        """The ribs under the vault [mm]: a solid a rib, labelled, and the boss at which they meet.

        Raises:
            ValueError: no rib can hang under it, or none of that section; says why.

        >>> from families import Rib, Ribs
        >>> ribs = Rib(span_x=5, span_y=5).ribs(Ribs(width=0.25, depth=0.2, kinds=("diagonal",)))
        >>> [rib.label for rib in ribs.children]
        ['diagonal_south_west', 'diagonal_south_east', 'diagonal_north_east', 'diagonal_north_west', 'boss']
        """
        from families.solid import ribs

        return ribs.compound(self, section or Ribs())

    def named_faces(self, shape: build123d.Shape) -> dict[str, build123d.ShapeList[build123d.Face]]:
        """The faces of this vault's void or solid, labelled and coloured, by component, "extrados" and "side".

        build123d itself keeps no names of faces: ask here after each time that the body was made or moved back.

        >>> from families import Mirror
        >>> vault = Mirror()
        >>> sorted(vault.named_faces(vault.void()))
        ['cove_east', 'cove_north', 'cove_south', 'cove_west', 'plane', 'side']
        """
        from families.solid import brep

        return brep.named_faces(shape, self)

    def _repr_mimebundle_(self, include: object = None, exclude: object = None) -> dict[str, Any]:
        """What a notebook shows."""
        from families import notebook

        return notebook.bundle(self)

    def sample(self, count: int, rng: np.random.Generator) -> Sample:
        """`count` points spread evenly over the intrados, with normals and components.

        >>> from families import Dome
        >>> cloud = Dome(radius=3).sample(1000, np.random.default_rng(1))
        >>> cloud.xyz.shape, cloud.normals.shape, np.unique(cloud.component).tolist()
        ((1000, 3), (1000, 3), [1, 2, 3, 4, 5, 6])
        """
        from families.void import sampling

        return sampling.sample(self, count, rng)


def _in_threads(work: Callable[[NDArray[np.float64]], Found], points: NDArray[np.float64]) -> list[Found]:
    """The results of compiled work, which lets other threads run, on runs of `CHUNK` points in their order."""
    # The first alone: numba loads what it knows of types then, which must not happen while another thread looks it up.
    found = [work(points[:CHUNK])]
    if len(points) > CHUNK:
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            found += pool.map(work, (points[k : k + CHUNK] for k in range(CHUNK, len(points), CHUNK)))
    return found


def _points(xyz: NDArray[np.floating]) -> NDArray[np.float64]:
    points = np.ascontiguousarray(xyz, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError(f"points of shape {points.shape} given; (n, 3) is needed")
    return points
