"""GLB, read back from its chunks by hand and by pygltflib."""

import json
import struct

import numpy as np
import pytest

from families import FAMILIES
from vaultcad.export.glb import write_glb
from vaultcad.export.palette import colour

IDS = [cls.id for cls in FAMILIES]


@pytest.fixture(scope="module")
def path(every_family, tmp_path_factory):
    path = tmp_path_factory.mktemp("glb") / "model.glb"
    write_glb(every_family, path)
    return path


@pytest.fixture(scope="module")
def chunks(path):
    """The JSON and the binary chunk, as glTF 2.0, section 4.4, lays them out."""
    data = path.read_bytes()
    magic, version, length = struct.unpack_from("<4sII", data)
    assert (magic, version, length) == (b"glTF", 2, len(data))
    size, kind = struct.unpack_from("<I4s", data, 12)
    assert kind == b"JSON"
    head, at = json.loads(data[20 : 20 + size]), 20 + size
    size, kind = struct.unpack_from("<I4s", data, at)
    assert kind == b"BIN\0"
    return head, data[at + 8 : at + 8 + size]


def array(chunks, index, kind, width):
    head, binary = chunks
    accessor = head["accessors"][index]
    start = head["bufferViews"][accessor["bufferView"]].get("byteOffset", 0) + accessor.get("byteOffset", 0)
    return np.frombuffer(binary, kind, accessor["count"] * width, start).reshape(-1, width)


def patch(chunks, name):
    """Points (n, 3) and triangles (m, 3) of the mesh of a node."""
    head = chunks[0]
    (node,) = (n for n in head["nodes"] if n.get("name") == name)
    assert "matrix" not in node
    (primitive,) = head["meshes"][node["mesh"]]["primitives"]
    kind = {5123: "<u2", 5125: "<u4"}[head["accessors"][primitive["indices"]]["componentType"]]
    points = array(chunks, primitive["attributes"]["POSITION"], "<f4", 3).astype(float)
    return points, array(chunks, primitive["indices"], kind, 1).reshape(-1, 3), primitive


@pytest.mark.parametrize("k", range(len(IDS)), ids=IDS)
def test_each_component_is_a_node_on_its_place(chunks, every_family, k):
    fitted = every_family.vaults[k]
    for component, name in enumerate(fitted.vault.components, 1):
        points, triangles, primitive = patch(chunks, f"{k + 1}/{name}")
        x, y, z = points.T
        surface = fitted.vault.evaluate(np.column_stack([x, -z, y]), frame=fitted.pose.frame())  # z up again
        assert np.abs(surface.distance).max() < 1e-4
        assert triangles.max() < len(points)
        base = chunks[0]["materials"][primitive["material"]]["pbrMetallicRoughness"]["baseColorFactor"]
        srgb = np.where(np.array(base) > 0.0031308, 1.055 * np.array(base) ** (1 / 2.4) - 0.055, 12.92 * np.array(base))
        assert srgb[:3] == pytest.approx(colour(component).unit, abs=0.02)


def test_normals_of_the_intrados_face_the_room(chunks, every_family):
    fitted = every_family.vaults[IDS.index("sail")]
    points, _, primitive = patch(chunks, f"{IDS.index('sail') + 1}/sail")
    normals = array(chunks, primitive["attributes"]["NORMAL"], "<f4", 3)
    x, y, z = points.T
    into_stone = fitted.vault.evaluate(np.column_stack([x, -z, y]), frame=fitted.pose.frame()).normal
    up = into_stone[:, [0, 2, 1]] * (1, 1, -1)
    assert np.einsum("ij,ij->i", normals, up).max() < -0.9


def test_another_reader_finds_the_nodes(path, every_family):
    import pygltflib

    nodes = {node.name for node in pygltflib.GLTF2().load(str(path)).nodes}
    assert {f"{k}/extrados" for k in range(1, len(IDS) + 1)} <= nodes


def test_one_vault_alone_has_plain_names(make_model, tmp_path):
    import pygltflib

    write_glb(make_model("barrel"), tmp_path / "model.glb")
    assert [node.name for node in pygltflib.GLTF2().load(str(tmp_path / "model.glb")).nodes] == ["barrel", "extrados"]


def test_the_same_model_gives_the_same_bytes(path, every_family, tmp_path):
    write_glb(every_family, tmp_path / "model.glb")
    assert (tmp_path / "model.glb").read_bytes() == path.read_bytes()
