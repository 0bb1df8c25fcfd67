"""The barrel over the soffit of an arch, as long as that is wide, and where it springs.

Of a segment its curve tells neither span nor rise, as that goes on below any springing. Nor does the stone under its
feet: capitals stand out there, and piers go back under these. But the crease at its feet is seen (`springings`). What
is all but round there has none, so that a semicircle beside a segment which springs higher stays as likely as it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import exp, hypot, inf, sqrt

import numpy as np
from numpy.typing import NDArray

from families import Segmental, Semicircular
from families.kinds.barrel import Barrel
from vaultcad.errors import NoVaultError
from vaultcad.find.choices import Choice
from vaultcad.find.found import Found, likeliest_of
from vaultcad.find.likeness import agree, choices_like, starts_like
from vaultcad.find.misfit import SURELY_OTHER, Misfit
from vaultcad.find.practice import PRACTICE
from vaultcad.find.recognise import recognise
from vaultcad.find.refine import refine
from vaultcad.fit.freedom import Demands
from vaultcad.fit.solve import POSE
from vaultcad.survey.soffits import Soffit
from vaultcad.survey.springings import Springing
from vaultcad.survey.thinned_scan import STEEP, UPRIGHT, Site, Thin, turned

Array = NDArray[np.float64]

BELOW = 1.0  # m of the piers under a soffit's ends that tell its span
BESIDE = 0.3  # m beyond those ends where the piers' faces may be
WITHIN = 0.02  # m within its edges from which on a point is the soffit's
ENDS = 0.1  # m between the points that tie its edges
LEVEL = 0.05, 3.0  # m, and standard deviations, by which the feet of one arch may differ in height
SETTLED = 0.012  # m by which feet have moved since they were built, up or apart
LONGER = 0.6  # m by which an arch may be longer than what is seen of its soffit
BEND = 0.045, 0.025  # of its radius, by which a foot is seen too high where there is no crease, and its deviation
CREASED = 0.12  # of its radius that a foot is above the centre of a segment, from which on there is one
ODD, GUESS = 0.02, 5.0  # m that stone scatters about an arch of another kind, and times by which sizes may be off then
WORSE = 1.3, 1e-3  # times, and m, by which its stone may scatter more if it springs from its feet
LEVELLED = "z", "rise"  # what is as unsure as the level of the springing


def fitted_soffit(
    soffit: Soffit, thin: Thin, rng: np.random.Generator, like: Found | None = None, feet: Sequence[Springing] = ()
) -> Found:
    """The barrel of a soffit, as long as that is wide; `like` is one from which it can begin, `feet` where it springs.

    Raises:
        NoVaultError: an arch of no kind comes near.
    """
    demands = Demands(sizes={"length": soffit.width, "slope": 0.0, "splay": 0.0}, pose={"yaw": soffit.yaw})
    sprung = _sprung(soffit, thin, rng.spawn(1)[0], demands, like, feet)
    if sprung is not None and _height_in_circle(sprung) > CREASED:
        return _odd(sprung)
    free = replace(_begun(_site(soffit, thin), rng, demands, like, feet), told={"span": SETTLED})
    return _odd(free if sprung is None else _either(free, sprung))


def _odd(found: Found) -> Found:
    """The same; where its stone is far off all kinds of arches, that is said, and where it springs is a guess."""
    scatter = found.refined.scatter
    if scatter < ODD:
        return found
    told = {name: max(found.told.get(name, 0.0), GUESS * scatter) for name in ("z", "span")}
    return replace(found, misfit=Misfit(SURELY_OTHER, scatter), told=told)


def _sprung(
    soffit: Soffit,
    thin: Thin,
    rng: np.random.Generator,
    demands: Demands,
    like: Found | None,
    feet: Sequence[Springing],
) -> Found | None:
    """The barrel of a soffit that springs from its feet; None where none comes near, or no feet are seen that agree."""
    if (told := _level_of(feet)) is None:
        return None
    level, std = told
    span = float(np.ptp(soffit.local(np.array([one.place for one in feet]))[0]))
    sizes = {**demands.sizes, "span": span} if len(feet) > 1 else demands.sizes
    held = replace(demands, sizes=sizes, pose={**demands.pose, "z": level})
    same = like if like is not None and _is_sprung(like) else None
    try:
        found = _begun(_site(soffit, thin, level), rng, held, same, ())
    except NoVaultError:
        return None
    if found.placed.vault.values()["span"] > soffit.length + LONGER:
        return None
    loosest = demands.freedom(found.placed.vault, [c for c in found.refined.kept if c.rare])
    return replace(found, refined=replace(found.refined, loosest=loosest), told=_unsure(found, std))


def _begun(
    site: Site, rng: np.random.Generator, demands: Demands, like: Found | None, feet: Sequence[Springing]
) -> Found:
    """The barrel of a soffit, begun from one like it where that leads as near.

    Raises:
        NoVaultError: an arch of no kind comes near.
    """
    barrel = _barrel(site, rng, demands, like, feet)
    return barrel if like is None or agree([barrel], like) else _barrel(site, rng, demands, None, feet)


def _level_of(feet: Sequence[Springing]) -> tuple[float, float] | None:
    """The level of the feet of an arch and its standard deviation [m]; None where none is seen, or they disagree."""
    if not feet:
        return None
    level, std = np.array([(one.place[2], one.std) for one in feet]).T
    middle = float(std**-2 @ level / (std**-2).sum())
    if (np.abs(level - middle) > LEVEL[0] + LEVEL[1] * std).any():
        return None
    return middle, hypot((std**-2).sum() ** -0.5, SETTLED)


def _is_sprung(found: Found) -> bool:
    """Whether it was held to the level of its feet."""
    return "z" in found.refined.solution.free.pose


def _unsure(found: Found, std: float) -> dict[str, float]:
    """Standard deviations [m] of the level and the span of an arch that springs where its feet say, that being `std`.

    What is seen of a foot lies on the soffit: the lower, the farther out.
    """
    height = max(_height_in_circle(found), 0.0)
    return {"z": std, "span": hypot(SETTLED, 2 * std * height / sqrt(1 - height**2))}


def _height_in_circle(found: Found) -> float:
    """How far an arch springs above the centre of the circle through its feet and crown, over the radius of that."""
    vault = found.placed.vault
    half, rise = vault.values()["span"] / 2, vault.derived_values()["rise"]
    return (half**2 - rise**2) / (half**2 + rise**2)


def _either(free: Found, sprung: Found) -> Found:
    """The likelier of an arch as all its stone has it, and of a segment that springs from its feet.

    The other is a choice that deviations allow for. Where there is no crease both may be seen too high.
    """
    scatters = [one.refined.scatter for one in (free, sprung)]
    if _height_in_circle(sprung) < 0 or scatters[1] > WORSE[0] * scatters[0] + WORSE[1]:
        return free
    radius = sprung.placed.vault.derived_values()["radius"]
    std = hypot(sprung.told["z"], BEND[1] * radius)
    off = (sprung.placed.pose.z - free.placed.pose.z - BEND[0] * radius) / std
    sprung = replace(sprung, told=_unsure(sprung, std))
    round_one, segment = (PRACTICE[kind].share for kind in (Semicircular, Segmental))
    chance = segment / (segment + round_one * exp(-0.5 * off**2))
    told = (free, 1 - chance), (sprung, chance)
    (first, likely), (other, rest) = sorted(told, key=lambda one: -one[1])
    mine = first.choices or (_itself(first),)
    return replace(
        first, choices=(*(replace(c, chance=likely * c.chance) for c in mine), replace(_itself(other), chance=rest))
    )


def _itself(found: Found) -> Choice:
    """An arch as it was fitted, as the only choice."""
    placed, std = found.placed, found.told.get("z", 0.0)
    here = {**placed.vault.values(), **placed.vault.derived_values()} | {
        name: getattr(placed.pose, name) for name in POSE
    }
    sizes = {name: (value, std if name in LEVELLED else 0.0) for name, value in here.items()}
    return Choice(placed, found.refined.kept, 1.0, sizes)


def _barrel(
    site: Site, rng: np.random.Generator, demands: Demands, like: Found | None, feet: Sequence[Springing]
) -> Found:
    """The barrel of a soffit, begun from one like it if there is one.

    Raises:
        NoVaultError: an arch of no kind comes near.
    """
    known = starts_like(like, site, (Barrel,), demands) if like else ()
    hypotheses = recognise(site, rng, families=(Barrel,), demands=demands, known=known)
    refined = refine(hypotheses[0], site, rng, demands=demands, known=like.refined.kept if like else None)
    found = Found(site, hypotheses, refined, refined.tolerance)
    return likeliest_of(found, demands, rng, choices_like(like, found) if like else (), feet)


def _site(soffit: Soffit, thin: Thin, level: float = -inf) -> Site:
    """The stone of an arch, and of its piers a little, above a level [m]."""
    low, crown = float(soffit.curve[:, 1].min()), float(soffit.curve[:, 1].max())
    mine = soffit.holds(thin.points, -WITHIN, BESIDE)
    mine &= (thin.points[:, 2] > max(low - BELOW, level)) & (thin.points[:, 2] < crown + WITHIN)
    points, normals = thin.points[mine], thin.normals[mine]
    steep = np.abs(normals[:, 2]) < STEEP
    along = np.arange(-soffit.length / 2, soffit.length / 2, ENDS) + ENDS / 2
    local = np.array([(u, side * soffit.width / 2) for side in (-1, 1) for u in along])
    ends = np.column_stack([turned(local, -soffit.yaw) + soffit.place, np.full(len(local), low - BELOW - 1.0)])
    half = np.array([soffit.length, soffit.width]) / 2
    middle = turned(soffit.place[None], soffit.yaw)[0]
    walled = np.array([[(np.abs(normals[:, 2]) < UPRIGHT).any()] * 2, [False, False]])
    return Site(
        points=points,
        normals=normals,
        weights=np.where(steep, 0.4, 1.0),
        yaw=soffit.yaw,
        low=middle - half,
        high=middle + half,
        walled=walled,
        bottom=float(points[:, 2].min(initial=low)),
        crown=crown,
        spacing=thin.spacing,
        ends=ends,
        counts=thin.counts[mine],
    )
