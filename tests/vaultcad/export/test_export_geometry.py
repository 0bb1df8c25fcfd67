"""Bodies of components: closed, without gap or overlap, and the same on either side where the vault is."""

from collections import Counter

import numpy as np
import pytest
import trimesh

from families import FAMILIES, Dome, Groin, Lunette, Mirror, Pointed, Segmental, Stilted, Trough
from families.solid.mesh import Mesh
from vaultcad.errors import ExportError
from vaultcad.export.component_bodies import Body
from vaultcad.export.drawing import cut
from vaultcad.export.geometry import bodies, shell
from vaultcad.export.mesh_borders import closed, loops
from vaultcad.scanner import draw

THICKNESS = 0.15
VAULTS = [
    *(cls() for cls in FAMILIES),
    Groin(5, 4, Segmental(0.4), Pointed(0.6)),  # groins that are curved in plan
    Groin(5, 4, offset_x_ratio=0.1, offset_y_ratio=0.05),  # wall arches outside the springings
    Groin(5, 4, Stilted(), Segmental(0.4)),
    Trough(5, 5, south_ratio=1, north_ratio=1),  # a cloister vault
    Mirror(plane_ratio=0.6),
    Dome(pendentive_ratio=0.5, drum_ratio=0),
]
BOX = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float) * (2, 3, 4)
FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
TRIANGLES = np.array([[f[0], f[k], f[k + 1]] for f in FACES for k in (1, 2)], dtype=np.int32)


def is_closed(triangles):
    edges = Counter(map(tuple, np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)]).tolist()))
    return all(count == 1 and edges[b, a] == 1 for (a, b), count in edges.items())


@pytest.mark.parametrize("vault", VAULTS, ids=[f"{vault.id}-{k}" for k, vault in enumerate(VAULTS)])
def test_bodies_share_the_masonry_out(vault):
    pieces, whole = bodies(vault, THICKNESS), shell(vault, THICKNESS)
    assert [body.name for body in pieces] == list(vault.components)
    assert all(is_closed(body.triangles) for body in pieces)
    assert min(body.volume for body in pieces) > 0
    solid = Body(0, "", whole.vertices, whole.triangles, 0.0)
    assert sum(body.volume for body in pieces) == pytest.approx(solid.volume, rel=1e-9)


@pytest.mark.parametrize("vault", [*VAULTS, *(draw(Lunette, np.random.default_rng(k))[0] for k in (14, 17, 21, 33))])
def test_a_body_is_one_piece_with_a_volume(vault):
    for body in bodies(vault, THICKNESS):
        parts = trimesh.Trimesh(body.vertices, body.triangles, process=False).split(only_watertight=False)
        assert [part.volume > 1e-6 for part in parts] == [True], body.name


@pytest.mark.parametrize(
    ("vault", "pairs"),
    [
        (VAULTS[FAMILIES.index(Groin)], [("web_south", "web_north"), ("web_west", "web_east")]),
        (VAULTS[len(FAMILIES) + 1], [("web_south", "web_north"), ("web_west", "web_east")]),
        (VAULTS[FAMILIES.index(Mirror)], [("cove_south", "cove_north"), ("cove_west", "cove_east")]),
        (VAULTS[FAMILIES.index(Dome)], [("pendentive_south_west", "pendentive_north_east")]),
    ],
    ids=["groin", "groin with offsets", "mirror", "dome"],
)
def test_opposite_components_get_as_much(vault, pairs):
    volume = {body.name: body.volume for body in bodies(vault, THICKNESS)}
    for one, other in pairs:
        assert volume[one] == pytest.approx(volume[other], rel=1e-3)


def test_a_body_lies_over_its_own_component():
    vault = VAULTS[len(FAMILIES)]
    for body in bodies(vault, THICKNESS):
        surface = vault.evaluate(body.vertices[body.triangles].mean(axis=1))
        on_intrados = np.abs(surface.distance) < 0.003
        assert on_intrados.any()
        assert (surface.component[on_intrados] == body.id).mean() > 0.97


def test_a_box_is_cut_in_a_rectangle():
    (row,) = cut(Body(1, "box", BOX, TRIANGLES, 0.0), axis=1, at=1.0)
    assert np.allclose(row[:, 1], 1.0)
    assert set(map(tuple, row[:, [0, 2]].tolist())) >= {(0.0, 0.0), (2.0, 0.0), (2.0, 4.0), (0.0, 4.0)}
    x, z = row[:, 0], row[:, 2]
    assert abs(x @ np.roll(z, -1) - z @ np.roll(x, -1)) / 2 == pytest.approx(8.0)


def test_a_sliver_that_is_missing_is_put_back():
    """The box with the middle of one edge 1 mm out: its two faces meet there, but one goes straight past."""
    bent = np.concatenate([BOX, [[1.0, 0.0, -0.001]]])  # on the edge from 0 to 4
    others = [t for t in TRIANGLES.tolist() if t not in ([0, 4, 5], [0, 5, 1])]
    triangles = np.array([*others, [0, 8, 1], [8, 5, 1], [8, 4, 5]], dtype=np.int32)
    whole = closed(Mesh(bent, triangles, np.ones(len(triangles), dtype=np.uint16)))
    assert not is_closed(triangles)
    assert is_closed(whole.triangles)
    assert whole.component[len(triangles) :].tolist() == [0]
    assert Body(1, "box", bent, whole.triangles, 0.0).volume == pytest.approx(24.0, rel=1e-3)


def test_a_level_face_that_is_missing_is_put_back_with_its_hole():
    """A tube through a box: without its top, which is a ring, it has two borders in one plane."""
    outer, inner = BOX, (BOX - BOX.mean(axis=0)) * (0.5, 0.5, 1) + BOX.mean(axis=0)
    level = [f for f in FACES if BOX[f, 2].min() == BOX[f, 2].max()]
    sides = [f for f in FACES if f not in level]
    faces = [*sides, *([8 + k for k in reversed(f)] for f in sides)]
    triangles = np.array([[f[0], f[k], f[k + 1]] for f in faces for k in (1, 2)], dtype=np.int32)
    tube = closed(Mesh(np.concatenate([outer, inner]), triangles, np.ones(len(triangles), dtype=np.uint16)))
    assert is_closed(tube.triangles)
    assert Body(1, "tube", tube.vertices, tube.triangles, 0.0).volume == pytest.approx(24 - 6)


def test_a_hole_in_no_plane_is_refused():
    corner = [k for k, t in enumerate(TRIANGLES.tolist()) if t not in ([0, 5, 1], [0, 1, 3])]
    with pytest.raises(ExportError, match="has a hole between"):
        closed(Mesh(BOX, TRIANGLES[corner], np.ones(len(corner), dtype=np.uint16)))


def test_the_border_of_a_patch_is_one_loop_in_its_direction():
    assert loops(TRIANGLES) == []
    (loop,) = loops(TRIANGLES[:2])
    assert loop[loop.index(0) :] + loop[: loop.index(0)] == [0, 1, 3, 2]


def test_the_box_of_this_test_is_closed_and_right():
    box = Body(1, "box", BOX, TRIANGLES, 0.0)
    assert is_closed(TRIANGLES)
    assert box.volume == pytest.approx(24.0)
