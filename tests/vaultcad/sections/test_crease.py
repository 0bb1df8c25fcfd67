"""Along a crease that has moved sideways a section shows one of the two surfaces, and says how unsure it is."""

import numpy as np
import pytest

from families import Cloister, Groin
from vaultcad.sections.cut import profile, stations
from vaultcad.sections.guide import guides
from vaultcad.sections.planes import genesis_planes

SIDEWAYS = np.array([0.011, -0.008, 0.004])  # m


@pytest.mark.parametrize("vault", [Groin(), Cloister()], ids=lambda vault: vault.id)
def test_lines_along_groins_and_hips_are_those_of_the_moved_stone(vault):
    rng = np.random.default_rng(3)
    sample = vault.sample(200_000, rng)
    scanned = sample.xyz + SIDEWAYS + rng.normal(0, 0.003, len(sample.xyz))[:, None] * sample.normals
    for plane in (plane for plane in genesis_planes(vault) if plane.kind == "diagonal"):
        near = scanned[np.abs(plane.cut.off(scanned)) < 0.03]
        for guide in guides(vault, plane.cut)[1]:
            (run,) = profile(guide, stations(vault, plane.cut, guide, near, 0.02), 0.02)
            line = run.line[10:-10]  # feet are all but points
            back = plane.cut.placed(line) - SIDEWAYS
            normal = vault.evaluate(back).normal
            within = np.sqrt(1 - (normal[:, :2] @ plane.cut.normal) ** 2)
            off = np.abs(vault.distance(back)) / within
            assert np.median(off) < 0.001
            assert (off < 2 * run.std[10:-10]).mean() > 0.93
