"""Vaults where they stand, and the result of a fit, as plain values: what every exporter and the report read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import isfinite, nan
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from families import Ribs, Vault
from families.declaration.parameters import derived_declarations
from segmentation.crs import Crs
from segmentation.notes import Note
from vaultcad.deformation import Deformation
from vaultcad.displacement import Displacement
from vaultcad.errors import NoSuchVaultError
from vaultcad.pose import Pose
from vaultcad.uncertain import Covariance, Deviation, Estimate


@dataclass(frozen=True)
class Component:
    """What the scan says of one component; `id` is the label in segments.laz."""

    id: int
    name: str
    points: int
    deviation: Deviation | None
    coverage: float
    as_built: Deviation | None = None
    nurbs: Deviation | None = None


@dataclass(frozen=True)
class Rival:
    """One way in which a vault may have been built: arches by the ids of their kinds, constraints that hold, sizes.

    chance: how likely it is. sizes: parameters and derived sizes before the settlement [m, rad, 1]. springing: above
    that of the vault as it was fitted [m].
    """

    chance: float
    profiles: Mapping[str, str]
    constraints: tuple[str, ...]
    sizes: Mapping[str, float]
    springing: float


SAID = 0.95  # what is said of an arch holds with this chance


def said(odds: Mapping[str, float]) -> tuple[str, ...]:
    """The kinds that together have a chance of `SAID` or more, as few as can be, the likeliest first."""
    kinds: list[str] = []
    for kind in sorted(odds, key=lambda kind: -odds[kind]):
        if kinds and sum(odds[known] for known in kinds) >= SAID:
            break
        kinds.append(kind)
    return tuple(kinds)


@dataclass(frozen=True)
class PlacedVault:
    """A vault where it stands, as exporters take it, whether it was fitted to a scan or drawn."""

    vault: Vault
    pose: Pose
    thickness: float | None = field(default=None, kw_only=True)  # m, of its masonry; None for that of all
    label: str = field(default="", kw_only=True)  # what a user calls it
    solid: bool = field(default=True, kw_only=True)  # whether its body can be built
    ribs: Ribs | None = field(default=None, kw_only=True)  # that hang under it

    @property
    def arches(self) -> dict[str, str]:
        """The kind of each arch, in words."""
        return self.vault.kinds

    @property
    def depth_of_stone(self) -> float | None:
        """How thick its masonry is drawn [m]; None for as thick as that of all."""
        return self.thickness

    def numbers(self) -> Mapping[str, Estimate]:
        """Its parameters, then the sizes that follow."""
        values, lengths = self.vault.values(), derived_declarations(type(self.vault))
        found = {p.name: Estimate(values[p.name], p.range.unit, None, p.range.meaning) for p in self.vault.parameters()}
        return found | {
            name: Estimate(value, lengths[name].unit, None, lengths[name].meaning, derived=True)
            for name, value in self.vault.derived_values().items()
        }


@dataclass(frozen=True)
class FittedVault(PlacedVault):
    """One vault of the scan: family with its parameters, pose, how sure, and how far the stone is from it."""

    confidence: float
    alternatives: tuple[tuple[str, float], ...]  # family ids and scores, best first
    parameters: Mapping[str, Estimate]
    components: tuple[Component, ...]
    deviation: Deviation
    coverage: float
    converged: bool = True
    as_built: Deviation | None = None  # of points that had no part in the surface; likewise:
    nurbs: Deviation | None = None  # from free surfaces, where they were asked for
    covariance: Covariance | None = None
    tolerance: float = 0.03  # m, half of the band that its points lie in
    odds: Mapping[str, Mapping[str, float]] = field(default_factory=dict)  # of each arch: kind -> chance
    rivals: tuple[Rival, ...] = ()  # how it may have been built; this one first, then the likeliest
    deformation: Deformation | None = None  # how it seems to have moved
    doubt: str = ""  # why it may be of none of the families, or of another, where that is likely
    surface: Displacement | None = None  # in its own frame: where the ideal vault has p, its stone has p + surface(p)
    shell: Estimate | None = None  # thickness of its masonry [m], where the scan shows both faces

    @property
    def measured_shell(self) -> Estimate | None:
        """The thickness that it is drawn with [m], where that was measured and no other is asked for."""
        return self.shell if self.thickness is None else None

    @property
    def depth_of_stone(self) -> float | None:
        """As it was measured, unless another thickness is asked for."""
        return self.thickness if self.measured_shell is None else self.measured_shell.value

    @property
    def arches(self) -> dict[str, str]:
        """What is known of each arch's kind, in words: "semicircular or elliptical"."""
        kinds = self.vault.kinds.items()
        return {name: " or ".join(said(self.odds.get(name, {kind: 1.0}))) for name, kind in kinds}

    @property
    def unlike(self) -> str:
        """In a sentence that it may be of none of the families, or of another, and why; nothing where it is sure."""
        return f"Its family is unsure: nearest is a {self.vault.title}, but {self.doubt}." * bool(self.doubt)

    def numbers(self) -> Mapping[str, Estimate]:
        """As they were fitted."""
        return self.parameters

    def _repr_mimebundle_(self, include: object = None, exclude: object = None) -> dict[str, Any]:
        """What a notebook shows."""
        from vaultcad import notebook

        return notebook.of_fitted(self)


@dataclass(frozen=True)
class FittedArch(FittedVault):
    """An arch between vaults: its soffit, a barrel as long as the arch is wide, and how deep it is.

    depth: by which it stands out under what is on its south and on its north side [m]; NaN under a wall. beside: the
    vaults on these sides, by their numbers from 1; 0 for none. depth_std: standard deviations of the depths [m].
    line: of a rib, the kind of line of its vault that it runs along: "diagonal" or "wall".
    """

    depth: tuple[float, float] = (nan, nan)
    beside: tuple[int, int] = (0, 0)
    depth_std: tuple[float, float] = (nan, nan)
    line: str = ""

    @property
    def kind(self) -> str:
        """That of a rib's line; of others by what is beside it: transverse between two vaults, else a wall arch."""
        return self.line or ("transverse" if all(self.beside) else "wall")

    @property
    def ring(self) -> float | None:
        """Its depth [m]: the lesser of both sides, for more may be the wall on it; None where neither is known."""
        return min((side for side in self.depth if isfinite(side)), default=None)

    @property
    def ring_std(self) -> float | None:
        """Standard deviation of that [m]; None where it is not known."""
        known = [std for side, std in zip(self.depth, self.depth_std, strict=True) if side == self.ring]
        return next((std for std in known if isfinite(std)), None)

    @property
    def depth_of_stone(self) -> float | None:
        """Its ring, unless another thickness is asked for."""
        return self.ring if self.thickness is None else self.thickness


@dataclass(frozen=True)
class FittedPier:
    """A pier or column that stands free, upright from the floor to where arches or vaults spring from it.

    plan: "round", "rectangular", or "compound" if it steps back within its rectangle. pose: the middle of its foot, x
    along its width. parameters: `diameter` of a round one, `width` and `depth` along x and y of any other, both of its
    shaft, and `height` to the springing, base and capital included [m]. points: of the scan on its shaft. deviation: of
    those from its sides. covariance: of x, y, z, yaw and the parameters.
    """

    plan: str
    pose: Pose
    parameters: Mapping[str, Estimate]
    points: int
    deviation: Deviation
    covariance: Covariance

    @property
    def size(self) -> tuple[float, float, float]:
        """Along x, along y, and its height [m]."""
        names = ("diameter", "diameter") if self.plan == "round" else ("width", "depth")
        width, depth, height = (self.parameters[name].value for name in (*names, "height"))
        return width, depth, height


Drawn = Literal["ideal", "as-built", "both"]
"""What is drawn of a vault: as its family has it, as its stone stands, or both beside each other."""


@dataclass(frozen=True, kw_only=True)
class Assembly:
    """Vaults in one place, as exporters take them: drawn, or of a `Model`, which has the scan that they are of.

    Geometry is local to `origin` [m]; `thickness` is that of the solids [m].
    """

    scan: Path  # of what they are, which gives files their names: a scan, or a document by its name
    origin: NDArray[np.float64]  # (3,)
    vaults: tuple[PlacedVault, ...]
    arches: tuple[PlacedVault, ...] = ()  # between them, each a barrel as long as it is wide
    thickness: float = 0.15
    versions: Mapping[str, str] = field(default_factory=dict)
    unit: float = 1.0  # m, of x and y in the scan
    crs: Crs | None = None  # that the scan declares
    notes: tuple[Note, ...] = ()  # what was assumed, left out or changed
    drawn: Drawn = "both"  # in files of bodies; the stone where it is known, else the ideal vault

    def surfaces(self, placed: PlacedVault) -> tuple[Displacement | None, ...]:
        """What displaces each body that is drawn of one of its vaults or arches; None: nothing, it is the ideal one."""
        own = placed.surface if isinstance(placed, FittedVault) else None
        if own is None or self.drawn == "ideal":
            return (None,)
        return (own,) if self.drawn == "as-built" else (None, own)

    def check_number(self, number: int) -> None:
        """See that a vault has that number, counted from 1; raises NoSuchVaultError where none does."""
        if not 1 <= number <= len(self.vaults):
            raise NoSuchVaultError(f"vault {number}: there is none; give 1 to {len(self.vaults)}")

    def thickness_of(self, placed: PlacedVault) -> float:
        """Of the masonry of one of its vaults or arches [m]."""
        own = placed.depth_of_stone
        return self.thickness if own is None else own

    @property
    def identity(self) -> str:
        """By which it is known again: what ids in files follow from."""
        return self.scan.name

    @property
    def place(self) -> str:
        """In words to what the geometry is relative: "origin 500000 4700000 0 m, EPSG:32633"."""
        origin = " ".join(f"{float(v):.10g}" for v in self.origin)
        return f"origin {origin} m" + ("" if self.crs is None else f", {self.crs.title}")


@dataclass(frozen=True, kw_only=True)
class Model(Assembly):
    """All that one run says of one scan."""

    vaults: tuple[FittedVault, ...]
    arches: tuple[FittedArch, ...] = ()
    piers: tuple[FittedPier, ...] = ()
    ceiling: Mapping[str, float] = field(default_factory=dict)  # m² over rooms: `area`, and what of it is what
    points: int
    bounds: NDArray[np.float64]  # (2, 3) in the scan's own coordinates
    settings: Mapping[str, Any] = field(default_factory=dict)
    seconds: Mapping[str, float] = field(default_factory=dict)  # stage -> time; in no file, as it is never the same

    @property
    def identity(self) -> str:
        """The scan, by its name and its points."""
        return f"{self.scan.name}/{self.points}/{self.bounds.round(3).tolist()}"

    def _repr_mimebundle_(self, include: object = None, exclude: object = None) -> dict[str, Any]:
        """What a notebook shows."""
        from vaultcad import notebook

        return notebook.of_model(self)
