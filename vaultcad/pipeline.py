"""From a scan to a model: the stages in their order, each a function of its own."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, fields, replace
from math import hypot, isfinite, pi, sqrt
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from families import FAMILIES, Vault
from families.void import kernel
from segmentation.cloud import Cloud
from segmentation.io.columns import corners
from segmentation.notes import Note
from vaultcad.change.reading import read_deformation
from vaultcad.change.stonework import Stonework
from vaultcad.deformation import Deformation
from vaultcad.displacement import Displacement
from vaultcad.errors import NoVaultError
from vaultcad.find.arches import FoundArch
from vaultcad.find.choices import odds, rivals, widened
from vaultcad.find.findings import Findings, find_vaults
from vaultcad.find.found import Found
from vaultcad.fit.demands import demand
from vaultcad.fit.freedom import RECTANGLE, Demands
from vaultcad.fit.label import Labels, label
from vaultcad.fit.solve import Placed
from vaultcad.fit.uncertainty import covariance, open_ends
from vaultcad.legible import legible
from vaultcad.measure.as_built import as_built
from vaultcad.measure.ceiling import account, missed
from vaultcad.measure.coverage import look
from vaultcad.measure.deviation import summarise
from vaultcad.measure.estimates import estimates
from vaultcad.measure.piers import piers_under
from vaultcad.measure.shell import shell_of
from vaultcad.model import Component, FittedArch, FittedVault, Model
from vaultcad.one_thread import one_thread
from vaultcad.processes import spread
from vaultcad.survey.lean import lean_of
from vaultcad.survey.thinned_scan import Site, Thin, thin_scan
from vaultcad.uncertain import Estimate
from vaultcad.versions import versions

Array = NDArray[np.float64]
Progress = Callable[[str], None]

LOG = logging.getLogger(__name__)
LOOKED_AT = 50_000  # points of a vault at least, if it has as many, of which some measure the as-built surface
STAGES = ("thinning", "finding", "labelling", "measuring")
SPARSE = 0.09  # m between points, from which on the end of a vault without a wall is hard to tell
GUESSED_END = 0.2  # m, of an end that was cut by guess; such were 5 to 36 cm off in four scans
REGISTRATION = 0.001  # m, by which figures may be off as stations are registered to 1 to 3 mm


@dataclass(frozen=True)
class FitSettings:
    """What a user may ask of a fit."""

    families: tuple[type[Vault], ...] = field(default_factory=lambda: tuple(FAMILIES))
    seed: int = 0
    thickness: float = 0.15  # m, of the solid
    fix: Mapping[str, float | str] = field(default_factory=dict)  # sizes and place [m, rad, 1], kinds of arches
    free: tuple[str, ...] = ()  # names of constraints that are not kept
    rectangular: bool = False  # plans are rectangles, whatever the scan says


@dataclass(frozen=True)
class Result:
    """A fitted scan: the model, the label of each point, and the thinned cloud on which it was found.

    points: (k, 3) [m], local. component, vault: (k,) as in the labels. deviation: (k,) [m], NaN off the vaults.
    """

    model: Model
    labels: Labels
    points: Array
    component: NDArray[np.uint16]
    vault: NDArray[np.uint16]
    deviation: Array

    def _repr_mimebundle_(self, include: object = None, exclude: object = None) -> dict[str, Any]:
        """What a notebook shows."""
        from vaultcad import notebook

        return notebook.of_result(self)


@one_thread
def fit_scan(cloud: Cloud, settings: FitSettings | None = None, *, progress: Progress = lambda stage: None) -> Result:
    """Find, recognise, fit and measure the vaults in a scan.

    Raises:
        NoVaultError: the scan is too small, or no family explains what stands above its floor.
        ValueError: `fix` or `free` name what there is not; says what there is.

    >>> from segmentation import read
    >>> fitted = fit_scan(read("examples/room.laz")).model.vaults[0]
    >>> fitted.vault.id, round(fitted.parameters["span_x"].value, 2), fitted.deviation.loa
    ('groin', 4.61, 'LOA20')
    """
    settings = settings or FitSettings()
    families, demands = demand(settings.families, settings.fix, settings.free, cloud.origin.tolist())
    demands = replace(demands, rectangular=settings.rectangular)
    seconds: dict[str, float] = {}
    rng = np.random.default_rng(settings.seed)
    with _stage("thinning", seconds, progress):
        thin = thin_scan(cloud)
    lean, notes = lean_of(thin)
    scanned, xyz = thin, cloud.xyz
    if lean is not None:  # all that follows is upright, but for the poses and points of the result
        thin, xyz = lean.thinned(thin), lean.levelled(cloud.xyz)
    with _stage("finding", seconds, progress):
        found = find_vaults(thin, xyz, families, rng, demands, progress)
    bands = [(one.placed, one.tolerance) for one in found.vaults]
    arched = [one.band(one.faces(found.arches)) for one in found.arches]
    with _stage("labelling", seconds, progress):
        labels, thinned = label(xyz, bands, arched), label(thin.points, bands, arched)
    with _stage("measuring", seconds, progress):
        scan = _Labelled(xyz, labels, thin, thinned, demands, len(cloud.stations) > 1)
        vaults, arches = scan.measured(found, rng)
        piers = piers_under(vaults, arches, thin)
        ceiling, unexplained = account(found.hung, bands, arched)
    if lean is not None:
        vaults = tuple(replace(fitted, pose=lean.pose(fitted.pose)) for fitted in vaults)
        arches = tuple(replace(fitted, pose=lean.pose(fitted.pose)) for fitted in arches)
        piers = tuple(replace(pier, pose=lean.pose(pier.pose)) for pier in piers)
    model = Model(
        scan=legible(cloud.source or Path("scan")),
        points=len(cloud),
        bounds=corners(cloud),
        origin=cloud.origin,
        vaults=vaults,
        arches=arches,
        piers=piers,
        ceiling=ceiling,
        thickness=settings.thickness,
        settings={
            "families": [f.id for f in settings.families],
            "seed": settings.seed,
            "thickness": settings.thickness,
            "fix": dict(settings.fix),
            "free": sorted(settings.free),
            "up": cloud.up,
            "scale": cloud.scale.tolist(),
            "voxel": round(thin.spacing, 4),
        },
        versions=versions(),
        seconds=seconds,
        unit=float(cloud.scale[0]),
        crs=cloud.crs,
        notes=(
            *cloud.notes,
            *notes,
            *(() if RECTANGLE.name in demands.freed else _askew(vaults)),
            *missed(ceiling, unexplained + cloud.origin[:2]),
        ),
    )
    return Result(model, labels, scanned.points, thinned.component, thinned.vault, thinned.deviation.astype(np.float64))


def _askew(vaults: Sequence[FittedVault]) -> Iterator[Note]:
    """What is to be said of vaults whose plans the scan shows to be no rectangles."""
    off = {
        number: float(np.linalg.norm(fitted.vault.corners - replace(fitted.vault, skew=None).corners, axis=1).max())
        for number, fitted in enumerate(vaults, 1)
        if fitted.vault.skew is not None
    }
    if off:
        which = f" of vault{'s' if len(off) > 1 else ''} {', '.join(map(str, off))}" if len(vaults) > 1 else ""
        text = f"the plan{which} is no rectangle: corners are off by up to {100 * max(off.values()):.1f} cm"
        yield Note("corners", text + ", and were fitted free")


@contextmanager
def _stage(name: str, seconds: dict[str, float], progress: Progress) -> Iterator[None]:
    progress(name)
    start = time.perf_counter()
    yield
    seconds[name] = time.perf_counter() - start
    LOG.info("%s took %.3f s", name, seconds[name])


@dataclass(frozen=True)
class _Labelled:
    """The scan as it was labelled, and thinned likewise; several: whether it is known to be of several stations."""

    xyz: NDArray[np.floating]
    labels: Labels
    thin: Thin
    thinned: Labels
    demands: Demands
    several: bool

    def measured(
        self, found: Findings, rng: np.random.Generator
    ) -> tuple[tuple[FittedVault, ...], tuple[FittedArch, ...]]:
        """The figures of all vaults and arches.

        Raises:
            NoVaultError: not one point lies on one of them.
        """
        vaults, arches = found.vaults, found.arches
        rngs = rng.spawn(len(vaults) + len(arches))

        def work(k: int) -> FittedVault:
            if k < len(vaults):
                fitted = self.vault(vaults[k], k + 1, rngs[k])
                return replace(fitted, deformation=self._moved(vaults[k], fitted.surface))
            return self.arch(arches[k - len(vaults)], k - len(vaults) + 1, vaults, rngs[k])

        figures = list(spread(work, len(rngs)))
        return tuple(figures[: len(vaults)]), tuple(one for one in figures if isinstance(one, FittedArch))

    def _moved(self, found: Found, surface: Displacement | None) -> Deformation | None:
        """How a vault seems to have moved since it was built."""
        registration = REGISTRATION if self.several else 0.0
        stonework = Stonework.about(found.placed, found.site.points)
        return read_deformation(
            found.refined, found.choices, self.demands, surface, stonework=stonework, registration=registration
        )

    def vault(self, found: Found, number: int, rng: np.random.Generator) -> FittedVault:
        """The figures of the vault with that number.

        Raises:
            NoVaultError: not one point lies on it.
        """
        (points,) = np.nonzero(self.labels.vault == number)
        mine = self.thinned.vault == number
        fitted = _measured(found, self, points, mine, self.labels.component[points], rng)
        return replace(fitted, shell=self._shell(found.placed, fitted.surface))

    def _shell(self, placed: Placed, surface: Displacement | None) -> Estimate | None:
        """How thick a vault's masonry is, where the scan shows its back."""
        frame, half = placed.pose.frame(), placed.vault.plan.half
        over = kernel.over_plan(np.ascontiguousarray(self.thin.points), frame, half, 0.0)
        other = over[(self.thinned.vault[over] == 0) & (self.thinned.arch[over] == 0)]
        local = self.thin.points[other] @ frame[:, :3].T + frame[:, 3]
        return shell_of(placed.vault, local, self.thin.normals[other] @ frame[:, :3].T, surface)

    def arch(self, found: FoundArch, number: int, vaults: Sequence[Found], rng: np.random.Generator) -> FittedArch:
        """The figures of the arch with that number.

        Raises:
            NoVaultError: not one point lies on it.
        """
        (points,) = np.nonzero(self.labels.arch == number)
        mine = self.thinned.arch == number
        fitted = _measured(found.barrel, self, points, mine, np.ones(len(points), np.uint16), rng)
        (south, north), (south_std, north_std) = found.depth.tolist(), found.depth_std.tolist()
        if isfinite(found.soffit.width_std):
            width = replace(fitted.parameters["length"], std=found.soffit.width_std)
            fitted = replace(fitted, parameters={**fitted.parameters, "length": width})
        known = {f.name: getattr(fitted, f.name) for f in fields(fitted)}
        beside, std = found.beside(vaults), (south_std, north_std)
        return FittedArch(**known, depth=(south, north), beside=beside, depth_std=std, line=found.line)


def _measured(
    found: Found,
    scan: _Labelled,
    points: NDArray[np.int64],
    mine: NDArray[np.bool_],
    component: NDArray[np.uint16],
    rng: np.random.Generator,
) -> FittedVault:
    """The figures of a vault: its points (n,), each of a component (n,), and which of the thinned ones are.

    Raises:
        NoVaultError: not one is.
    """
    placed, frame = found.placed, found.placed.pose.frame()
    thin = scan.thin
    if not mine.any():
        raise NoVaultError("no vault found: no point lies on the best model; scan a whole bay, or crop to one")
    on = thin.points[mine] @ frame[:, :3].T + frame[:, 3]
    sight = look(placed.vault, on, 2.5 * thin.spacing, rng)
    solution, fitted = found.refined.loose, found.refined.points
    spread = found.unsure(covariance(solution, fitted))
    apart = _open_ends(found.site, placed)
    if any(apart):
        spread = replace(spread, matrix=spread.matrix + open_ends(solution, apart))
    told = estimates(solution, fitted, sight, spread, found.choices, found.shared)
    deviation = scan.labels.deviation[points]
    some = slice(None, None, max(1, len(points) // LOOKED_AT))
    stone = as_built(placed.vault, on, scan.xyz[points[some]] @ frame[:, :3].T + frame[:, 3], found.tolerance, rng)
    components = []
    for k, name in enumerate(placed.vault.components, 1):
        d = deviation[component == k]
        rest = stone.distances[component[some][stone.which] == k] if stone is not None else d[:0]
        known = (summarise(part) if len(part) else None for part in (d, rest))
        components.append(Component(k, name, len(d), next(known), sight.of(k), next(known)))
    ranking = found.confidence
    return FittedVault(
        vault=placed.vault,
        pose=placed.pose,
        confidence=ranking[0],
        alternatives=tuple((h.vault.id, c) for h, c in zip(found.hypotheses[1:], ranking[1:], strict=True)),
        parameters=told,
        components=tuple(components),
        deviation=summarise(deviation),
        coverage=sight.whole,
        converged=solution.converged,
        as_built=None if stone is None else summarise(stone.distances),
        surface=None if stone is None else stone.surface,
        covariance=widened(spread, placed, found.choices),
        tolerance=found.tolerance,
        odds=odds(found.choices),
        rivals=rivals(found.choices, placed),
        doubt=found.doubt,
    )


def _open_ends(site: Site, placed: Placed) -> tuple[float, float]:
    """How unsure the plan's half extents are along the vault's x and y [m], and the middle between its ends.

    Sparse scans tell little without walls, and a cut through one ceiling nothing but that the vault ends near by.
    """
    x, y = (
        hypot(
            0.0 if both.all() or site.spacing < SPARSE else site.spacing,
            GUESSED_END / 2 * sqrt(sum((axis, side) in site.guessed for side in (0, 1))),
        )
        for axis, both in enumerate(site.walled)
    )
    return (y, x) if round((placed.pose.yaw - site.yaw) / (pi / 2)) % 2 else (x, y)
