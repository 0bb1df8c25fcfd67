"""Finding the vaults of a scan: its ceilings and arches each alone, then what bays of a row tell each other."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from families import Vault
from families.declaration.ribs import DIAGONAL
from vaultcad.errors import NoVaultError
from vaultcad.find.arches import FoundArch, find_arch
from vaultcad.find.footing import on_ceilings
from vaultcad.find.found import Found
from vaultcad.find.likeness import as_near, firsts, in_turn, look_of_ceiling, look_of_soffit
from vaultcad.find.misfit import OVERLAID, SEEN_THROUGH, UNBORNE, Misfit, part_of_more
from vaultcad.find.overlaid import overlaid
from vaultcad.find.ribs import rib_arches
from vaultcad.find.rows import learned
from vaultcad.find.search import under_one_ceiling
from vaultcad.find.second_look import SecondLook, second_looks
from vaultcad.find.seen_through import seen_through
from vaultcad.fit.freedom import BAYS, NONE, Demands
from vaultcad.fit.label import label
from vaultcad.processes import spread
from vaultcad.survey.parting import Ceiling, parted
from vaultcad.survey.patches import Patches
from vaultcad.survey.plan_grid import Laid
from vaultcad.survey.soffits import Soffit
from vaultcad.survey.springings import Springing, springings
from vaultcad.survey.thinned_scan import UPRIGHT, Thin

FLAT = 0.97  # share of a ceiling that is level, from which on it is none of a vault
SQUARE = 0.2  # mean cosine of four times the angle between walls and an arch below which that is oblique to them
FEWEST = 20  # thinned points that are nearer to a rib than to all else
SHARE = 0.25  # of what is bent in a scan that its vaults must explain, and be likely to be vaults by


@dataclass(frozen=True)
class Findings:
    """What was found in a scan: its vaults, the largest ceilings first, and the arches between them.

    hung: the patches of all that hangs over rooms, found or not.
    """

    vaults: tuple[Found, ...]
    arches: tuple[FoundArch, ...]
    hung: Patches


def find_vaults(
    thin: Thin,
    xyz: NDArray[np.floating],
    families: Sequence[type[Vault]],
    rng: np.random.Generator,
    demands: Demands = NONE,
    progress: Callable[[str], None] = lambda stage: None,
) -> Findings:
    """All vaults of a scan, from its thinned points and all of them (n, 3) [m], with what is demanded of each.

    Raises:
        NoVaultError: there is none.
    """
    parting = parted(thin, xyz)
    ceilings, soffits = parting.ceilings, parting.soffits
    if not parting.is_parted:
        under_it = _weighed(under_one_ceiling(thin, xyz, families, rng, demands), ceilings, thin)
        return _ribbed(under_it, (), parting.hung, thin, xyz, rng)
    hung = np.concatenate([ceiling.points for ceiling in ceilings]) if ceilings else np.empty((0, 3))
    rngs = rng.spawn(len(ceilings) + len(soffits))
    if _any_oblique(soffits, thin):  # as ribs are, which part the webs of one vault
        with suppress(NoVaultError):
            whole = under_one_ceiling(thin, xyz, families, rng.spawn(1)[0], demands, single=True)
            ribbed = _ribbed(whole, (), parting.hung, thin, xyz, rng)
            if any(rib.line == DIAGONAL for rib in ribbed.arches):
                return ribbed
    laid = parting.laid(xyz)
    feet = springings(soffits, laid)
    sprung = [one for found in feet for one in found]
    kinds = firsts([look_of_ceiling(ceiling.points) for ceiling in ceilings])
    kinds += [len(ceilings) + k for k in firsts([look_of_soffit(soffit) for soffit in soffits])]

    def work(k: int, first: _Result | None) -> _Result:
        try:
            if k < len(ceilings):
                like = first[0] if isinstance(first, tuple) and len(first) == 1 else None
                return _over_part(thin, laid, ceilings[k], families, rngs[k], demands, like, sprung)
            soffit, arch = soffits[k - len(ceilings)], first if isinstance(first, FoundArch) else None
            return find_arch(soffit, thin, hung, rngs[k], arch, feet[k - len(ceilings)])
        except NoVaultError as error:
            return error

    results: dict[int, _Result] = {}
    for k, result in in_turn(kinds, work):
        results[k] = result
        bays = sum(done < len(ceilings) for done in results)
        what = (
            f"bay {bays} of {len(ceilings)}" if k < len(ceilings) else f"arch {len(results) - bays} of {len(soffits)}"
        )
        progress(f"{what}: {_told(result)}")
    found = [results[k] for k in range(len(kinds))]
    under = [result if isinstance(result, tuple) else () for result in found[: len(ceilings)]]
    if BAYS.name not in demands.freed:
        under = _looked_at_again(thin, laid, ceilings, under, rngs, demands, sprung, progress)
    vaults = [one for result in under for one in result]
    arches = [result for result in found if isinstance(result, FoundArch)]
    if not vaults:  # holes and scaffolds can part what is one
        whole = under_one_ceiling(thin, xyz, families, rng, demands, single=True)
        return _ribbed(whole, arches, parting.hung, thin, xyz, rng)
    weighed = _weighed(vaults, ceilings, thin)
    return _ribbed(learned(weighed, demands), arches, parting.hung, thin, xyz, rng)


_Result = tuple[Found, ...] | FoundArch | NoVaultError


def _told(result: _Result) -> str:
    match result:
        case NoVaultError():
            return "none"
        case FoundArch():
            return "arch"
        case _:
            return ", ".join(one.placed.vault.id for one in result)


def _over_part(
    thin: Thin,
    laid: Laid,
    ceiling: Ceiling,
    families: Sequence[type[Vault]],
    rng: np.random.Generator,
    demands: Demands,
    like: Found | None,
    sprung: Sequence[Springing],
) -> tuple[Found, ...]:
    """The vaults of one ceiling of several; `like` is the one vault of a ceiling that looks like it.

    Raises:
        NoVaultError: there is none.
    """
    _check_bent(ceiling)
    mine, own = ceiling.part.thinned(thin), ceiling.part.own(laid)
    if like is not None:
        begun = rng.spawn(1)[0]  # so that a search in full is the same as if this had not been tried
        with suppress(NoVaultError):
            return under_one_ceiling(mine, own, families, begun, demands, part=True, like=like, springings=sprung)
    return under_one_ceiling(mine, own, families, rng, demands, part=True, springings=sprung)


def _looked_at_again(
    thin: Thin,
    laid: Laid,
    ceilings: Sequence[Ceiling],
    under: Sequence[tuple[Found, ...]],
    rngs: Sequence[np.random.Generator],
    demands: Demands,
    sprung: Sequence[Springing],
    progress: Callable[[str], None],
) -> list[tuple[Found, ...]]:
    """What is under each ceiling, where those that a row lacks, or that are odd in it, were tried as bays of it."""
    tried: set[int] = set()
    out = list(under)
    while looks := [look for look in second_looks(ceilings, out, demands) if look.number not in tried]:
        tried |= {look.number for look in looks}  # what was found may be beside the next

        def work(n: int, looks: Sequence[SecondLook] = looks) -> Found | None:
            look, ceiling = looks[n], ceilings[looks[n].number]
            sizes = {name: mean for name, (mean, _) in look.shared.items()} | dict(demands.sizes)
            asked, mine = replace(demands, sizes=sizes), ceiling.part.thinned(thin)
            families, own = (type(look.beside.placed.vault),), ceiling.part.own(laid)
            try:
                _check_bent(ceiling)
                found = under_one_ceiling(
                    mine, own, families, rngs[look.number], asked, part=True, like=look.beside, springings=sprung
                )
            except NoVaultError:
                return None
            before = out[look.number]
            if not all(as_near(found, one) for one in before):
                return None
            return look.taken(found[0], before, demands, rngs[look.number], sprung)

        for look, found in zip(looks, spread(work, len(looks)), strict=True):
            if found is not None:
                out[look.number] = (found,)
                progress(f"ceiling {look.number + 1}: {found.placed.vault.id}, as beside it")
    return out


def _ribbed(
    vaults: tuple[Found, ...],
    arches: Sequence[FoundArch],
    hung: Patches,
    thin: Thin,
    xyz: NDArray[np.floating],
    rng: np.random.Generator,
) -> Findings:
    """The same with the ribs under vaults, which are not arches between these."""
    rngs = rng.spawn(len(vaults))
    under = spread(lambda n: list(rib_arches(vaults[n], thin, xyz, rngs[n])), len(vaults))
    between, ribs = told_apart(arches, [rib for found in under for rib in found])
    if not ribs:
        return Findings(vaults, tuple(arches), hung)
    bands = [(one.placed, one.tolerance) for one in vaults]
    arched = [one.band(one.depth) for one in (*between, *ribs)]
    held = np.bincount(label(thin.points, bands, arched).arch, minlength=len(arched) + 1)[1 + len(between) :]
    kept = [rib for rib, count in zip(ribs, held.tolist(), strict=True) if count >= FEWEST]
    return Findings(vaults, (*between, *kept), hung)


def told_apart(arches: Sequence[FoundArch], ribs: Sequence[FoundArch]) -> tuple[list[FoundArch], list[FoundArch]]:
    """Arches between vaults and ribs under them, where one strip of stone was found as both.

    No arch runs along a diagonal. But a vault whose plan reaches over the edge of an arch shows that as a narrow rib.
    """
    kept = [rib for rib in ribs if rib.line == DIAGONAL or not any(arch.is_along(rib) for arch in arches)]
    return [arch for arch in arches if not any(rib.is_along(arch) for rib in kept)], kept


def _any_oblique(soffits: Sequence[Soffit], thin: Thin) -> bool:
    """Whether an arch runs at an angle to most of the walls."""
    level = thin.normals.compress(np.abs(thin.normals[:, 2]) < UPRIGHT, axis=0)
    walls = np.exp(4j * np.arctan2(level[:, 1], level[:, 0])).mean() if len(level) else 1.0
    return any(float((walls * np.exp(-4j * soffit.yaw)).real) < SQUARE for soffit in soffits)


def _check_bent(ceiling: Ceiling) -> None:
    """Refuse a ceiling that is level.

    Raises:
        NoVaultError: it is.
    """
    share = float(ceiling.level.mean())
    if share > FLAT:
        raise NoVaultError(
            f"no vault found: {share:.0%} of a ceiling of {ceiling.area:.0f} m² is level; crop the scan to a vault"
        )


def _weighed(vaults: Sequence[Found], ceilings: Sequence[Ceiling], thin: Thin) -> tuple[Found, ...]:
    """The vaults, doubted where they explain little of what is bent in a scan, where it shows what is behind them, or
    that they stand on other ceilings, or that they reach into each other.

    Raises:
        NoVaultError: they explain so little that they are no vaults.
    """
    others = overlaid([(one.placed, one.tolerance) for one in vaults], thin.points)

    def misfit(n: int) -> Misfit:
        placed = vaults[n].placed
        said = vaults[n].misfit.with_sign(SEEN_THROUGH, seen_through(placed, thin.points))
        return said.with_sign(UNBORNE, on_ceilings(placed, thin)).with_sign(OVERLAID, others[n])

    misfits = spread(misfit, len(vaults))
    seen = [replace(one, misfit=said) for one, said in zip(vaults, misfits, strict=True)]
    bent = np.concatenate([np.empty((0, 3)), *(ceiling.points[~ceiling.level] for ceiling in ceilings)])
    if not len(bent):
        return tuple(seen)
    share = float((label(bent, [(one.placed, one.tolerance) for one in vaults]).vault > 0).mean())
    if share * (1 - part_of_more(share)) < SHARE:
        titles = ", ".join(dict.fromkeys(one.placed.vault.called for one in vaults))
        raise NoVaultError(
            f"no vault found: {titles} is near, but explains {share:.0%} of what is bent over the rooms of the "
            "scan; crop it to the vault"
        )
    return tuple(replace(one, misfit=one.misfit.with_share(share)) for one in seen)
