"""What was found in a scan: a vault with the families that were tried for it, and the fit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from vaultcad.find.choices import Choice, likeliest, weigh
from vaultcad.find.misfit import FITS, Misfit
from vaultcad.find.recognise import Hypothesis, confidence
from vaultcad.find.refine import Refined
from vaultcad.fit.freedom import Demands
from vaultcad.fit.solve import Placed
from vaultcad.survey.springings import Springing
from vaultcad.survey.thinned_scan import Site
from vaultcad.uncertain import Covariance

AS_LIKELY = 0.2  # of all families but the best, from which on the next is said


@dataclass(frozen=True)
class Found:
    """One vault of a scan. hypotheses: the most likely first. tolerance: of the band its points lie in [m].

    choices: of arches and constraints; with the first it is refined. shared: mean and standard deviation of the sizes
    that are those of its row [m]. misfit: what speaks against all families. told: standard deviations of
    unknowns, by name, that its own stone does not tell: of those that were held as others tell them, else at the least.
    """

    site: Site
    hypotheses: tuple[Hypothesis, ...]
    refined: Refined
    tolerance: float
    choices: tuple[Choice, ...] = ()
    shared: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    misfit: Misfit = FITS
    told: Mapping[str, float] = field(default_factory=dict)

    @property
    def placed(self) -> Placed:
        """The vault where it stands."""
        return self.refined.placed

    def unsure(self, spread: Covariance) -> Covariance:
        """The covariance of its unknowns, from its own stone, with what others tell of them."""
        solution = self.refined.solution
        for name, std in self.told.items():
            held = name in solution.free.pose or name not in solution.names
            spread = spread.with_std(name, std if held else max(std, spread.stds()[name]))
        return spread

    @property
    def confidence(self) -> list[float]:
        """How likely each hypothesis is, in their order."""
        return confidence(self.hypotheses, self.misfit.chance)

    @property
    def doubt(self) -> str:
        """Why it may be of none of the families, or of another; nothing where neither is likely."""
        others = self.confidence[1:]
        if self.misfit.reason or sum(others) < AS_LIKELY:
            return self.misfit.reason
        return f"{self.hypotheses[1].vault.called} is likely, too ({others[0]:.0%})"


def likeliest_of(
    found: Found,
    demands: Demands,
    rng: np.random.Generator,
    known: Sequence[Choice] = (),
    springings: Sequence[Springing] = (),
) -> Found:
    """The same vault with the arches and under the constraints with which it was most likely built.

    known: what was likely where it looks alike. springings: of the arches in the scan.
    """
    choices = weigh(found.refined, demands, rng, known, springings)
    refined = likeliest(found.refined, choices, demands)
    return replace(found, refined=refined, tolerance=refined.tolerance, choices=choices)
