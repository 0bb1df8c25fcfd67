"""The vaults under one ceiling: a region is one vault if a family explains it, else its bays are tried each alone."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import permutations

import numpy as np
from numpy.typing import NDArray

from families import Vault
from families.kinds.barrel import Barrel
from families.kinds.lunette import Lunette
from vaultcad.errors import NoVaultError, OtherThingError
from vaultcad.find.found import Found, likeliest_of
from vaultcad.find.likeness import agree, choices_like, starts_like
from vaultcad.find.lunettes import lunettes_at
from vaultcad.find.misfit import Misfit, refuse_strangers
from vaultcad.find.no_vault import PartlyError, check, check_bent
from vaultcad.find.pockets import pockets_behind
from vaultcad.find.reach import reach_of
from vaultcad.find.recognise import Start, recognise
from vaultcad.find.refine import refine
from vaultcad.find.ribs import SeenRib, ribs_under
from vaultcad.fit.freedom import NONE, Demands
from vaultcad.fit.label import label
from vaultcad.fit.solve import Placed
from vaultcad.survey.bay_arches import bay_of, without_arches
from vaultcad.survey.bays import LEAST, CeilingGrid, Region
from vaultcad.survey.imposts import within_imposts
from vaultcad.survey.springings import Springing
from vaultcad.survey.stretches import along_and_beyond
from vaultcad.survey.thinned_scan import STEEP, Site, Thin, find_site

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Bands = Sequence[tuple[Placed, float]]  # vaults, and how far from each its points are [m]

NARROW = 0.9  # m, span of a part of a scan that is rather an arch, or nothing
IN_WALL, SHORT = 1.25, 0.6  # m; share of its span; barrels less long are of arches, doors or windows
SURE = 0.9  # share of the ceiling over a region from which on its bays are not tried
CROWN, ABOVE = 0.998, 0.3  # share of the ceiling under its crown; m above it from which stone is another's
GAIN = 1.05  # the bays must explain so much more than one vault over all of them
LIKELY = 0.3  # confidence of a vault, from which on others are looked for beside it, and of these
CONTINUED = 0.1  # m that the stone of one vault is off another, were that longer, at most where it goes on
OWN = 0.6  # share of the stone under a vault beside others that must not be theirs
FILLED, PARTLY = 0.4, 0.2  # share of a bay's plan that its vault must be seen on, and of a whole scan's


def under_one_ceiling(
    thin: Thin,
    xyz: NDArray[np.floating],
    families: Sequence[type[Vault]],
    rng: np.random.Generator,
    demands: Demands,
    *,
    part: bool = False,
    single: bool = False,
    like: Found | None = None,
    springings: Sequence[Springing] = (),
) -> tuple[Found, ...]:
    """The vaults of a scan, or of a part of it, that hang together; `like` is one from which it can begin.

    single: whether it can be one vault alone, its bays having been tried. springings: of the arches in the scan.

    Raises:
        NoVaultError: there is none, or not one that agrees with that.
    """
    search = _Search(thin, xyz, CeilingGrid.of(thin), tuple(families), rng, demands, like)
    found = search.single() if single else search.region(search.ceiling.room, part=part)
    if not found:
        raise search.refusals[0]
    if not single and like is None:
        found = search.to_their_ends([*found, *search.arms(found, search.ceiling.whole)])
    if like and not agree(found, like):
        raise NoVaultError(f"no vault found: {like.placed.vault.called} hangs over what looks alike, but not here")
    return tuple(likeliest_of(one, demands, rng, choices_like(like, one) if like else (), springings) for one in found)


@dataclass(frozen=True)
class _Search:
    """One search: what it searches, and why regions were refused, the whole scan first."""

    thin: Thin
    xyz: NDArray[np.floating]
    ceiling: CeilingGrid
    families: tuple[type[Vault], ...]
    rng: np.random.Generator
    demands: Demands = NONE
    like: Found | None = None
    refusals: list[NoVaultError] = field(default_factory=list)

    def region(self, region: Region, *, part: bool = False) -> list[Found]:
        """The vaults over a region."""
        one, bands = None, []
        try:
            one = self._fit(region, part)
            bands = [(one.placed, one.tolerance)]
        except OtherThingError as error:
            self.refusals.append(error)
            return []
        except PartlyError as error:
            self.refusals.append(error)
            bands = [(error.placed, error.tolerance)]
        except NoVaultError as error:
            self.refusals.append(error)
        if one and self._settled(one, region):
            return [one]
        parts = self.ceiling.parts(region)
        if len(parts) == 1 and parts[0] is region:
            cut = self.ceiling.cut(region, self.ceiling.points(region)[self._under(bands, region)])
            bays = self._beside(region, cut)
            if not bays and not region.valleys:  # a part of what was cut by guess is not cut by another
                stretch = along_and_beyond(self.ceiling, region)
                bays = self._beside(region, stretch, alone=one is not None)
        else:
            bays = [found for bay in parts for found in self.region(bay, part=True)]
        if one is None:
            return bays
        gain = 1 / GAIN if one.placed.vault.may_be_several else GAIN
        whole = [one, *self.arms([one], region)] if bays else [one]
        pieces = all(type(bay.placed.vault) is type(one.placed.vault) for bay in bays)
        if pieces and self._explained(bays, region) <= self._explained(whole, region):
            return whole  # which is doubted more than they are, but they are it, cut
        return bays if self._believed(bays, region) > gain * self._believed(whole, region) else whole

    def single(self) -> list[Found]:
        """The one vault over all of it.

        Raises:
            NoVaultError: none is near enough to what hangs there, or too little of it is there.
        """
        return [self._fit(self.ceiling.room, part=False)]

    def arms(self, found: Sequence[Found], region: Region) -> list[Found]:
        """The vaults over what hangs beside those found, as the arms of a crossing narrower than its middle.

        None where all of these are doubtful: what they leave may be what they miss. Nor what is doubtful itself.
        """
        whole, arms = self.ceiling.whole, list[Found]()
        if all(one.confidence[0] < LIKELY for one in found):
            return arms
        own = self._under([(one.placed, one.tolerance) for one in found], whole)
        own |= ~region.holds(self.ceiling.points(whole))
        for part, mine in self.ceiling.beside(own):
            for arm in self.region(part, part=True):
                on = self._under([(arm.placed, arm.tolerance)], whole)
                if arm.confidence[0] >= LIKELY and (on & mine).sum() > OWN * on.sum():
                    arms.append(arm)
        return arms

    def to_their_ends(self, found: Sequence[Found]) -> list[Found]:
        """The same vaults, those whose ends were cut by guess fitted again up to where their stone ends."""
        out = list(found)
        for k, one in enumerate(out):
            others = [(other.placed, other.tolerance) for other in out if other is not one]
            part = reach_of(one.placed, one.tolerance, others, self.ceiling) if one.site.guessed else None
            if part is None:
                continue
            with suppress(NoVaultError):
                again = self._fit(part, part=True)
                if type(again.placed.vault) is type(one.placed.vault):
                    out[k] = again
        return out

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
        if part and (short < NARROW or area < LEAST or _is_soffit(vault)):
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
            return self._one(thin, xyz, region)
        try:
            found = self._one(inner_thin, xyz.compress(inner.holds(xyz), axis=0), inner)
        except NoVaultError:  # what was cut off was its own
            return self._one(thin, xyz, region)
        plan = found.placed.vault.plan
        if not (plan.on_wall_x or plan.on_wall_y):
            return found
        # A vault that stands on walls has no arches on its sides; lunettes look like them.
        with suppress(NoVaultError):
            whole = self._one(thin, xyz, region)
            if self._explained([whole], region) > GAIN * self._explained([found], region):
                return whole
        return found

    def _one(self, thin: Thin, xyz: NDArray[np.floating], region: Region) -> Found:
        """One vault over all these points of a region, thinned and all of them.

        Raises:
            NoVaultError: none is near enough to what hangs there.
        """
        site = within_imposts(_under_its_ceiling(find_site(thin, xyz), thin))
        for axis, side in region.valleys:
            site = site.with_guessed_ends(axis, side)
        check_bent(site)
        known = starts_like(self.like, site, self.families, self.demands) if self.like else ()
        hypotheses = recognise(site, self.rng, families=self.families, demands=self.demands, known=known)
        same = self.like is not None and type(hypotheses[0].vault) is type(self.like.placed.vault)
        kept = self.like.refined.kept if self.like and same else None
        refined = refine(hypotheses[0], site, self.rng, demands=self.demands, known=kept)
        if ribs := ribs_under(refined.placed, site.points):  # which pull the webs down, and hide what they are
            site = _without(site, ribs)
            hypotheses = recognise(site, self.rng, families=self.families, demands=self.demands)
            refined = refine(hypotheses[0], site, self.rng, demands=self.demands)
        pockets = pockets_behind(refined.placed, site)
        if (row := lunettes_at(refined.placed, pockets)) and Lunette in self.families:
            known = (*(Start((h.solution.placed,), h.kept) for h in hypotheses), row)
            hypotheses = recognise(site, self.rng, families=self.families, demands=self.demands, known=known)
            refined = refine(hypotheses[0], site, self.rng, demands=self.demands)
            pockets = pockets_behind(refined.placed, site)
        misfit = Misfit.of(refined).with_stone_beside(refined.placed, site)
        misfit = misfit.with_pockets(len(pockets)).with_ridges(refined.placed, xyz)
        found = Found(site, hypotheses, refined, refined.tolerance, misfit=misfit)
        check(refined, site, found.tolerance)
        refuse_strangers(found.misfit, found.placed.vault)
        return found

    def _settled(self, one: Found, region: Region) -> bool:
        """Whether one vault explains so much of a region that its bays need not be tried."""
        several = one.placed.vault.may_be_several
        return not several and self._explained([one], region) >= SURE * len(self.ceiling.points(region))

    def _beside(self, region: Region, cut: Sequence[Region], *, alone: bool = False) -> list[Found]:
        """The vaults of a region that no valley parts, cut into that about its middle and what lies beyond.

        None unless there is one on both sides of a cut, or one in the middle may stand alone; nor where one goes on
        into another, for then it is the model itself that ended too early.
        """
        core, *others = cut
        mine = self.region(core, part=True) if others else []
        beside = [found for other in others for found in self.region(other, part=True)] if mine else []
        both = permutations([*mine, *beside], 2)
        if not (beside or alone) or any(self._goes_on(one, other, region) for one, other in both):
            return []
        return [*mine, *beside]

    def _goes_on(self, one: Found, other: Found, region: Region) -> bool:
        """Whether a vault of the same family would hang where another does, were its plan larger.

        A ramped barrel does not go on into the level ones over its landings.
        """
        stone = self.ceiling.points(region)[self._under([(other.placed, other.tolerance)], region)]
        same = type(one.placed.vault) is type(other.placed.vault)
        return same and bool(np.median(np.abs(one.placed.distance(stone))) < CONTINUED)

    def _explained(self, found: Sequence[Found], region: Region) -> int:
        """Over how many of the ceiling's cells of a region the vaults hang."""
        return int(self._under([(one.placed, one.tolerance) for one in found], region).sum())

    def _believed(self, found: Sequence[Found], region: Region) -> float:
        """The same, those of each vault as often as it is likely to be what it is taken for."""
        return sum(one.confidence[0] * self._explained([one], region) for one in found)

    def _under(self, bands: Bands, region: Region) -> NDArray[np.bool_]:
        """Which of the ceiling's points of a region are the vaults'."""
        own: NDArray[np.bool_] = label(self.ceiling.points(region), bands).vault > 0
        return own


def _is_soffit(vault: Vault) -> bool:
    """Whether a barrel is as short for its span as those through a wall, over doors and windows."""
    return isinstance(vault, Barrel) and vault.length < min(IN_WALL, SHORT * vault.span)


def _without(site: Site, ribs: Sequence[SeenRib]) -> Site:
    """The site without what is below ribs, and these."""
    other = ~np.any([rib.holds(site.points) for rib in ribs], axis=0)
    other |= np.abs(site.normals[:, 2]) < STEEP
    return site.only(other)


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
