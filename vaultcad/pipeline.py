"""From a scan to a model: the stages in their order, each a function of its own."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from families import FAMILIES, Vault
from families.parameters import derived_declarations
from segmentation.cloud import Cloud
from vaultcad.as_built import displacement
from vaultcad.coverage import coverage
from vaultcad.deviation import summarise
from vaultcad.errors import NoVaultError
from vaultcad.label import Labels, label
from vaultcad.model import Component, Deviation, Estimate, FittedVault, Model
from vaultcad.recognise import Hypothesis, confidence, count_blocks, recognise
from vaultcad.refine import Refined, refine
from vaultcad.site import STEEP, Site, survey
from vaultcad.solve import Placed
from vaultcad.uncertainty import covariance, derived_std
from vaultcad.versions import versions

Array = NDArray[np.float64]
Progress = Callable[[str], None]

STAGES = ("thinning", "recognising", "fitting", "labelling", "measuring")
TOLERANCE = (0.03, 0.12)  # m, limits of the band that a vault's points lie in
BAND = 4.0  # that band in scatters of the fit
EXPLAINED = 0.65  # share of what hangs over the springing that a vault must explain
ALIGNED = 0.8  # cosine between the normals of scan and model where a point is explained
FLAT = 0.05  # rise / shorter side of the plan below which a ceiling is no vault
AS_BUILT = 20_000  # points of the as-built surface; half of them make it, the other half measure it


@dataclass(frozen=True)
class Settings:
    """What a user may ask of a fit."""

    families: tuple[type[Vault], ...] = FAMILIES
    seed: int = 0
    thickness: float = 0.15  # m, of the solid


@dataclass(frozen=True)
class Result:
    """A fitted scan: the model, the label of each point, and the thinned cloud on which it was found.

    points: (k, 3) [m], local. component: (k,) as in the labels. deviation: (k,) [m], NaN off the vault.
    """

    model: Model
    labels: Labels
    points: Array
    component: NDArray[np.uint16]
    deviation: Array


def fit_scan(cloud: Cloud, settings: Settings = Settings(), *, progress: Progress = lambda stage: None) -> Result:
    """Find, recognise, fit and measure the vault in a scan.

    Raises:
        NoVaultError: the scan is too small, or no family explains what stands above its floor.
    """
    seconds: dict[str, float] = {}
    rng = np.random.default_rng(settings.seed)
    with _stage("thinning", seconds, progress):
        site = survey(cloud)
    with _stage("recognising", seconds, progress):
        hypotheses = recognise(site, rng, families=settings.families)
    with _stage("fitting", seconds, progress):
        refined = refine(hypotheses[0], site, count_blocks(site), rng)
        tolerance = float(np.clip(BAND * refined.scatter, *TOLERANCE))
        _check(refined.placed, site, tolerance)
    with _stage("labelling", seconds, progress):
        labels = label(cloud.xyz, refined.placed, tolerance)
        thinned = label(site.points, refined.placed, tolerance)
    with _stage("measuring", seconds, progress):
        vault = _measured(refined, hypotheses, labels, site, thinned, rng)
    ends = cloud.in_file(np.array([cloud.xyz.min(axis=0), cloud.xyz.max(axis=0)]))
    model = Model(
        scan=cloud.source or Path("scan"),
        points=len(cloud),
        bounds=np.sort(ends, axis=0),
        origin=cloud.origin,
        vaults=(vault,),
        thickness=settings.thickness,
        settings={
            "families": [f.id for f in settings.families],
            "seed": settings.seed,
            "thickness": settings.thickness,
            "up": cloud.up,
            "voxel": round(site.spacing, 4),
            "tolerance": round(tolerance, 4),
        },
        versions=versions(),
        seconds=seconds,
    )
    return Result(model, labels, site.points, thinned.component, thinned.deviation.astype(np.float64))


@contextmanager
def _stage(name: str, seconds: dict[str, float], progress: Progress) -> Iterator[None]:
    progress(name)
    start = time.perf_counter()
    yield
    seconds[name] = time.perf_counter() - start


def _check(placed: Placed, site: Site, tolerance: float) -> None:
    """Refuse what is no vault: a flat ceiling, or a model that most of what hangs over its springing is far from."""
    vault, plan = placed.vault, placed.vault.plan
    rise = vault.derived_values()["rise"]
    if rise < FLAT * 2 * min(plan.half_x, plan.half_y):
        raise NoVaultError(
            f"no vault found: the best model rises {rise:.2f} m, which is a flat ceiling; crop the scan to one bay"
        )
    local = site.points @ placed.pose.frame()[:, :3].T + placed.pose.frame()[:, 3]
    inside = (np.abs(local[:, 0]) < plan.half_x) & (np.abs(local[:, 1]) < plan.half_y)
    above = inside & (local[:, 2] > 0) & (np.abs(site.normals[:, 2]) > STEEP)
    surface = vault.evaluate(site.points[above], frame=placed.pose.frame(), walls=True)
    along = np.abs(np.einsum("nc,nc->n", surface.normal, site.normals[above]))
    share = float(((np.abs(surface.distance) < tolerance) & (along > ALIGNED)).sum() / max(1, above.sum()))
    if share < EXPLAINED:
        raise NoVaultError(
            f"no vault found: the best model, a {vault.title}, explains {share:.0%} of what hangs over its springing; "
            "crop the scan to one vaulted bay"
        )


def _measured(
    refined: Refined,
    hypotheses: Sequence[Hypothesis],
    labels: Labels,
    site: Site,
    thinned: Labels,
    rng: np.random.Generator,
) -> FittedVault:
    """The figures of a fitted vault.

    Raises:
        NoVaultError: not one point lies on it.
    """
    placed, frame = refined.placed, refined.placed.pose.frame()
    mine = thinned.component > 0
    if not mine.any():
        raise NoVaultError("no vault found: no point lies on the best model; scan a whole bay, or crop to one")
    on = site.points[mine] @ frame[:, :3].T + frame[:, 3]
    shares, whole = coverage(placed.vault, on, 2.5 * site.spacing, rng)
    components = []
    for k, name in enumerate(placed.vault.components, 1):
        d = labels.deviation[labels.component == k]
        components.append(Component(k, name, len(d), summarise(d) if len(d) else None, shares[name]))
    ranking = confidence(hypotheses)
    return FittedVault(
        vault=placed.vault,
        pose=placed.pose,
        confidence=ranking[0],
        alternatives=tuple((h.vault.id, c) for h, c in zip(hypotheses[1:], ranking[1:], strict=True)),
        parameters=_estimates(refined),
        components=tuple(components),
        deviation=summarise(labels.deviation[labels.component > 0]),
        coverage=whole,
        converged=refined.solution.converged,
        as_built=_as_built(placed, on, thinned.deviation[mine].astype(np.float64), rng),
    )


def _as_built(placed: Placed, on: Array, distances: Array, rng: np.random.Generator) -> Deviation | None:
    """How far the points (n, 3), in the vault's frame, are from the as-built surface; None if they are too few."""
    order = rng.permutation(len(on))[:AS_BUILT]
    fit, held = order[::2], order[1::2]
    if len(held) < 100:
        return None
    normals = placed.vault.evaluate(on[order]).normal
    field_ = displacement(on[fit], normals[::2], distances[fit])
    return summarise(distances[held] - np.einsum("nc,nc->n", field_(on[held]), normals[1::2]))


def _estimates(refined: Refined) -> dict[str, Estimate]:
    """All parameters and derived sizes with their standard deviations; those held in the fit have none."""
    vault, names = refined.placed.vault, refined.solution.names
    cov = covariance(refined.solution, refined.points)
    std: Mapping[str, float] = dict(zip(names, np.sqrt(np.maximum(np.diag(cov), 0.0)).tolist(), strict=True))
    values, derived = vault.values(), vault.derived_values()
    declared = derived_declarations(type(vault))
    derived_stds = derived_std(refined.placed, names, cov)
    found = {
        p.name: Estimate(values[p.name], p.range.unit, std.get(p.name), p.range.meaning) for p in vault.parameters()
    }
    for name, value in derived.items():
        found[name] = Estimate(
            value, declared[name].unit, derived_stds[name] or None, declared[name].meaning, derived=True
        )
    return found
