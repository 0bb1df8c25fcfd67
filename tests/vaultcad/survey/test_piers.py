"""Piers and columns under arches: found, measured, and not taken for what stands about them."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from vaultcad.fit.section import Section, section_of
from vaultcad.survey.piers import shafts_under
from vaultcad.survey.thinned_scan import Thin

Array = NDArray[np.float64]
Patch = tuple[Array, Array]  # points (n, 3) [m] and normals (n, 3)

STEP, NOISE = 0.05, 0.002  # m
SPRINGING = 3.0  # m above the floor
SUPPORT = np.array([[0.0, 0.0, SPRINGING]])


def _upright(outline: Array, facing: Array, top: float) -> Patch:
    """Sides of a body over places (n, 2) that face out (n, 2)."""
    heights = np.arange(STEP / 2, top, STEP)
    points = np.column_stack([np.repeat(outline, len(heights), axis=0), np.tile(heights, len(outline))])
    return points, np.repeat(np.column_stack([facing, np.zeros(len(facing))]), len(heights), axis=0)


def _round(x: float, y: float, diameter: float, top: float) -> Patch:
    angle = np.arange(0, 2 * np.pi, 2 * STEP / diameter)
    out = np.column_stack([np.cos(angle), np.sin(angle)])
    return _upright(np.array([x, y]) + out * diameter / 2, out, top)


def _square(x: float, y: float, yaw: float, width: float, depth: float, top: float) -> Patch:
    u, v = (np.arange(-size / 2 + STEP / 2, size / 2, STEP) for size in (width, depth))
    outline = [np.column_stack([u, np.full(len(u), s * depth / 2)]) for s in (-1, 1)]
    outline += [np.column_stack([np.full(len(v), s * width / 2), v]) for s in (-1, 1)]
    facing = np.concatenate([np.tile([0.0, 1.0], (2 * len(u), 1)), np.tile([1.0, 0.0], (2 * len(v), 1))])
    turn = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
    return _upright(np.array([x, y]) + np.concatenate(outline) @ turn, facing @ turn, top)


def _floor(level: float = 0.0) -> Patch:
    points = np.stack(np.meshgrid(*[np.arange(-4, 4, STEP)] * 2), axis=-1).reshape(-1, 2)
    return np.column_stack([points, np.full(len(points), level)]), np.tile([0.0, 0.0, 1.0], (len(points), 1))


def _scan(*patches: Patch) -> Thin:
    points, normals = (np.concatenate(arrays) for arrays in zip(*patches, strict=True))
    points = points + np.random.default_rng(1).normal(0, NOISE, points.shape)
    return Thin(points, normals, np.ones(len(points)), STEP)


def _sections(*patches: Patch, supports: Array = SUPPORT) -> list[Section]:
    shafts = shafts_under(supports, _scan(_floor(), *patches))
    found = [section_of(shaft.points[:, :2], shaft.normals[:, :2]) for shaft in shafts]
    return [section for section in found if section is not None]


def test_a_round_column_with_base_and_capital_is_measured() -> None:
    base, capital = _square(0.1, -0.05, 0.3, 0.7, 0.7, 0.2), _round(0.1, -0.05, 0.7, SPRINGING)
    high = capital[0][:, 2] > SPRINGING - 0.2
    (section,) = _sections(base, _round(0.1, -0.05, 0.4, SPRINGING), (capital[0][high], capital[1][high]))
    assert section.plan == "round"
    assert np.abs(section.values - [0.1, -0.05, 0.4]).max() < 0.002
    assert 0 < np.sqrt(section.covariance.diagonal()).max() < 0.002


def test_a_rectangular_pier_is_measured() -> None:
    (section,) = _sections(_square(0.2, 0.1, 0.3, 0.9, 0.6, SPRINGING))
    assert section.plan == "rectangular"
    assert np.abs(section.values - [0.2, 0.1, 0.3, 0.9, 0.6]).max() < 0.003


def test_a_compound_pier_has_the_size_of_the_rectangle_about_it() -> None:
    parts = [_square(0.0, 0.0, 0.2, *size, SPRINGING) for size in ((1.4, 0.6), (0.6, 1.2))]
    cross = []
    for (points, normals), (width, depth) in zip(parts, ((0.6, 1.2), (1.4, 0.6)), strict=True):
        turn = np.array([[np.cos(0.2), -np.sin(0.2)], [np.sin(0.2), np.cos(0.2)]])
        outside = (np.abs(points[:, :2] @ turn) > [width / 2, depth / 2]).any(axis=1)
        cross.append((points[outside], normals[outside]))
    (section,) = _sections(*cross)
    assert section.plan == "compound"
    assert np.abs(section.values - [0.0, 0.0, 0.2, 1.4, 1.2]).max() < 0.01


def test_a_chest_beside_a_pier_and_pews_that_tie_it_to_a_wall_change_nothing() -> None:
    pier, wall = _square(0, 0, 0.0, 0.6, 0.6, SPRINGING), _square(0.0, 2.0, 0.0, 7.0, 0.1, SPRINGING)
    (section,) = _sections(pier, wall, _square(0.0, 1.15, 0.0, 0.5, 1.6, 1.1), _square(0.6, 0.0, 0.0, 0.5, 0.5, 0.8))
    assert np.abs(section.values - [0, 0, 0, 0.6, 0.6]).max() < 0.01


@pytest.mark.parametrize(
    "patches",
    [
        pytest.param((_round(0, 0, 0.6, 1.9),), id="a statue under the springing"),
        pytest.param((_square(0, 0, 0, 8.0, 0.4, SPRINGING),), id="a wall"),
        pytest.param((_round(1.5, 0, 0.4, SPRINGING),), id="a pillar beside the arch's end"),
        pytest.param((), id="nothing but a floor"),
    ],
)
def test_what_is_no_pier_is_none(patches: tuple[Patch, ...]) -> None:
    assert not _sections(*patches)


def test_a_half_pier_along_a_wall_is_the_walls() -> None:
    points, normals = _square(0, 0, 0, 0.6, 0.6, SPRINGING)
    free = points[:, 1] < 0.25
    assert not _sections((points[free], normals[free]), _square(0, 0.35, 0, 8.0, 0.1, SPRINGING))
    assert not _sections((points[free], normals[free])), "with the wall unseen"


def test_piers_stand_on_the_floor_of_their_storey() -> None:
    low, high = _square(0, 0, 0, 0.6, 0.6, SPRINGING), _round(0, 0, 0.4, SPRINGING)
    lifted = high[0] + [0, 0, 4.0]
    supports = np.array([[0.3, 0.0, SPRINGING], [0.2, 0.0, SPRINGING + 4.0], [-0.3, 0.0, SPRINGING]])
    shafts = list(shafts_under(supports, _scan(_floor(), _floor(4.0), low, (lifted, high[1]))))
    assert sorted((shaft.supports.tolist(), round(float(shaft.floor.mean()), 2)) for shaft in shafts) == [
        ([0, 2], 0.0),
        ([1], 4.0),
    ]
