"""Recognition: the right family from any side, and how sure it says it is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from families import Barrel, Groin, Lunette, Pointed, Sail, Segmental, Semicircular, Trough, Vault
from segmentation.cloud import Cloud
from vaultcad.errors import NoVaultError
from vaultcad.find.found import Found
from vaultcad.find.misfit import FITS
from vaultcad.find.recognise import MISSED, Hypothesis, Start, confidence, recognise
from vaultcad.find.refine import refine
from vaultcad.fit.freedom import Demands
from vaultcad.fit.solve import Placed
from vaultcad.pose import Pose
from vaultcad.survey.thinned_scan import Site, survey


def site_of(vault: Vault) -> Site:
    return survey(Cloud(vault.sample(60_000, np.random.default_rng(3)).xyz.astype(np.float32)))


@pytest.fixture(scope="module")
def hypotheses() -> tuple[Hypothesis, ...]:
    families = (Sail, Barrel, Trough)
    return recognise(site_of(Barrel(4.0, 6.0)), np.random.default_rng(0), families=families)


def test_the_best_comes_first_and_the_others_are_listed(hypotheses: tuple[Hypothesis, ...]) -> None:
    assert hypotheses[0].vault.id == "barrel"
    assert [h.score for h in hypotheses] == sorted(h.score for h in hypotheses)


def test_confidence_is_shared_out_and_never_whole(hypotheses: tuple[Hypothesis, ...]) -> None:
    shares = confidence(hypotheses)
    assert sum(shares) == pytest.approx(1.0)
    assert 1 - MISSED <= shares[0] < 1
    assert confidence(hypotheses[:1]) == [pytest.approx(1.0)]


def test_what_begins_where_it_is_known_to_be_comes_to_the_same(hypotheses: tuple[Hypothesis, ...]) -> None:
    known = [Start((h.solution.placed,), h.kept) for h in hypotheses]
    families = (Sail, Barrel, Trough)
    site = site_of(Barrel(4.0, 6.0))
    again = recognise(site, np.random.default_rng(0), families=families, known=known)
    assert {h.vault.id for h in again} == {h.vault.id for h in hypotheses}
    assert again[0].vault.values() == pytest.approx(hypotheses[0].vault.values(), abs=1e-3)
    assert confidence(again)[0] == pytest.approx(confidence(hypotheses)[0], abs=1e-3)


def test_equal_scores_are_equally_likely(hypotheses: tuple[Hypothesis, ...]) -> None:
    twins = [replace(hypotheses[0], score=-100.0), replace(hypotheses[1], score=-100.0)]
    assert confidence(twins) == pytest.approx([0.5, 0.5])


def test_a_family_that_is_nearly_as_likely_is_named(hypotheses: tuple[Hypothesis, ...]) -> None:
    site, rng = site_of(Barrel(4.0, 6.0)), np.random.default_rng(0)
    refined = refine(hypotheses[0], site, rng)
    found = Found(site, hypotheses, refined, refined.tolerance)
    best, other = hypotheses[:2]
    for behind, doubt in ((1.0, f"{other.vault.called} is likely, too (38%)"), (4.0, "")):
        close = replace(found, hypotheses=(best, replace(other, score=best.score + behind)))
        assert close.doubt == doubt
        assert sum(close.confidence) == pytest.approx(1.0)
    assert replace(close, misfit=FITS.with_share(0.3)).doubt.startswith("70% of what is bent")
    several = [replace(other, score=best.score + 4.0)] * 2  # each of 11 %
    assert replace(found, hypotheses=(best, *several)).doubt == f"{other.vault.called} is likely, too (11%)"


def test_a_sliver_is_refused_by_all_families() -> None:
    site = site_of(Barrel(4.0, 6.0))
    with pytest.raises(NoVaultError, match="nothing above the floor has the plan of a vault"):
        recognise(replace(site, high=np.array([site.low[0], site.high[1]])), np.random.default_rng(0))


def test_long_heads_do_not_hide_along_which_axis_a_trough_runs() -> None:
    found = recognise(
        site_of(Trough(5.8, 8.1, Semicircular(), 0.8, 0.8)), np.random.default_rng(0), families=(Trough,)
    )[0].vault
    assert sorted([found.values()["span_x"], found.values()["span_y"]]) == pytest.approx([5.8, 8.1], abs=0.02)
    assert found.values()["span_x"] == pytest.approx(5.8, abs=0.02)


def test_lunettes_as_wide_as_their_barrel_is_long_do_not_hide_a_groin_vault() -> None:
    site = site_of(Groin(4.17, 6.26, Pointed(0.75), Semicircular()))
    found = recognise(site, np.random.default_rng(0), families=(Lunette, Barrel, Groin))[0]
    assert isinstance(found.vault, Groin)
    assert {type(arch) for arch in found.vault.profiles.values()} == {Pointed, Semicircular}


def test_a_start_whose_arches_cannot_have_what_is_asked_takes_others() -> None:
    """As a bay beside a row, whose rise is known, may begin with a semicircle, which has none of its own."""
    site = site_of(Groin(4.0, 4.4, Segmental(0.4), Segmental(0.36)))
    known = [Start((Placed(Groin(4.0, 4.4, Segmental(0.4), Semicircular()), Pose(0, 0, 0, 0)),), ())]
    demands = Demands(sizes={"rise_y": 1.6})
    found = recognise(site, np.random.default_rng(0), families=(Groin,), demands=demands, known=known)[0].vault
    assert found.derived_values()["rise_y"] == pytest.approx(1.6)
