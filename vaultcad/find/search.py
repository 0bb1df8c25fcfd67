"""Finding the vaults of a scan: a region is one vault if a family explains it, else its bays are tried each alone."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from families import Vault
from families.declaration.ribs import DIAGONAL
from vaultcad.errors import NoVaultError
from vaultcad.find.arches import FoundArch, find_arch
from vaultcad.find.found import Found, likeliest_of, tolerance_of
from vaultcad.find.misfit import Misfit, refuse_strangers
from vaultcad.find.no_vault import check
from vaultcad.find.recognise import recognise
from vaultcad.find.refine import refine
from vaultcad.find.ribs import SeenRib, rib_arches, ribs_under
from vaultcad.find.rows import learned
from vaultcad.fit.freedom import NONE, Demands
from vaultcad.fit.label import ArchBand, label
from vaultcad.processes import spread
from vaultcad.survey.bay_arches import bay_of, without_arches
from vaultcad.survey.bays import LEAST, CeilingGrid, Region
from vaultcad.survey.parting import Ceiling, parted
from vaultcad.survey.patches import Patches
from vaultcad.survey.soffits import Soffit
from vaultcad.survey.thinned_scan import STEEP, UPRIGHT, Site, Thin, find_site

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

NARROW = 0.9  # m, span of a part of a scan that is rather an arch, or nothing
SURE = 0.9  # share of the ceiling over a region from which on its bays are not tried
CROWN, ABOVE = 0.998, 0.3  # share of the ceiling under its crown; m above it from which stone is another's
GAIN = 1.05  # the bays must explain so much more than one vault over all of them
FLAT = 0.97  # share of a ceiling that is level, from which on it is none of a vault
SHARE = 0.25  # of what is bent in a scan of several ceilings that its vaults must explain
SQUARE = 0.2  # mean cosine of four times the angle between walls and an arch below which that is oblique to them
FEWEST = 20  # thinned points that are nearer to a rib than to all else
FILLED, PARTLY = 0.4, 0.2  # share of a bay's plan that its vault must be seen on, and of a whole scan's


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
    if not parting.is_parted:
        return _ribbed(_under_one_ceiling(thin, xyz, families, rng, demands), (), parting.hung, thin, xyz, rng)
    ceilings, soffits = parting.ceilings, parting.soffits
    hung = np.concatenate([ceiling.points for ceiling in ceilings]) if ceilings else np.empty((0, 3))
    rngs = rng.spawn(len(ceilings) + len(soffits))
    if any(_is_oblique(soffit, thin) for soffit in soffits):  # as ribs are, which part the webs of one vault
        with suppress(NoVaultError):
            whole = _under_one_ceiling(thin, xyz, families, rng.spawn(1)[0], demands)
            ribbed = _ribbed(whole, (), parting.hung, thin, xyz, rng)
            if any(rib.line == DIAGONAL for rib in ribbed.arches):
                return ribbed

    def work(k: int) -> tuple[Found, ...] | FoundArch | NoVaultError:
        try:
            if k >= len(ceilings):
                return find_arch(soffits[k - len(ceilings)], thin, hung, rngs[k])
            _check_bent(ceilings[k])
            mine = ceilings[k].part
            return _under_one_ceiling(mine.thinned(thin), xyz[mine.holds(xyz)], families, rngs[k], demands, part=True)
        except NoVaultError as error:
            return error

    vaults: list[Found] = []
    arches: list[FoundArch] = []
    for k, found in enumerate(spread(work, len(rngs)), 1):
        match found:
            case NoVaultError():
                told = "none"
            case FoundArch():
                arches.append(found)
                told = "arch"
            case _:
                vaults += found
                told = ", ".join(one.placed.vault.id for one in found)
        what = f"bay {k} of {len(ceilings)}" if k <= len(ceilings) else f"arch {k - len(ceilings)} of {len(soffits)}"
        progress(f"{what}: {told}")
    if not vaults:  # holes and scaffolds can part what is one
        return _ribbed(_under_one_ceiling(thin, xyz, families, rng, demands), arches, parting.hung, thin, xyz, rng)
    _check_share(vaults, ceilings)
    return _ribbed(learned(vaults, demands), arches, parting.hung, thin, xyz, rng)


def _ribbed(
    vaults: tuple[Found, ...],
    arches: Sequence[FoundArch],
    hung: Patches,
    thin: Thin,
    xyz: NDArray[np.floating],
    rng: np.random.Generator,
) -> Findings:
    """The same with the ribs under vaults, which are not arches between these."""
    ribs = [rib for one in vaults for rib in rib_arches(one, thin, xyz, rng)]
    if not ribs:
        return Findings(vaults, tuple(arches), hung)
    between = [arch for arch in arches if not any(rib.is_along(arch) for rib in ribs)]
    bands = [(one.placed, one.tolerance) for one in vaults]
    arched = [ArchBand(one.barrel.placed, one.barrel.tolerance, one.depth) for one in (*between, *ribs)]
    held = np.bincount(label(thin.points, bands, arched).arch, minlength=len(arched) + 1)[1 + len(between) :]
    kept = [rib for rib, count in zip(ribs, held.tolist(), strict=True) if count >= FEWEST]
    return Findings(vaults, (*between, *kept), hung)


def _is_oblique(soffit: Soffit, thin: Thin) -> bool:
    """Whether an arch runs at an angle to most of the walls about it."""
    level = thin.normals[np.abs(thin.normals[:, 2]) < UPRIGHT, :2]
    turned_by = 4 * (np.arctan2(level[:, 1], level[:, 0]) - soffit.yaw)
    return bool(len(level) and np.cos(turned_by).mean() < SQUARE)


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


def _check_share(vaults: Sequence[Found], ceilings: Sequence[Ceiling]) -> None:
    """Refuse vaults that explain little of what hangs in a scan and is not level.

    Raises:
        NoVaultError: they do.
    """
    bent = np.concatenate([ceiling.points[~ceiling.level] for ceiling in ceilings])
    on = label(bent, [(one.placed, one.tolerance) for one in vaults]).vault > 0
    if len(bent) and on.mean() < SHARE:
        titles = ", ".join(dict.fromkeys(one.placed.vault.called for one in vaults))
        raise NoVaultError(
            f"no vault found: {titles} is near, but explains {on.mean():.0%} of what is bent over the rooms of the "
            "scan; crop it to the vault"
        )


def _under_one_ceiling(
    thin: Thin,
    xyz: NDArray[np.floating],
    families: Sequence[type[Vault]],
    rng: np.random.Generator,
    demands: Demands,
    *,
    part: bool = False,
) -> tuple[Found, ...]:
    """The vaults of a scan, or of a part of it, that hang together.

    Raises:
        NoVaultError: there is none.
    """
    search = _Search(thin, xyz, CeilingGrid.of(thin), tuple(families), rng, demands)
    found = search.region(search.ceiling.room, part=part)
    if not found:
        raise search.refusals[0]
    return tuple(likeliest_of(one, demands, rng) for one in found)


@dataclass(frozen=True)
class _Search:
    """One search: what it searches, and why regions were refused, the whole scan first."""

    thin: Thin
    xyz: NDArray[np.floating]
    ceiling: CeilingGrid
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
        gain = 1 / GAIN if one.placed.vault.may_be_several else GAIN
        return bays if self._explained(bays, region) > gain * self._explained([one], region) else [one]

    def _fit(self, region: Region, part: bool) -> Found:
        """One vault over all of a region, which may be a part of the scan only.

        Raises:
            NoVaultError: none is near enough to what hangs there, or too little of it is there.
        """
        found = self._without_arches(region)
        vault = found.placed.vault
        seen = self._explained([found], region) * self.ceiling.cell**2
        short = vault.plan.width
        area = vault.plan.area
        if part and (short < NARROW or area < LEAST):
            raise NoVaultError(
                f"no vault found: {vault.called} {short:.1f} m wide over {area:.1f} m² is an arch, if any"
            )
        if seen < (FILLED if part else PARTLY) * area:
            raise NoVaultError(
                f"no vault found: {seen:.1f} m² of {vault.called} are too little of its {area:.1f} m²; "
                "scan all of it, or crop to one bay"
            )
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
        try:
            found = self._one(inner_thin, xyz[inner.holds(xyz)])
        except NoVaultError:  # what was cut off was its own
            return self._one(thin, xyz)
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
        site = _under_its_ceiling(find_site(thin, xyz), thin)
        hypotheses = recognise(site, self.rng, families=self.families, demands=self.demands)
        refined = refine(hypotheses[0], site, self.rng, demands=self.demands)
        if ribs := ribs_under(refined.placed, site.points):  # which pull the webs down, and hide what they are
            site = _without(site, ribs)
            hypotheses = recognise(site, self.rng, families=self.families, demands=self.demands)
            refined = refine(hypotheses[0], site, self.rng, demands=self.demands)
        found = Found(site, hypotheses, refined, tolerance_of(refined), misfit=Misfit.of(refined))
        check(refined, site, found.tolerance)
        refuse_strangers(found.misfit, found.placed.vault.title)
        return found

    def _settled(self, one: Found, region: Region) -> bool:
        """Whether one vault explains so much of a region that its bays need not be tried."""
        several = one.placed.vault.may_be_several
        return not several and self._explained([one], region) >= SURE * len(self.ceiling.points(region))

    def _explained(self, found: Sequence[Found], region: Region) -> int:
        """Over how many of the ceiling's cells of a region the vaults hang."""
        points = self.ceiling.points(region)
        labels = label(points, [(one.placed, one.tolerance) for one in found])
        return int((labels.vault > 0).sum())


def _without(site: Site, ribs: Sequence[SeenRib]) -> Site:
    """The site without what is below ribs, and these."""
    other = ~np.any([rib.holds(site.points) for rib in ribs], axis=0)
    other |= np.abs(site.normals[:, 2]) < STEEP
    return replace(site, **{name: getattr(site, name)[other] for name in ("points", "normals", "weights", "counts")})


def _under_its_ceiling(site: Site, thin: Thin) -> Site:
    """The site with its crown at the top of what hangs together over it, and nothing of what is far above that.

    Reveals of windows and shafts go far up, but over a small part of the plan.
    """
    top = CeilingGrid.of(thin).height
    if not np.isfinite(top).any():
        return site
    crown = min(float(np.nanquantile(top, CROWN)), site.crown)
    below = site.points[:, 2] < crown + ABOVE
    if below.all() or crown > site.crown - ABOVE:
        return site
    arrays = {name: getattr(site, name)[below] for name in ("points", "normals", "weights", "counts")}
    return replace(site, crown=crown, **arrays)
