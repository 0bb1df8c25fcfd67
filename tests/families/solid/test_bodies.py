"""Bodies laid from surfaces: the lines in which these meet, what happens where they nearly coincide, plane ends."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from families import (
    Barrel,
    BasketHandle,
    Cloister,
    Dome,
    Elliptical,
    Groin,
    Lunette,
    Mirror,
    Pointed,
    Rib,
    Segmental,
    Semicircular,
    Stilted,
    Trough,
)
from families.solid import brep
from families.solid.boundary import Step
from families.solid.curves import Bezier, Conic, Straight, arc_parameter, arc_poles, arc_weight, point
from families.solid.face_net import Net, Patch
from families.solid.occ.shapes import faces, is_sound, volume
from families.solid.plane_regions import area, regions
from families.solid.surfaces import Flat
from families.void.profile_outline import Bow
from fuzz.bodies import room_of, stone_of, volume_of
from fuzz.vaults import anywhere

T = 0.15

# Each was a body with a gap or a fault once: crowns that rise from the axis on, stilts of two heights, lunettes that
# touch or overlap when grown, walls and slivers of a millimetre, arcs that pass into each other at one height.
HARD = [
    Groin(2.6037, 1.9624, Stilted(0.8544), crown_rise_ratio=0.3, offset_y_ratio=0.0715),
    Groin(6.824125, 2.2170875, Stilted(0.70894), Segmental(0.09136), 0.3, 0.19723, 0.045),
    Groin(2.884157, 2.302801, BasketHandle(0.38908, 0.71665), Segmental(0.05), 0.3, 0.203, 0.063),
    Groin(5.169644, 5.137070, Stilted(0.5436485), Stilted(0.5436485), offset_x_ratio=0.033),
    Groin(4.524956, 5.215222, Elliptical(0.3946), Elliptical(0.3946), 0.0418, 0.0496, 0.0493),
    Groin(11.1564, 4.5579, BasketHandle(0.49, 0.2)),
    Groin(1.8244548, 3.3402214, BasketHandle(0.2275, 0.3428), Stilted(0.5947), 0.29, 0.18, 0.26),
    Groin(5.0195, 5.0135, Elliptical(0.4943), Elliptical(0.495)),
    Trough(1.815932, 5.224395, Stilted(0.70894), 0.1, 1.0),
    Trough(3.644363, 5.115338, south_ratio=0.7281247, north_ratio=0.5897775),
    Trough(2.009284, 2.83031, BasketHandle(0.49, 0.3563), 0.2246, 0.9325),
    Trough(7.730755, 9.155585, Elliptical(1.0), 0.452, 0.1),
    Mirror(4.627233, 6.745402, 0.4142147, 0.2841531, 0.9916759),
    Lunette(8.7666, 1.8576, Stilted(0.5), 6, 0.936, -1.0, 1.0, 0.0, Stilted(0.937)),
    Lunette(6.4682, 2.9117, Semicircular(), 6, 0.3, -0.78, 1.0, 0.129, Elliptical(0.1)),
    Lunette(10.4413, 1.8653, Elliptical(1.0), 8, 0.784, 1.0, 0.441, 0.0, Semicircular()),
    Lunette(5.3903, 9.7568, Elliptical(0.32235), 4, 0.9117, 0.0, 0.9097, 0.095),
    Dome(2.0, BasketHandle(), drum_ratio=0.0, pendentive_ratio=1.2),
    Rib.drawn(np.random.default_rng(7028)),  # an edge there is hardly longer than a vertex
    anywhere(Groin, 11),  # there one is shorter than a millimetre
    anywhere(Barrel, 108),  # a ramp whose outer walls reach below its springing
]


@pytest.mark.parametrize("vault", HARD, ids=repr)
def test_hard_vaults_have_the_volume_of_the_numeric_surface(vault):
    stone, room = brep.masonry(vault, T), brep.void(vault)
    assert is_sound(stone)
    assert is_sound(room)
    for body, within in ((room, room_of(vault)), (stone, stone_of(vault, T))):
        size, deviation = volume_of(vault, within, T)
        assert volume(body) / 1e9 == pytest.approx(size, abs=5 * deviation)


@pytest.mark.parametrize(
    "path",
    [
        Straight.through((100.0, 7.0, 50.0), (0.0, 0.6, 0.8)),
        Conic((1.0, 2.0, 3.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0), 2000.0, 2000.0),
        Conic((1.0, 2.0, 3.0), (0.0, 0.0, 1.0), (0.0, -1.0, 0.0), 3000.0, 1000.0),
        Bezier(np.array([[0.0, -500, 0], [0.0, 0, 300], [0.0, 500, 0]])),
        Bezier(np.array([[2000.0, 0, 0], [2000.0, 0, 2000], [0.0, 0, 2000]]), arc_weight(pi / 2)),
    ],
    ids=lambda path: type(path).__name__,
)
def test_paths_are_opencascades_curves_and_know_their_parameters(path):
    t = np.linspace(0.05, 0.95, 11)
    points = path.points(t)
    drawn = [path.geometry.Value(value) for value in t.tolist()]
    assert points == pytest.approx(np.array([(p.X(), p.Y(), p.Z()) for p in drawn]), abs=1e-9)
    assert path.parameters(points) == pytest.approx(t, abs=1e-7)
    assert path.parameter(point(points[3])) == pytest.approx(t[3], abs=1e-7)


def test_a_bezier_arc_is_a_conic_with_another_parameter():
    bow = Bow(0.4, -0.2, 1.5, 2.5, 0.2, 1.3)
    angles = np.linspace(bow.start, bow.end, 9)
    poles = np.insert(arc_poles(bow), 1, 0.0, axis=1)
    arc = Bezier(poles, arc_weight(bow.end - bow.start))
    u, z, *_ = bow.trace(angles)
    assert arc.points(arc_parameter(angles, bow.start, bow.end))[:, [0, 2]] == pytest.approx(np.stack([u, z], axis=1))


def square(size: float, reverse: bool = False) -> list[Step]:
    corners = size * np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], float)
    steps = []
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        path = Straight.between(point(start), point(end))
        steps.append(Step(path, path.parameter(point(start)), path.parameter(point(end))))
    return [step.reversed for step in steps[::-1]] if reverse else steps


def test_regions_have_their_holes_and_are_told_from_islands():
    steps = [*square(10), *square(5, reverse=True), *square(2)]
    steps = steps[::2] + steps[1::2]
    net = Net()
    found = regions(Flat.level(0.0).parameters, steps, [net.ends(step) for step in steps])
    assert sorted(len(loops) for loops in found) == [1, 2]
    outlines = [np.array([step.places[0][:2] for step in loops[0]]) for loops in found]
    assert sorted(abs(area(outline)) for outline in outlines) == [16, 400]


def test_a_boundary_with_a_gap_is_refused():
    net, steps = Net(), square(10)[:3]
    with pytest.raises(ValueError, match=r"do not close at .* m; change a parameter"):
        regions(Flat.level(0.0).parameters, steps, [net.ends(step) for step in steps])


def test_an_edge_is_cut_where_another_ends_on_it_and_is_shared():
    net = Net()
    plane, line = Flat.level(0.0), Straight((1.0, 0.0, 0.0), (0.0, 10.0, 0.0))
    net.vertex((3.0, 10.0, 0.0))
    (loop,) = net.cut([[Step(line, -10.0, 10.0)]])
    assert [(step.start, step.end) for step in loop] == [(-10, 3), (3, 10)]
    first, last = (net.edge(step) for step in loop)
    assert net.edge(Step(line, 10.0, 3.0)) == (last[0], False)
    assert net.edge(Step(line, -10.0, 3.0)) == first
    assert net.edge(Step(Straight((1.0, 0.0, 0.0), (0.0, 50.0, 0.0)), 4.0, 4.0 + 1e-5)) is None
    net.add(Patch(plane, net.cut([square(10)])))
    assert len(net.edges) == 5
    with pytest.raises(ValueError, match="gap"):
        net.solids()


def test_faces_share_edges_and_cells_are_joined_without_sewing():
    from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE
    from OCP.TopExp import TopExp
    from OCP.TopTools import TopTools_IndexedDataMapOfShapeListOfShape

    shape = brep.masonry(Groin(4.0, 5.0, Pointed(), Segmental()), T)
    shared = TopTools_IndexedDataMapOfShapeListOfShape()
    TopExp.MapShapesAndAncestors_s(shape, TopAbs_EDGE, TopAbs_FACE, shared)
    assert {shared.FindFromIndex(k).Size() for k in range(1, shared.Extent() + 1)} == {2}
    assert all(face.Location().IsIdentity() for face in faces(shape))


def test_an_edge_that_leads_nowhere_is_told():
    with pytest.raises(ValueError, match="change a parameter a little"):
        Net().vertex((0.0, float("nan"), 0.0))


def test_a_ridge_that_ends_where_an_arc_does_is_one_edge():
    from OCP.BRepAdaptor import BRepAdaptor_Curve
    from OCP.GeomAbs import GeomAbs_BSplineCurve
    from OCP.TopAbs import TopAbs_EDGE
    from OCP.TopExp import TopExp
    from OCP.TopoDS import TopoDS
    from OCP.TopTools import TopTools_IndexedMapOfShape

    vault = Cloister(8, 3.0, Semicircular(), diagonal_ratio=1.06, crossing=1)
    for face, name in brep.face_names(brep.surface(vault), vault):
        edges = TopTools_IndexedMapOfShape()
        TopExp.MapShapes_s(face, TopAbs_EDGE, edges)
        found = [BRepAdaptor_Curve(TopoDS.Edge_s(edges.FindKey(k))).GetType() for k in range(1, edges.Extent() + 1)]
        # Webs that are not as wide are cut once more beside the crown, where their ridges turn.
        assert found.count(GeomAbs_BSplineCurve) <= 4, name


def test_a_body_is_the_same_to_the_last_digit_whatever_was_built_before(tmp_path):
    from OCP.BRepTools import BRepTools

    def written(name):
        BRepTools.Write_s(brep.masonry(Lunette(count=2, pitch_ratio=0.8), T), str(tmp_path / name))
        return (tmp_path / name).read_bytes()

    first = written("first")
    brep.masonry(Lunette(count=2, pitch_ratio=0.8, shift_ratio=0.37), T)
    assert written("second") == first
