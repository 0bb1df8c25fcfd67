"""One drawing and one colour in all that is written of a fit."""

import json
import re
import struct
from pathlib import Path

import numpy as np
import plotly.colors
import pytest
from matplotlib.figure import Figure

from families.declaration.palette import colour
from families.drawing.deviation_colours import limit_of, shade
from families.drawing.png import paint
from families.drawing.section import PLANES
from families.drawing.svg import svg
from vaultcad.export.building_plan import building_plans
from vaultcad.export.drawing import deviations, plan, section
from vaultcad.export.glb import write_glb
from vaultcad.export.report_html import write_report_html
from vaultcad.export.review import draw_review
from vaultcad.export.seen import seen
from vaultcad.fit.label import Labels
from vaultcad.notebook import of_result
from vaultcad.pipeline import Result
from vaultcad.workbench.declarations import deviation_scale

ROOT = Path(__file__).parents[3]
DEVIATIONS = (0.01, -0.01, 0.003)  # m


def points_on(fitted):
    """Points of a vault in the scan's frame and their components."""
    sample = fitted.vault.sample(20_000, np.random.default_rng(3))
    out = fitted.pose.placement()
    return sample.xyz @ out[:3, :3].T + out[:3, 3], sample.component


def evidence(model, deviation):
    """Points that are all said to be so far off the vault [m]."""
    points, component = points_on(model.vaults[0])
    return points, component, np.full(len(points), deviation)


@pytest.mark.parametrize("deviation", DEVIATIONS)
def test_a_deviation_has_one_colour_everywhere(make_model, tmp_path, deviation):
    model = make_model("sail")
    points, component, off = evidence(model, deviation)
    limit = limit_of(off)
    expected = shade(deviation, limit)
    rgb = [expected.red, expected.green, expected.blue]

    write_report_html(model, tmp_path / "report.html", points, component, off)
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    (chart,) = re.findall('<svg class="chart".*?</svg>', page)
    (bar,) = re.findall('<rect[^>]*fill="(.*?)"', chart)
    low, high = (float(v) / 1000 for v in re.search(r"<title>(\S+) to (\S+) mm", chart).groups())
    assert low <= deviation <= high + 1e-4
    near = [shade(d, limit) for d in (low - 1e-4, high + 1e-4)]  # a bar has the colour of its middle
    between = np.sort([[c.red, c.green, c.blue] for c in near], axis=0)
    assert (between[0] <= list(bytes.fromhex(bar[1:]))).all()
    assert (list(bytes.fromhex(bar[1:])) <= between[1]).all()
    map_, *_ = (d for d in re.findall('<svg class="drawing".*?</svg>', page) if "<title>Deviation" in d)
    assert re.search('class="cells".*?fill="(.*?)"', map_)[1] == expected.hex
    assert set(re.findall('class="deviation" stroke="(.*?)"', page)) == {expected.hex}

    _, map_panel, *sections = draw_review(model, points, component, off).axes
    picture = np.asarray(map_panel.images[0].get_array()).reshape(-1, 4)
    assert np.unique(picture[picture[:, 3] > 0][:, :3], axis=0).tolist() == [rgb]
    for panel in sections:
        shades = np.asarray(panel.collections[-1].get_facecolors())[:, :3]
        assert np.unique(np.rint(255 * shades), axis=0).tolist() == [rgb]

    on = (component > 0).astype(np.uint16)
    labels = Labels(component, on, off.astype(np.float32), np.zeros_like(on))
    shown = of_result(Result(model, labels, points, component, labels.vault, off))
    (cloud,) = (trace for trace in shown["application/vnd.plotly.v1+json"]["data"] if trace["type"] == "scatter3d")
    marker = cloud["marker"]
    share = (marker["color"][0] - marker["cmin"]) / (marker["cmax"] - marker["cmin"])
    (told,) = plotly.colors.sample_colorscale(
        [[at, plotly.colors.label_rgb(plotly.colors.hex_to_rgb(c))] for at, c in marker["colorscale"]], share
    )
    assert plotly.colors.unlabel_rgb(told) == pytest.approx(rgb, abs=1)

    stops = deviation_scale()["stops"]  # as FreeCAD is told; its add-on is asked for a colour in test_in_freecad
    place = [np.interp(deviation / limit, [s for s, _ in stops], [c[k] for _, c in stops]) for k in range(3)]
    assert place == pytest.approx(expected.unit, abs=0.003)


def test_a_component_has_one_colour_in_svg_png_and_glb(make_model, tmp_path):
    model = make_model("groin")
    (vault,) = seen(model)
    names = vault.vault.components
    drawing = plan(vault)
    told = dict(re.findall('class="stone" fill="(.*?)".*?<title>(.*?)</title>', svg(drawing)))
    axes = Figure().add_subplot()
    paint(axes, drawing)
    write_glb(model, tmp_path / "model.glb")
    data = (tmp_path / "model.glb").read_bytes()
    head = json.loads(data[20 : 20 + struct.unpack_from("<I", data, 12)[0]])
    materials = {
        node["name"]: head["materials"][head["meshes"][node["mesh"]]["primitives"][0]["material"]]["name"]
        for node in head["nodes"]
        if "mesh" in node
    }
    for k, name in enumerate(names, 1):
        expected = colour(k)
        assert told[expected.hex] == name
        assert axes.patches[k - 1].get_facecolor()[:3] == pytest.approx(expected.unit)
        assert materials[name] == expected.hex


def test_legends_say_which_colour_is_which(make_model, tmp_path):
    model = make_model("sail")
    points, component, off = evidence(model, 0.004)
    (vault,) = seen(model, points, component, off)
    write_report_html(model, tmp_path / "report.html", points, component, off)
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert page.count("blue into the room, red into the stone") >= 2  # histogram and map
    assert "blue into the room, red into the stone" in deviations(vault).title


def test_every_family_is_drawn_by_both_back_ends(every_family):
    for fitted in every_family.vaults:
        points, component = points_on(fitted)
        model = type(every_family)(**{**vars(every_family), "vaults": (fitted,)})
        (vault,) = seen(model, points, component, np.full(len(points), 0.004))
        sections = [section(vault, plane) for plane in PLANES]
        for drawing in (
            plan(vault),
            plan(vault, scanned=True),
            deviations(vault),
            *sections,
            *building_plans(model, [vault]),
        ):
            assert svg(drawing).startswith("<svg")
            axes = Figure().add_subplot()
            paint(axes, drawing)
            assert axes.has_data() or axes.patches


def sources():
    for package in ("families", "segmentation", "vaultcad", "examples", "tools", "bench"):
        for path in sorted((ROOT / package).rglob("*.py")):
            yield path.relative_to(ROOT).as_posix(), path.read_text(encoding="utf-8")


def test_no_other_file_draws():
    sheets = "vaultcad/drawings/paper.py"  # in millimetres of paper
    writers = {"families/drawing/svg.py", "families/drawing/png.py", "vaultcad/export/charts.py", sheets}
    draws = re.compile(
        r"<(svg|path|polyline|rect)\b|\.(scatter|imshow|pcolormesh|add_patch)\(|axes\.(plot|fill|text)\("
    )
    assert {path for path, text in sources() if draws.search(text)} == writers


def test_no_other_file_has_a_scale_of_colours():
    scales = re.compile(r"\bcmap\b|RdBu|coolwarm|seismic|viridis|colormap|Colormap")
    deviations, heights = (f"families/drawing/{of}_colours.py" for of in ("deviation", "height"))
    assert {path for path, text in sources() if scales.search(text)} == {deviations, heights}
    asked = re.compile(r"\b(2166ac|b2182b|33, 102, 172|178, 24, 43)\b")
    assert {path for path, text in sources() if asked.search(text)} == {deviations}
