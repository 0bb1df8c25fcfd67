"""What is no vault, though a family comes near it: level ceilings, rough rock, models that explain little.

Measured on virtual scans (29 November 2026): the stone of vaults that had settled by up to 10 cm was at most 3.6 cm off
the fitted family (rms), tunnels, caves and roofs at least 4.7 cm; of mirror vaults at most 85 % of the points lay in a
layer 3 cm high, of ceilings with beams, coffers and panels at least 87 %; lesser components, lunettes beside a barrel
for example, were at most 3.2 cm off the stone, those made up under roofs at least 5.9 cm. `python -m bench barren`
counts what these limits let through and what they lose.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vaultcad.errors import NoVaultError, OtherThingError
from vaultcad.find.refine import Refined
from vaultcad.fit.solve import Placed
from vaultcad.fit.uncertainty import covariance, slopes_of_sizes
from vaultcad.survey.thinned_scan import STEEP, Site, inside, support, turned

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

EXPLAINED = 0.65  # share of what hangs over the springing that a vault must explain
ALIGNED = 0.8  # cosine between the normals of scan and model where a point is explained
MOST, LEVEL_CEILING = (0.1, 0.9), 0.02  # most of a ceiling, and its rise / shorter side below which it is level
FLAT = 0.05  # rise / shorter side of the plan below which a ceiling is no vault
ROUGH = 0.03, 0.005  # m, and share of its rise or half span, that the stone of a vault is off it at most (rms)
LOW = 0.15  # rise / shorter side below which a rise has to be known
UNKNOWN = 1.5  # standard deviation / rise, of a low vault, from which on it may be none
VAGUE = 0.1  # rms / rise from which on a model says nothing
LOOSE, FEW = 0.045, 20  # m that the lesser components may be off the stone (rms), and points that tell it
LEVELED = 0.03, 0.86  # m, height of a level layer, and the share of a model's points in one from which it is no vault
ALL_LEVEL = 0.97  # share of what hangs over a site in such a layer, from which on nothing is tried


def on_vault(placed: Placed, points: Array, normals: Array, tolerance: float) -> Mask:
    """Which points (n, 3) with normals (n, 3) are nearer than `tolerance` [m] to a vault and face as it does."""
    surface = placed.vault.evaluate(points, frame=placed.pose.frame(), walls=True)
    along = np.abs(np.einsum("nc,nc->n", surface.normal, normals))
    near: Mask = (np.abs(surface.distance) < tolerance) & (along > ALIGNED) & (surface.component > 0)
    return near


class PartlyError(NoVaultError):
    """A model explains some of what hangs over a region: placed, in a band of half that tolerance [m]."""

    def __init__(self, message: str, placed: Placed, tolerance: float) -> None:
        super().__init__(message)
        self.placed, self.tolerance = placed, tolerance

    def __reduce__(self) -> tuple[type[PartlyError], tuple[str, Placed, float]]:
        """As it goes to another process."""
        return type(self), (str(self), self.placed, self.tolerance)


def check(refined: Refined, site: Site, tolerance: float) -> None:
    """Refuse what is no vault.

    Raises:
        NoVaultError: a level ceiling, a surface too rough for masonry, or a model that most of what hangs over its
            springing is far from, or that says nothing of its rise.
        PartlyError: such a model, where some of that is near it.
        OtherThingError: its family itself contradicts the model.
    """
    placed = refined.placed
    vault, plan = placed.vault, placed.vault.plan
    local = site.points @ placed.pose.frame()[:, :3].T + placed.pose.frame()[:, 3]
    inside = plan.holds(local[:, :2])
    above = inside & (local[:, 2] > 0) & (np.abs(site.normals[:, 2]) > STEEP)
    rise, short = vault.derived_values()["rise"], plan.width
    spread = float(np.ptp(np.quantile(local[above, 2], MOST))) if above.any() else 0.0
    if rise < FLAT * short or spread < LEVEL_CEILING * short:
        raise NoVaultError(
            f"no vault found: the best model rises {rise:.2f} m, most of the ceiling {spread:.2f} m, which is flat; "
            "crop the scan to one bay"
        )
    on = on_vault(placed, site.points[above], site.normals[above], tolerance) if above.any() else above[:0]
    _check_level(local[above][on, 2])
    _check_smooth(placed, site.points[above][on], rise, short)
    _check_lesser(placed, site.points[inside], tolerance)
    share = float(np.average(on, weights=support(site.counts[above]))) if len(on) else 0.0
    if share < EXPLAINED:
        raise PartlyError(
            f"no vault found: the best model, {vault.called}, explains {share:.0%} of what hangs over its springing; "
            "crop the scan to one vaulted bay",
            placed,
            tolerance,
        )
    if rise < LOW * short:
        _check_rise(refined, rise)
    if why := vault.contradiction(local, local[above][on], tolerance):
        raise OtherThingError(f"no vault found: {why}")


def check_bent(site: Site) -> None:
    """Refuse a site over which a level ceiling hangs, before any family is tried.

    Raises:
        NoVaultError: all but nothing of what hangs there is off one height.
    """
    over = inside(turned(site.points[:, :2], site.yaw), site.low, site.high)
    hung = over & (np.abs(site.normals[:, 2]) > STEEP)
    _check_level(site.points[hung, 2], ALL_LEVEL)


def _check_rise(refined: Refined, rise: float) -> None:
    """Refuse a low vault whose rise [m] may as well be none.

    Raises:
        NoVaultError: it may.
    """
    solution = refined.loose
    std = covariance(solution, refined.points).std(slopes_of_sizes(solution)["rise"])
    if std > UNKNOWN * rise:
        raise NoVaultError(
            f"no vault found: the best model, a {refined.placed.vault.title}, rises {rise:.2f} ± {std:.2f} m: "
            "the ceiling may be level"
        )


def _check_level(heights: Array, most: float = LEVELED[1]) -> None:
    """Refuse what lies at these heights (n,) [m] if a share of `most` of it is in one level plane.

    Raises:
        NoVaultError: they do.
    """
    if len(heights) == 0:
        return
    heights = np.sort(heights)
    counts = np.searchsorted(heights, heights + LEVELED[0], side="right") - np.arange(len(heights))
    share = float(counts.max() / len(heights))
    if share >= most:
        raise NoVaultError(
            f"no vault found: {share:.0%} of the ceiling lies within {100 * LEVELED[0]:g} cm of one height: "
            "a level ceiling, with beams or panels if anything"
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


def _check_lesser(placed: Placed, points: Array, tolerance: float) -> None:
    """Refuse a model whose lesser components, but for the largest, the points (n, 3) [m] near it do not follow.

    Raises:
        NoVaultError: they do not.
    """
    surface = placed.vault.evaluate(points, frame=placed.pose.frame(), walls=True)
    near = np.abs(surface.distance) < tolerance
    component, distance = surface.component[near], surface.distance[near]
    counts = np.bincount(component, minlength=len(placed.vault.components) + 1)
    squares = np.bincount(component, distance**2, len(counts))
    parts = [k for k in np.argsort(counts).tolist() if k > 0 and counts[k] >= FEW]
    lesser = parts[:-1]
    if not lesser:
        return
    typical = float(np.sqrt(np.median(squares[lesser] / counts[lesser])))
    if typical > LOOSE:
        raise NoVaultError(
            f"no vault found: the best model is a {placed.vault.title}, but the surface is {100 * typical:.1f} cm off "
            "its lesser parts, which is no vault"
        )
