"""Ribs stand beside their vault in every file, and are in none where they are not asked for."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from families import Mirror, Rib, Ribs
from vaultcad.export.buildable import buildable
from vaultcad.export.glb import write_glb
from vaultcad.export.ifc import write_ifc
from vaultcad.export.step import write_step
from vaultcad.model import Assembly, PlacedVault
from vaultcad.pose import Pose

RIBS = Ribs(0.25, 0.2, kinds=("diagonal",))
NAMES = [f"diagonal_{corner}" for corner in ("south_west", "south_east", "north_east", "north_west")] + ["boss"]


def assembly(ribs, vault=None):
    placed = PlacedVault(vault or Rib(4, 5), Pose(1.0, 2.0, 3.0, 0.4), ribs=ribs)
    return Assembly(scan=Path("choir"), origin=np.zeros(3), vaults=(placed,))


def test_step_has_each_rib_as_a_named_solid(tmp_path):
    write_step(assembly(RIBS), tmp_path / "a.step")
    text = (tmp_path / "a.step").read_text()
    assert all(f"'rib vault {name}'" in text for name in NAMES)
    assert text.count("MANIFOLD_SOLID_BREP(") == 1 + len(NAMES)


def test_ifc_has_each_rib_as_a_member_of_the_type_rib(tmp_path):
    import ifcopenshell

    write_ifc(assembly(RIBS), tmp_path / "a.ifc")
    file = ifcopenshell.open(tmp_path / "a.ifc")
    assert [member.Name for member in file.by_type("IfcMember")] == NAMES
    (kind,) = file.by_type("IfcMemberType")
    assert kind.Name == "Rib"
    assert len(kind.Types[0].RelatedObjects) == len(NAMES)
    volumes = [q.VolumeValue for q in file.by_type("IfcQuantityVolume") if q.Name == "GrossVolume"]
    expected = [shape.volume for shape in Rib(4, 5).ribs(RIBS).children]
    assert volumes[-len(NAMES) :] == pytest.approx(np.array(expected) / 1e9, rel=5e-3)


def test_glb_has_each_rib_as_a_node(tmp_path):
    import trimesh

    write_glb(assembly(RIBS), tmp_path / "a.glb")
    assert set(NAMES) < set(trimesh.load(tmp_path / "a.glb").geometry)


def test_vaults_without_lines_for_ribs_say_so():
    model = buildable(assembly(RIBS, Mirror()))
    assert model.vaults[0].ribs is None
    assert "vault is without ribs: a mirror vault like this has no lines" in next(note.text for note in model.notes)


@pytest.mark.parametrize("write", [write_step, write_ifc, write_glb])
def test_nothing_is_other_where_no_ribs_are_asked_for(write, tmp_path):
    model = assembly(RIBS)
    bare = replace(model, vaults=tuple(replace(placed, ribs=None) for placed in model.vaults))
    for name, one in (("a", bare), ("b", assembly(None))):
        write(one, tmp_path / name)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()
    assert b"diagonal_south" not in (tmp_path / "a").read_bytes()
