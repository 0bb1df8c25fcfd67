"""What is drawn, and that both back ends draw the same of it."""

import re
import xml.etree.ElementTree as ET
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from families import Annular, Barrel, Cloister, Groin, Rib
from families.declaration.corners import Skew
from families.declaration.palette import Colour, colour
from families.drawing.deviation_colours import LIMITS, STOPS, UNKNOWN, limit_of, shade, shades, signed_mm
from families.drawing.looks import CLOSER, LOOKS
from families.drawing.png import paint
from families.drawing.section import PLANES, chords, outlines, section
from families.drawing.sheet import Drawing, Line
from families.drawing.svg import NAMESPACE, document, svg
from families.drawing.view import LINES, view

DEVIATIONS = (-1.0, -0.01, -0.004, 0.0, 0.004, 0.01, 1.0)


def pixels(drawing, across=400):
    """The drawing painted on white, (rows, columns, 3), so many pixels wide."""
    width, height = drawing.size
    figure = Figure(figsize=(across / 100, across / 100 * height / width), dpi=100)
    paint(figure.add_axes((0, 0, 1, 1)), drawing)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3]


def marks(drawing, look):
    return [mark for mark in drawing.marks if getattr(mark, "look", None) == look]


def test_red_is_into_the_stone_and_blue_into_the_room():
    for deviation in (0.002, 0.01, 5.0):
        into, out = shade(deviation, 0.02), shade(-deviation, 0.02)
        assert into.red > into.blue
        assert out.blue > out.red
    assert shade(0.0, 0.02).hex == "#f7f7f7"
    assert shade(0.3, 0.02) == shade(0.02, 0.02) == STOPS[-1][1]
    assert shade(float("nan"), 0.02) == UNKNOWN


def test_most_points_are_within_the_limit():
    rng = np.random.default_rng(1)
    for size in (0.001, 0.004, 0.02, 0.1, 3.0):
        deviation = rng.normal(0, size, 1000)
        limit = limit_of(deviation)
        assert limit in LIMITS
        assert (np.abs(deviation) <= limit).mean() > 0.975 or limit == LIMITS[-1]
    assert limit_of(np.array([np.nan, 0.012])) == 0.02
    assert limit_of(np.zeros(0)) == LIMITS[0]


def test_deviations_are_written_with_their_sign():
    assert [signed_mm(d) for d in (-0.02, 0.0, 0.0301)] == ["−20 mm", "0", "+30 mm"]


@pytest.mark.parametrize("deviation", DEVIATIONS)
def test_a_deviation_has_one_colour_in_svg_and_png(deviation):
    drawing = Drawing((0, 0), (2, 1), "")
    drawing.cells(np.zeros(2), np.array([2.0, 1.0]), np.full((2, 1), deviation), 0.01)
    expected = shade(deviation, 0.01)
    assert re.findall('class="cells".*?fill="(.*?)"', svg(drawing)) == [expected.hex]
    picture = pixels(drawing)
    assert Colour(*picture[picture.shape[0] // 2, picture.shape[1] // 2].tolist()) == expected


def test_a_cell_without_deviation_is_left_open():
    drawing = Drawing((0, 0), (2, 1), "")
    drawing.cells(np.zeros(2), np.array([2.0, 1.0]), np.array([[np.nan], [0.01]]), 0.01)
    assert svg(drawing).count("M") == 1
    picture = pixels(drawing)
    middle = picture[picture.shape[0] // 2]
    assert (middle[120] == 255).all()
    assert (middle[280] == shades(np.array(0.01), 0.01)).all()


def test_areas_lines_and_dots_have_their_colours_in_both():
    drawing = Drawing((0, 0), (4, 2), "")
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    drawing.area([square], "unseen", colour(2))
    drawing.line([[2.0, 0.5], [2.6, 0.5]], "intrados", colour(3))
    drawing.dots(np.array([[3.5, 0.5]]), "deviation", np.array([[10, 120, 30]], np.uint8))
    tree = ET.fromstring(svg(drawing))
    area, line, dot = tree.iter("path")
    assert area.get("fill") == colour(2).hex
    assert line.get("stroke") == colour(3).hex
    assert dot.get("stroke") == "#0a781e"
    for path, look in ((line, "intrados"), (dot, "deviation")):
        assert path.get("stroke-width") == f"{LOOKS[look].width:g}pt"
    picture = pixels(drawing, 800)
    found = {tuple(rgb) for rgb in picture.reshape(-1, 3).tolist()}
    for shown in (colour(2), colour(3), Colour(10, 120, 30)):
        assert (shown.red, shown.green, shown.blue) in found


def test_the_same_words_stand_in_both():
    drawing = Drawing((0, 0), (4, 2), "A title")
    drawing.dimension((0.0, -0.3), (4.0, -0.3))
    drawing.scale(0.02)
    axes = Figure().add_subplot()
    paint(axes, drawing)
    words = [text.text for text in ET.fromstring(svg(drawing)).iter("text")]
    assert words == [text.get_text() for text in axes.texts] == ["4.00", "−20 mm", "room", "0", "+20 mm", "stone"]
    assert axes.get_title() == "A title"


def test_every_look_can_be_written_by_both():
    drawing = Drawing((0, 0), (1, 1), "")
    for look in LOOKS:
        drawing.line([[0.0, 0.0], [1.0, 1.0]], look)
        drawing.text((0.5, 0.5), "a < b", look)
    ET.fromstring(svg(drawing))
    pixels(drawing)


def test_the_outlines_of_sections_are_the_intrados_over_its_walls(any_vault):
    low, high = any_vault.plan.box
    tops = []
    for across, share in product((0, 1), (0.0, 0.6)):
        at = share * float(high[1 - across])
        found = outlines(any_vault, across, at)
        for line, component in found:
            points = np.full((len(line), 3), at)
            points[:, [across, 2]] = line
            assert np.abs(any_vault.distance(points[2:-2])).max() < 1e-6
            assert len(component) == len(line) - 1
            assert np.abs(any_vault.plan.distance(points[[0, -1], :2])).max() < 1e-9
            assert (line[[0, -1], 1] == 0).all()
        reach = np.concatenate([line for line, _ in found])
        top = any_vault.top - (0 if across else any_vault.lift)  # a ramp has climbed half its way there
        if (np.abs(any_vault.corners) == any_vault.plan.half).all():  # a rectangle
            assert (reach[0, 0], reach[-1, 0]) == pytest.approx((low[across], high[across]))
            if share == 0:
                arches = (any_vault.rise_y, any_vault.rise_x) if isinstance(any_vault, Rib) else None
                crown = max(any_vault.rise, arches[across]) if arches else top
                assert reach[:, 1].max() == pytest.approx(crown, rel=1e-3)
        tops.append(reach[:, 1].max() - top)
    if not getattr(any_vault, "splay", 0):  # else arches beside the middle are larger
        assert max(tops) == pytest.approx(0, abs=1e-3 * high[0])


def test_a_section_through_a_ring_has_two_parts():
    ring, ambulatory = Annular(5.0, 0.4, 2 * np.pi), Annular(5.0, 0.4, 4.0)
    for plane in PLANES:
        assert plane.chords(ring) == [pytest.approx((-6, -4)), pytest.approx((4, 6))]
        lines = [mark for mark in marks(section(ring, plane), "dimension") if len(mark.row) == 2]
        assert sum(np.hypot(*np.diff(mark.row, axis=0)[0]) == pytest.approx(2.0) for mark in lines) == 2
    (south, north) = chords(ambulatory.plan, 1, float(ambulatory.plan.box[0][1]) + 0.2)
    assert south[1] < 0 < north[0]
    assert len(chords(ambulatory.plan, 0, 0.0)) == 1


def test_a_section_of_a_ramp_measures_its_arch_where_it_stands():
    vault = Barrel(4.0, 6.0, slope=0.25)
    for plane in PLANES:
        drawing = section(vault, plane)
        # The second cut, nearer the wall that is looked at, is higher up the ramp.
        higher = 0.25 * plane.closer(vault) if plane.axis else 0.75
        assert drawing.high[1] == pytest.approx(2.75 + higher, abs=1e-3)
        upright = [mark.row for mark in marks(drawing, "dimension") if np.ptp(mark.row[:, 1]) > 1]
        assert upright[0][:, 1].tolist() == [0.75, 2.75]


def test_a_section_of_a_skewed_plan_ends_at_its_walls():
    vault = replace(Groin(4.0, 5.0), skew=Skew(0.1, 0.2, -0.1))
    for plane in PLANES:
        at = plane.closer(vault)
        assert abs(at) > CLOSER * 0.8 * vault.plan.half[plane.axis]
        (closer,) = marks(section(vault, plane), "closer")
        low, high = plane.clear(vault, at)
        assert (closer.row[0, 0], closer.row[-1, 0]) == pytest.approx((low, high))
        points = np.full((len(closer.row), 3), at)
        points[:, [plane.across, 2]] = closer.row
        assert np.abs(vault.distance(points[2:-2])).max() < 1e-3  # beside the surface distances are of first order


def test_a_chord_of_any_plan_with_corners():
    octagon = Cloister(8, 2.0).plan
    for axis in (0, 1):
        assert chords(octagon, axis, 0.0) == [pytest.approx((-2, 2))]
        ((low, high),) = chords(octagon, axis, 1.8)
        assert -2 < low < high < 2
        (low, high), *_ = chords(octagon, axis, 2.0)
        assert (low, high) == pytest.approx((-2 * np.tan(np.pi / 8), 2 * np.tan(np.pi / 8)))
        assert not chords(octagon, axis, 2.1)


def test_points_of_the_slab_alone_are_shown():
    vault, rng = Groin(), np.random.default_rng(4)
    points = vault.sample(20_000, rng).xyz
    for plane in PLANES:
        (dots,) = marks(section(vault, plane, points), "scan")
        near = plane.near(points)
        assert 0 < len(dots.points) <= len(near) < 0.1 * len(points)
        assert np.abs(points[near, plane.axis]).max() < 0.03


def test_a_section_is_drawn_in_the_colours_of_its_components():
    vault = Groin()
    for plane in PLANES:
        lines = [mark for mark in section(vault, plane).marks if isinstance(mark, Line) and mark.colour is not None]
        assert lines
        assert all(line.colour == colour(vault.components.index(line.name) + 1) for line in lines)


def test_a_view_has_lines_of_every_component_in_its_colour(any_vault):
    lines = [mark for mark in view(any_vault).marks if mark.colour is not None]
    plumb = {"drum"}  # of which a line shows only where a section ends on it
    assert {line.name for line in lines} | plumb == {*any_vault.components} | plumb
    assert all(line.colour == colour(any_vault.components.index(line.name) + 1) for line in lines)
    assert {line.look for line in lines} == {"surface", "intrados"}


def test_a_view_is_as_large_as_the_vault_and_reaches_its_corners():
    vault = replace(Groin(4.0, 5.0), skew=Skew(0.1, 0.2, -0.1))
    drawing = view(vault)
    (ground,) = marks(drawing, "springing")
    rows = np.concatenate([mark.row for mark in drawing.marks])
    assert (rows > drawing.low - 1e-9).all()
    assert (rows < drawing.high + 1e-9).all()
    straight = view(Groin(4.0, 5.0))
    (ground,) = marks(straight, "springing")
    wall_arches = np.concatenate([mark.row for mark in marks(straight, "surface")])
    for corner in ground.row:
        assert np.hypot(*(wall_arches - corner).T).min() < 0.01
    assert len({tuple(mark.row.ravel()) for mark in marks(straight, "surface")}) >= 2 * (LINES - 1)


def test_a_drawing_as_a_file_is_of_the_scale_and_needs_no_page():
    drawing = Drawing((0, 0), (4, 2), "A title")
    drawing.text((1, 1), "word", "size")
    tree = ET.fromstring(document(drawing, 50.0))
    assert tree.tag == f"{{{NAMESPACE}}}svg"
    assert (float(tree.get("width")), float(tree.get("height"))) == pytest.approx([50 * s for s in drawing.size], abs=1)
    assert "color:#" in tree.get("style")
