"""The planes that a vault's genesis asks for, and lines of any upright plane."""

from math import pi, radians

import numpy as np
import pytest

from families import FAMILIES, Annular, Barrel, Cloister, Dome, Groin, Lunette, Sail
from families.declaration.pieces import Turned
from families.void.upright import Upright, chords, outlines
from vaultcad.model import PlacedVault
from vaultcad.pose import Pose
from vaultcad.sections.guide import ON_VAULT, guides
from vaultcad.sections.planes import every, genesis_planes, given
from vaultcad.sections.section import Level


def upright(vault):
    return [plane for plane in genesis_planes(vault) if isinstance(plane.cut, Upright)]


@pytest.mark.parametrize("family", FAMILIES, ids=lambda cls: cls.id)
def test_every_family_is_cut_within_its_plan_by_planes_that_differ(family):
    vault = family()
    planes = genesis_planes(vault)
    assert isinstance(planes[-1].cut, Level)
    assert len({plane.name for plane in planes}) == len(planes) >= 3
    for plane in upright(vault):
        assert sum(high - low for low, high in chords(vault.plan, plane.cut)) > 0.3
        lines, along = guides(vault, plane.cut)
        assert lines
        for guide in along:
            # Samples lie on the surface, and their normals point into the stone.
            assert np.abs(vault.distance(plane.cut.placed(guide.at))).max() < ON_VAULT
            assert guide.slant.min() > 0
            np.testing.assert_allclose(np.linalg.norm(guide.normal, axis=1), 1, atol=1e-9)


@pytest.mark.parametrize(
    ("vault", "kinds"),
    [
        (Barrel(), {"across": 1, "along": 1, "wall arch": 2}),
        (Groin(), {"across": 1, "along": 1, "diagonal": 2, "wall arch": 4}),
        (Sail(), {"meridian": 4, "wall arch": 4}),
        (Dome(), {"meridian": 4, "wall arch": 4}),
        (Cloister(), {"across": 3, "along": 1, "diagonal": 4}),
        (Lunette(), {"across": 3, "along": 1, "wall arch": 4, "between": 2}),
    ],
    ids=lambda value: getattr(value, "id", ""),
)
def test_planes_follow_from_what_a_family_declares(vault, kinds):
    found = [plane.kind for plane in upright(vault)]
    assert {kind: found.count(kind) for kind in found} == kinds


def test_any_azimuth_cuts_as_the_axes_do():
    vault = Groin(4.0, 6.0)
    (line, component), *_ = outlines(vault, Upright.towards(0.7, 0.0, pi / 2))
    (along, other), *_ = outlines(vault, Upright.along_axis(1, 0.7))
    np.testing.assert_allclose(line, along, atol=1e-9)
    assert (component == other).mean() > 0.99
    diagonal = Upright.through((-2.0, -3.0), (2.0, 3.0))
    line = outlines(vault, diagonal)[0][0][1:-1]
    assert line[:, 1].max() == pytest.approx(vault.rise, abs=1e-6)


def test_planes_by_hand_are_brought_into_the_vaults_frame():
    placed = PlacedVault(Barrel(4.0, 8.0), Pose(10.0, 20.0, 3.0, radians(30)))
    (plane,) = given(placed, [(10.0, 20.0, radians(30)), (99.0, 0.0, 0.0)])
    assert isinstance(plane.cut, Upright)
    np.testing.assert_allclose(plane.cut.origin, (0, 0), atol=1e-9)
    np.testing.assert_allclose(plane.cut.direction, (1, 0), atol=1e-9)


def test_planes_stand_so_far_apart_as_is_asked():
    planes = every(Barrel(4.0, 8.0), 0.5)
    at = [plane.cut.origin[1] for plane in planes if isinstance(plane.cut, Upright)]
    assert len(at) == 15
    np.testing.assert_allclose(np.diff(at), 0.5)
    ring = Annular()
    cuts = [plane.cut for plane in every(ring, 0.5)]
    radius = next(part.radius for piece in ring.pieces() for part in piece.parts if isinstance(part, Turned))
    assert len(cuts) > 5
    np.testing.assert_allclose(np.diff(np.unwrap([cut.azimuth for cut in cuts])) * radius, 0.5)
    assert all(sum(high - low for low, high in chords(ring.plan, cut)) > 0.3 for cut in cuts)
    with pytest.raises(ValueError, match="every = 0"):
        every(Barrel(), 0.0)
