"""Finding the vaults of a scan: a region is one vault if a family explains it, else its bays are tried each alone."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from families import Lunette, Vault
from vaultcad.arches import bay_of, without_arches
from vaultcad.bays import Ceiling, Region
from vaultcad.errors import NoVaultError
from vaultcad.freedom import NONE, Demands
from vaultcad.label import label
from vaultcad.recognise import Hypothesis, recognise
from vaultcad.refine import Refined, refine
from vaultcad.site import STEEP, Site, Thin, find_site
from vaultcad.solve import Placed
from vaultcad.uncertainty import covariance, slopes_of_sizes

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

TOLERANCE = (0.03, 0.12)  # m, limits of the band that a vault's points lie in
BAND = 4.0  # that band in scatters of the fit
EXPLAINED = 0.65  # share of what hangs over the springing that a vault must explain
ALIGNED = 0.8  # cosine between the normals of scan and model where a point is explained
MOST, LEVEL = (0.1, 0.9), 0.02  # most of a ceiling, and its rise / shorter side below which it is level
FLAT = 0.05  # rise / shorter side of the plan below which a ceiling is no vault
ROUGH = 0.02, 0.006  # m, and share of its rise or half span, that the stone of a vault is off it at most (rms)
NARROW = 0.9  # m, span of a part of a scan that is rather an arch, or nothing
LOW = 0.15  # rise / shorter side below which a rise has to be known
VAGUE = 0.1  # rms / rise from which on a model says nothing
SURE = 0.9  # share of the ceiling over a region from which on its bays are not tried
HIGH = 0.93  # crown of lunettes / crown of their barrel from which on they may be groin vaults in a row
GAIN = 1.05  # the bays must explain so much more than one vault over all of them
FILLED = 0.4  # share of a bay's plan that its vault must be seen on


@dataclass(frozen=True)
class Found:
    """One vault of a scan. hypotheses: the most likely first. tolerance: of the band its points lie in [m]."""

    site: Site
    hypotheses: tuple[Hypothesis, ...]
    refined: Refined
    tolerance: float

    @property
    def placed(self) -> Placed:
        """The vault where it stands."""
        return self.refined.placed


def find_vaults(
    thin: Thin,
    xyz: NDArray[np.floating],
    families: Sequence[type[Vault]],
    rng: np.random.Generator,
    demands: Demands = NONE,
) -> tuple[Found, ...]:
    """All vaults of a scan, from its thinned points and all of them (n, 3) [m], with what is demanded of each.

    Raises:
        NoVaultError: there is none.
    """
    search = _Search(thin, xyz, Ceiling.of(thin), tuple(families), rng, demands)
    found = search.region(search.ceiling.room)
    if not found:
        raise search.refusals[0]
    return tuple(found)


@dataclass(frozen=True)
class _Search:
    """One search: what it searches, and why regions were refused, the whole scan first."""

    thin: Thin
    xyz: NDArray[np.floating]
    ceiling: Ceiling
    families: tuple[type[Vault], ...]
    rng: np.random.Generator
    demands: Demands = NONE
    refusals: list[NoVaultError] = field(default_factory=list)

    def region(self, region: Region, *, part: bool = False) -> list[Found]:
        """The vaults over a region."""
        try:
            one = self._fit(region, part)
        except NoVaultError as error:
            self.refusals.append(error)
            one = None
        parts = self.ceiling.parts(region)
        if (len(parts) == 1 and parts[0] is region) or (one and self._settled(one, region)):
            return [one] if one else []
        bays = [found for bay in parts for found in self.region(bay, part=True)]
        if one is None:
            return bays
        gain = 1 / GAIN if _in_a_row(one) else GAIN
        return bays if self._explained(bays, region) > gain * self._explained([one], region) else [one]

    def _fit(self, region: Region, part: bool) -> Found:
        """One vault over all of a region, which may be a part of the scan only.

        Raises:
            NoVaultError: none is near enough to what hangs there, or too little of it is there.
        """
        found = self._without_arches(region)
        vault = found.placed.vault
        seen = self._explained([found], region) * self.ceiling.cell**2
        short = 2 * min(vault.plan.half_x, vault.plan.half_y)
        if part and short < NARROW:
            raise NoVaultError(f"no vault found: a {vault.title} of {short:.1f} m is an arch, if anything")
        if part and seen < FILLED * 4 * vault.plan.half_x * vault.plan.half_y:
            raise NoVaultError(f"no vault found: {seen:.1f} m² of a {vault.title} are too little of it")
        return found

    def _without_arches(self, region: Region) -> Found:
        """One vault over a region, or over what of it lies between arches.

        Raises:
            NoVaultError: none is near enough to what hangs there.
        """
        thin, xyz = bay_of(self.thin, self.xyz, region)
        inner_thin, inner = without_arches(thin, xyz, region)
        if len(inner_thin.points) == len(thin.points):
            return self._one(thin, xyz)
        found = self._one(inner_thin, xyz[inner.holds(xyz)])
        plan = found.placed.vault.plan
        if not (plan.on_wall_x or plan.on_wall_y):
            return found
        # A vault that stands on walls has no arches on its sides; lunettes look like them.
        with suppress(NoVaultError):
            whole = self._one(thin, xyz)
            if self._explained([whole], region) > GAIN * self._explained([found], region):
                return whole
        return found

    def _one(self, thin: Thin, xyz: NDArray[np.floating]) -> Found:
        """One vault over all these points, thinned and all of them.

        Raises:
            NoVaultError: none is near enough to what hangs there.
        """
        site = find_site(thin, xyz)
        hypotheses = recognise(site, self.rng, families=self.families, demands=self.demands)
        refined = refine(hypotheses[0], site, self.rng, demands=self.demands)
        found = Found(site, hypotheses, refined, float(np.clip(BAND * refined.scatter, *TOLERANCE)))
        check(found.placed, site, found.tolerance)
        _check_rise(refined)
        return found

    def _settled(self, one: Found, region: Region) -> bool:
        """Whether one vault explains so much of a region that its bays need not be tried."""
        return not _in_a_row(one) and self._explained([one], region) >= SURE * len(self.ceiling.points(region))

    def _explained(self, found: Sequence[Found], region: Region) -> int:
        """Over how many of the ceiling's cells of a region the vaults hang."""
        points = self.ceiling.points(region)
        labels = label(points, [(one.placed, one.tolerance) for one in found])
        return int((labels.vault > 0).sum())


def _in_a_row(found: Found) -> bool:
    """Whether a vault with lunettes might be a row of groin vaults."""
    vault = found.placed.vault
    return (
        isinstance(vault, Lunette)
        and vault.count > 1
        and vault.lunette_springing + vault.lunette_rise > HIGH * vault.rise
    )


def on_vault(placed: Placed, points: Array, normals: Array, tolerance: float) -> Mask:
    """Which points (n, 3) with normals (n, 3) are nearer than `tolerance` [m] to a vault and face as it does."""
    surface = placed.vault.evaluate(points, frame=placed.pose.frame(), walls=True)
    along = np.abs(np.einsum("nc,nc->n", surface.normal, normals))
    near: Mask = (np.abs(surface.distance) < tolerance) & (along > ALIGNED) & (surface.component > 0)
    return near


def check(placed: Placed, site: Site, tolerance: float) -> None:
    """Refuse what is no vault.

    Raises:
        NoVaultError: a flat ceiling, or a model that most of what hangs over its springing is far from.
    """
    vault, plan = placed.vault, placed.vault.plan
    local = site.points @ placed.pose.frame()[:, :3].T + placed.pose.frame()[:, 3]
    inside = (np.abs(local[:, 0]) < plan.half_x) & (np.abs(local[:, 1]) < plan.half_y)
    above = inside & (local[:, 2] > 0) & (np.abs(site.normals[:, 2]) > STEEP)
    rise, short = vault.derived_values()["rise"], 2 * min(plan.half_x, plan.half_y)
    spread = float(np.ptp(np.quantile(local[above, 2], MOST))) if above.any() else 0.0
    if rise < FLAT * short or spread < LEVEL * short:
        raise NoVaultError(
            f"no vault found: the best model rises {rise:.2f} m, most of the ceiling {spread:.2f} m, which is flat; "
            "crop the scan to one bay"
        )
    on = on_vault(placed, site.points[above], site.normals[above], tolerance) if above.any() else above[:0]
    _check_smooth(placed, site.points[above][on], rise, short)
    share = float(on.mean()) if len(on) else 0.0
    if share < EXPLAINED:
        raise NoVaultError(
            f"no vault found: the best model, a {vault.title}, explains {share:.0%} of what hangs over its springing; "
            "crop the scan to one vaulted bay"
        )


def _check_rise(refined: Refined) -> None:
    """Refuse a low vault whose rise may as well be none.

    Raises:
        NoVaultError: it may.
    """
    vault, plan = refined.placed.vault, refined.placed.vault.plan
    rise = vault.derived_values()["rise"]
    if rise > LOW * 2 * min(plan.half_x, plan.half_y):
        return
    solution = refined.loose
    std = covariance(solution, refined.points).std(slopes_of_sizes(solution)["rise"])
    if std > rise:
        raise NoVaultError(
            f"no vault found: the best model, a {vault.title}, rises {rise:.2f} ± {std:.2f} m: the ceiling may be level"
        )


def _check_smooth(placed: Placed, points: Array, rise: float, short: float) -> None:
    """Refuse a model that its own points (n, 3) [m] are too far from: masonry settles, but is smooth.

    rise, short: of the model, and the shorter side of its plan [m].

    Raises:
        NoVaultError: they are.
    """
    if len(points) == 0:
        return
    rms = float(np.sqrt(np.mean(placed.distance(points) ** 2)))
    if rms > min(ROUGH[0] + ROUGH[1] * min(rise, short / 2), VAGUE * rise):
        raise NoVaultError(
            f"no vault found: the surface is {100 * rms:.1f} cm off the best model, a {placed.vault.title} that rises "
            f"{rise:.2f} m; that is too rough for a vault"
        )
