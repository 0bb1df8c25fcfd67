"""Vaults on ledges stand before their walls; where stone is seen behind a ledge, they spring from these."""

from __future__ import annotations

import numpy as np
import pytest

from families import Barrel, Pointed, Profile, Segmental, Semicircular
from vaultcad.survey.imposts import within_imposts
from vaultcad.survey.thinned_scan import Site, Thin, find_site

OUT, TALL, WALL = 0.12, 0.25, 2.5  # m, of a ledge and of the walls under it
SPAN, LENGTH = 4.4, 6.0


def patch(low: list[float], high: list[float], normal: list[float]) -> np.ndarray:
    """Points on a level or upright rectangle, with normals (n, 6)."""
    axes = [np.arange(a, b + 1e-9, 0.05) for a, b in zip(low, high, strict=True)]
    xyz = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 3)
    return np.column_stack([xyz, np.tile(normal, (len(xyz), 1))])


def room(profile: Profile, *, ledge: float, behind: float) -> Site:
    """A barrel vault over a room with ledges along its walls, which are so far behind its springings [m]."""
    rng = np.random.default_rng(5)
    vault = Barrel(SPAN, LENGTH, profile)
    sample = vault.sample(12_000, rng)
    order = [1, 0, 2] if vault.plan.half[0] == pytest.approx(SPAN / 2) else [0, 1, 2]  # its axis along x
    stone = np.column_stack([sample.xyz[:, order], sample.normals[:, order]])
    wall, end = SPAN / 2 + behind, LENGTH / 2
    face = wall - ledge
    hidden = (np.abs(stone[:, 1]) > face) & (stone[:, 2] < (np.abs(stone[:, 1]) - face) / 2)
    parts = [stone[~hidden], patch([-end, -wall, -WALL - TALL], [end, wall, -WALL - TALL], [0, 0, 1])]
    for side in (-1.0, 1.0):
        parts.append(patch([-end, side * wall, -WALL - TALL], [end, side * wall, -TALL], [0, side, 0]))
        parts.append(patch([side * end, -wall, -WALL - TALL], [side * end, wall, 0.5], [side, 0, 0]))
        if ledge:
            parts.append(patch([-end, side * face, -TALL], [end, side * face, 0], [0, side, 0]))
            inner, outer = sorted((side * face, side * wall))
            parts.append(patch([-end, inner, -TALL], [end, outer, -TALL], [0, 0, 1]))
    both = np.concatenate(parts)
    xyz = both[:, :3] + rng.normal(0, 0.002, (len(both), 3))
    return find_site(Thin(xyz, both[:, 3:], np.ones(len(xyz)), 0.05), xyz)


@pytest.mark.parametrize("profile", [Semicircular(), Segmental(0.3), Pointed(0.6)], ids=lambda p: p.id)
def test_a_vault_on_ledges_is_as_wide_as_from_ledge_to_ledge(profile: Profile) -> None:
    site = room(profile, ledge=OUT, behind=OUT)
    assert site.spans.tolist() == pytest.approx([LENGTH, SPAN + 2 * OUT], abs=0.01)
    within = within_imposts(site)
    assert within.spans.tolist() == pytest.approx([LENGTH, SPAN], abs=0.01)
    assert len(within.points) == len(within.normals) == len(within.weights) == len(within.counts) < len(site.points)


@pytest.mark.parametrize("profile", [Semicircular(), Segmental(0.3), Pointed(0.6)], ids=lambda p: p.id)
@pytest.mark.parametrize("ledge", [0.0, OUT])
def test_walls_without_ledges_and_those_behind_ornaments_are_left(profile: Profile, ledge: float) -> None:
    site = room(profile, ledge=ledge, behind=0.0)
    assert within_imposts(site) is site
