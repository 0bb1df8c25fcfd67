"""Vaults as CadQuery's own objects, in millimetres, with a tag for each component."""

from functools import cache
from math import pi

import cadquery as cq
import numpy as np
import pytest

from families import FAMILIES, Groin, ideal
from vaultcad.cadquery import on_workplane, vault

S = 5.0  # m

# Exact volumes [m³] of the rooms under vaults of a square plan of side S, as in FAMILIES: half a cylinder, a cloister,
# two barrels that cross, and a hemisphere less half of the four caps beyond its sides.
R = S / 2**0.5
EXACT = [
    (vault("botte", span=S, length=S), pi * S**3 / 8),
    (vault("padiglione", span_x=S, span_y=S, south_ratio=1, north_ratio=1), S**3 / 3),
    (vault("crociera", span_x=S, span_y=S), (pi / 4 - 1 / 3) * S**3),
    (
        vault("vela", span_x=S, span_y=S, rise_ratio=1),
        2 / 3 * pi * R**3 - 2 / 3 * pi * (R - S / 2) ** 2 * (2 * R + S / 2),
    ),
]


@cache
def made(name, thickness=None):
    return vault(name, thickness=thickness)


@pytest.fixture(params=[cls.id for cls in FAMILIES])
def name(request):
    return request.param


def block(body, wall=300.0):
    """A box on the springing, larger than a body on all other sides."""
    box = body.val().BoundingBox()
    size = (box.xlen + 2 * wall, box.ylen + 2 * wall, box.zlen + wall)
    return cq.Workplane().box(*size, centered=(True, True, False))


@pytest.mark.parametrize("thickness", [None, 0.2])
def test_a_tag_selects_the_faces_of_its_component_and_no_others(name, thickness):
    body, truth = made(name, thickness), ideal(name)
    assert body.val().isValid()
    left = set(body.faces().vals())
    for k, component in enumerate(truth.components, 1):
        faces = body.faces(tag=component).vals()
        assert faces
        assert left.issuperset(faces)
        left.difference_update(faces)
        for face in faces:
            vertices, triangles = face.tessellate(20.0, 0.1)
            points = np.array([vertex.toTuple() for vertex in vertices]) / 1000
            assert np.abs(truth.distance(points)).max() < 1e-6
            inside = truth.evaluate(points[np.array(triangles)].mean(axis=1))
            assert (inside.component == k).mean() > 0.9
    tags = ("side",) if thickness is None else ("side", "extrados")
    assert left == {face for tag in tags for face in body.faces(tag=tag).vals()}


def test_tagged_faces_have_the_exact_area():
    body = vault("groin", span_x=S, span_y=S)
    for component in Groin().components:
        area = sum(face.Area() for face in body.faces(tag=component).vals())
        assert area / 1e6 == pytest.approx((pi - 2) * S**2 / 4, rel=1e-9)


@pytest.mark.parametrize(("body", "volume"), EXACT)
def test_a_box_keeps_exactly_what_is_not_under_the_vault(body, volume):
    box = block(body)
    left = box.cut(body)
    assert left.val().isValid()
    assert (box.val().Volume() - left.val().Volume()) / 1e9 == pytest.approx(volume, rel=1e-7)


def test_a_box_with_a_vault_cut_out_of_it_and_the_vault_make_the_box(name):
    body = made(name)
    box = block(body)
    left, shared = box.cut(body), box.intersect(body)
    assert left.val().isValid()
    room = body.val().Volume(1e-7)
    assert shared.val().Volume(1e-7) == pytest.approx(room, rel=1e-6)
    assert box.val().Volume() - left.val().Volume(1e-7) == pytest.approx(room, rel=1e-6)


def test_faces_may_be_joined(name):
    """OpenCASCADE crashed on the quarters of a dome."""
    body = made(name, 0.2)
    joined = body.val().clean()
    assert joined.isValid()
    assert joined.Volume(1e-7) == pytest.approx(body.val().Volume(1e-7), rel=1e-6)


def test_masonry_is_the_shell_of_the_room():
    room, stone = vault("barrel", span=4, length=6), vault("barrel", span=4, length=6, thickness=0.25)
    assert room.val().Volume() / 1e9 == pytest.approx(pi / 2 * 2**2 * 6)
    assert stone.val().Volume() / 1e9 == pytest.approx(pi / 2 * (2.25**2 - 2**2) * 6)
    assert room.intersect(stone).vals() == [] or room.intersect(stone).val().Volume() == pytest.approx(0, abs=1)


def test_a_room_with_a_vault_is_shelled():
    """A room of 3 m with a barrel vault over it, walls of 0.3 m all around, the floor open."""
    walls = cq.Workplane().box(4000, 6000, 3000, centered=(True, True, False))
    room = walls.union(vault("barrel", span=4, length=6).translate((0, 0, 3000)))
    shell = room.faces("<Z").shell(300, kind="intersection")
    assert shell.val().isValid()
    inside = 4 * 6 * 3 + pi / 2 * 2**2 * 6
    outside = 4.6 * 6.6 * 3 + pi / 2 * 2.3**2 * 6.6
    assert shell.val().Volume() / 1e9 == pytest.approx(outside - inside, rel=1e-6)


def test_lengths_go_in_as_metres_and_come_out_as_millimetres_or_metres():
    small, large = vault("sail", span_x=4, span_y=3, unit="m"), vault("sail", span_x=4, span_y=3)
    assert small.val().BoundingBox(1e-6).xlen == pytest.approx(4, abs=1e-3)
    assert large.val().BoundingBox(1e-3).xlen == pytest.approx(4000, abs=1)
    assert large.val().Volume() == pytest.approx(1e9 * small.val().Volume())
    assert len(small.faces(tag="sail").vals()) == 1


def test_the_plugin_puts_the_vault_on_the_workplane():
    upright = cq.Workplane("XZ", origin=(0, 1000, 0)).vault("crociera", span_x=6, span_y=4)
    box = upright.val().BoundingBox()
    assert (box.zmin, box.zmax) == pytest.approx((-2000, 2000), abs=1)
    assert (box.ymin, box.ymax) == pytest.approx((1000 - 3000, 1000), abs=1)
    assert upright.val().Volume() == pytest.approx(vault("groin", span_x=6, span_y=4).val().Volume(), rel=1e-9)
    assert cq.Workplane.vault is on_workplane


def test_a_vault_stands_at_each_point_and_is_joined_to_the_body_or_cut_out_of_it():
    spots = [(0, -4000), (0, 0), (0, 4000)]
    one = vault("groin", span_x=4, span_y=4).val().Volume()
    bays = cq.Workplane().pushPoints(spots).vault("groin", span_x=4, span_y=4, combine=False)
    assert [body.Volume() for body in bays.vals()] == pytest.approx([one] * 3)
    assert [body.Center().y for body in bays.vals()] == pytest.approx([y for _, y in spots], abs=1e-6)
    assert len(bays.faces(tag="web_south").vals()) == 3 * len(vault("groin").faces(tag="web_south").vals())

    nave = cq.Workplane().box(5000, 13000, 3000, centered=(True, True, False))
    hall = nave.faces("<Z").workplane(invert=True).pushPoints(spots).vault("groin", span_x=4, span_y=4, combine="cut")
    assert hall.val().isValid()
    assert nave.val().Volume() - hall.val().Volume() == pytest.approx(3 * one, rel=1e-6)

    base = cq.Workplane().box(6000, 6000, 500, centered=(True, True, False))
    topped = base.faces(">Z").workplane().vault("barrel", span=4, length=4, thickness=0.2)
    assert len(topped.solids().vals()) == 1
    stone = vault("barrel", span=4, length=4, thickness=0.2).val().Volume()
    assert topped.val().Volume() == pytest.approx(base.val().Volume() + stone)


def test_a_fitted_or_made_vault_is_taken_as_it_is():
    groin = Groin(4.0, 4.5)
    assert vault(groin, thickness=0.2).val().Volume() == pytest.approx(groin.solid(0.2).volume)
    with pytest.raises(ValueError, match="made already"):
        vault(groin, span_x=3)


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"span_x": 5000}, r"span_x = 5000 lies outside \[0.5, 40\] m"),
        ({"thickness": 150}, r"thickness = 150 lies outside \[0.01, 5\] m"),
        ({"thickness": float("nan")}, "thickness = nan"),
        ({"unit": "cm"}, "choose one of mm, m"),
        ({"rise": 3}, "has no 'rise'"),
    ],
)
def test_what_cannot_be_is_refused_by_name(given, told):
    with pytest.raises(ValueError, match=told):
        vault("groin", **given)


def test_step_and_back(name, tmp_path):
    body = made(name, 0.2)
    body.export(str(tmp_path / "vault.step"))
    back = cq.importers.importStep(str(tmp_path / "vault.step"))
    assert back.val().isValid()
    assert back.val().Volume() == pytest.approx(body.val().Volume(), rel=1e-5)
    assert len(back.faces().vals()) == len(body.faces().vals())


def test_an_assembly_holds_vaults_and_is_written(tmp_path):
    room, dome = made("groin", 0.2), made("dome", 0.2)
    assembly = cq.Assembly(name="church").add(room, name="bay", color=cq.Color("tan"))
    assembly.add(dome, name="crossing", loc=cq.Location((0, 8000, 0)))
    assert assembly.toCompound().Volume() == pytest.approx(room.val().Volume() + dome.val().Volume())
    assembly.export(str(tmp_path / "church.step"))
    back = cq.importers.importStep(str(tmp_path / "church.step"))
    assert sum(body.Volume() for body in back.vals()) == pytest.approx(assembly.toCompound().Volume(), rel=1e-6)


def test_a_tag_places_a_part_in_an_assembly():
    """A keystone hung under the crown of the mirror, by the tag of its plane."""
    body = vault("mirror")
    keystone = cq.Workplane().box(200, 200, 100, centered=(True, True, False))
    assembly = cq.Assembly(body, name="vault").add(keystone, name="keystone")
    assembly.constrain("vault?plane", "keystone@faces@>Z", "Plane", 0).solve()
    placed = keystone.val().moved(assembly.objects["keystone"].loc)
    assert placed.BoundingBox().zmax == pytest.approx(1000 * ideal("mirror").derived_values()["rise"], abs=0.1)
