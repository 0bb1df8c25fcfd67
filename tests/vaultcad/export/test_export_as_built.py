"""The stone as it stands in STEP, GLB and IFC: beside the ideal body, alone, or left out."""

import dataclasses
import re

import ifcopenshell
import ifcopenshell.util.element
import numpy as np
import pytest
import trimesh

from families import FAMILIES, Lunette
from vaultcad.displacement import Displacement
from vaultcad.export.as_built import bodies_of, shell_of, solid_of
from vaultcad.export.buildable import buildable
from vaultcad.export.glb import write_glb
from vaultcad.export.ifc import write_ifc
from vaultcad.export.mesh_borders import loops
from vaultcad.export.step import write_step

DRAWN = ("ideal", "as-built", "both")


def sunk(size=0.02):
    """A field of waves over all families' sizes."""
    nodes = np.stack(np.meshgrid(*(np.arange(n) for n in (14, 14, 9)), indexing="ij"), axis=-1).astype(float)
    x, y, z = np.moveaxis(nodes, -1, 0)
    waves = np.stack(
        [np.sin(0.9 * x + 0.3 * y), np.cos(0.8 * y + 0.5 * z), -np.cos(0.5 * x) - np.sin(0.7 * z)], axis=-1
    )
    return Displacement(np.array([-7.0, -7.0, -1.0]), np.ones(3), size * waves)


def with_surface(model, surface, **changes):
    return dataclasses.replace(model, vaults=(dataclasses.replace(model.vaults[0], surface=surface),), **changes)


@pytest.fixture(scope="module")
def groin(make_model):
    return with_surface(make_model("groin"), sunk())


@pytest.mark.parametrize("cls", FAMILIES, ids=lambda cls: cls.id)
def test_displaced_meshes_are_closed_and_hold_as_much_stone_as_each_other(cls):
    vault, surface = cls(), sunk()
    mesh = shell_of(vault, 0.15, surface)
    assert not loops(mesh.triangles)
    parts = bodies_of(vault, 0.15, surface)
    whole = trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False).volume
    assert sum(part.volume for part in parts) == pytest.approx(
        whole, rel=2e-3
    )  # planes between parts are no planes now
    ideal = shell_of(vault, 0.15, None)
    places = surface.undone(mesh.vertices[mesh.triangles[mesh.component == 1].ravel()])
    assert np.abs(vault.distance(places)).max() < 0.004
    assert set(np.unique(mesh.component)) == set(np.unique(ideal.component))


@pytest.mark.parametrize("drawn", DRAWN)
def test_step_has_the_solids_that_are_asked_for_named_apart(groin, drawn, tmp_path):
    path = tmp_path / "model.step"
    write_step(dataclasses.replace(groin, drawn=drawn), path)
    text = path.read_text()
    solids = {"ideal": ["groin vault"], "as-built": ["groin vault as built"]}
    expected = solids.get(drawn, [*solids["ideal"], *solids["as-built"]])
    assert re.findall(r"PRODUCT\('([^']*)'", text)[1:] == expected  # the first is the assembly
    assert text.count("'web_south'") >= 2 * len(expected)
    assert "RATIONAL_B_SPLINE_SURFACE" not in text
    assert ("CYLINDRICAL_SURFACE" in text) is (drawn != "as-built")


@pytest.mark.parametrize("drawn", DRAWN)
def test_glb_has_nodes_of_both(groin, drawn, tmp_path):
    path = tmp_path / "model.glb"
    write_glb(dataclasses.replace(groin, drawn=drawn), path)
    nodes = set(trimesh.load(path).graph.nodes_geometry)
    ideal = {*groin.vaults[0].vault.components, "extrados"}
    stone = {f"as built/{name}" for name in ideal}
    assert nodes == {"ideal": ideal, "as-built": stone}.get(drawn, ideal | stone)


@pytest.mark.parametrize("drawn", DRAWN)
def test_ifc_tells_bodies_apart_by_their_identifiers(groin, drawn, tmp_path):
    path = tmp_path / "model.ifc"
    write_ifc(dataclasses.replace(groin, drawn=drawn), path)
    file = ifcopenshell.open(path)
    for slab in file.by_type("IfcSlab"):
        found = {r.RepresentationIdentifier: r for r in slab.Representation.Representations}
        assert list(found) == (["Body", "AsBuilt"] if drawn == "both" else ["Body"])
        for name, representation in found.items():
            stone = name == "AsBuilt" or drawn == "as-built"
            (body,) = (
                b for b in bodies_of(groin.vaults[0].vault, 0.15, sunk() if stone else None) if b.name == slab.Name
            )
            points = np.array(representation.Items[0].Coordinates.CoordList)
            assert points == pytest.approx(body.vertices, abs=1e-6)
            assert representation.ContextOfItems.ContextIdentifier == name
    (roof,) = file.by_type("IfcRoof")
    told = ifcopenshell.util.element.get_psets(roof)["VaultCAD_AsBuilt"]
    assert told["representation"] == {"ideal": "none", "as-built": "Body", "both": "AsBuilt"}[drawn]
    assert 0.005 < told["ideal_to_as_built_mean"] < told["ideal_to_as_built_max"] < 0.08


def test_a_surface_that_would_fold_the_body_is_left_out_and_said(make_model):
    model = buildable(with_surface(make_model("barrel"), sunk(2.0)))
    assert model.vaults[0].surface is None
    assert "files have its ideal body alone, for the as-built surface stretches" in model.notes[-1].text
    assert buildable(with_surface(make_model("barrel"), sunk(2.0), drawn="ideal")).notes == ()


def test_a_vault_with_mouths_is_built_displaced():
    assert solid_of(Lunette(), 0.15, sunk()) is solid_of(Lunette(), 0.15, sunk())  # made once
