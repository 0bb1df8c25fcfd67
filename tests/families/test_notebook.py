"""What a vault shows in a notebook: sections and sizes, and a 3D view where there is a library for it."""

import re
import xml.etree.ElementTree as ET

import numpy as np
import plotly.graph_objects as go
import pytest
from IPython.core.formatters import DisplayFormatter

from families import FAMILIES, Groin, Pointed, notebook
from families.declaration.parameters import derived_declarations
from families.notebook import HTML, PLOTLY


def displayed(value):
    found, _ = DisplayFormatter(active_types=["text/plain", HTML, PLOTLY]).format(value)
    return found


def test_a_vault_displays_its_sections_and_sizes(default_vault):
    page = displayed(default_vault)[HTML]
    assert default_vault.title.capitalize() in page
    derived = derived_declarations(type(default_vault))
    units = {p.name: p.range.unit for p in default_vault.parameters()} | {k: d.unit for k, d in derived.items()}
    for name, value in (default_vault.values() | default_vault.derived_values()).items():
        assert name.replace("_", " ") in page
        assert notebook.told(value, units[name]) in page
    tree = ET.fromstring(page.replace("<br>", "<br/>"))
    sections = tree.findall("svg")
    assert len(sections) == 2
    shown = {title.text for title in tree.findall("svg/path/title")}
    assert shown - {"wall"} <= set(default_vault.components)
    assert shown & set(default_vault.components)
    for section in sections:
        left, top, wide, tall = map(float, section.get("viewBox").split())
        assert float(section.get("width")) / float(section.get("height")) == pytest.approx(wide / tall, rel=0.01)
        for line in section.iter("path"):
            for point in re.split("[ML]", line.get("d"))[1:]:
                x, y = map(float, point.split())
                assert left <= x <= left + wide
                assert top <= y <= top + tall


def test_the_view_holds_every_component_on_its_surface(default_vault):
    figure = go.Figure(displayed(default_vault)[PLOTLY])  # refuses what plotly would not draw
    *surfaces, table = figure.data
    assert [trace.name for trace in surfaces] == [name.replace("_", " ") for name in default_vault.components]
    for k, trace in enumerate(surfaces, 1):
        points = np.column_stack([trace.x, trace.y, trace.z])
        assert np.abs(default_vault.distance(points)).max() < 2e-4
        corners = points[np.column_stack([trace.i, trace.j, trace.k])]
        # By area: on a plumb foot of a rib triangles are on it once they are rounded, and as much its other web's.
        areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        own = default_vault.evaluate(corners.mean(axis=1)).component == k
        assert areas[own].sum() > 0.99 * areas.sum()
    assert table.cells["values"][0][-1] == list(default_vault.derived_values())[-1].replace("_", " ")


def test_without_the_library_there_is_the_page_alone(monkeypatch):
    monkeypatch.setattr(notebook, "find_spec", lambda name: None)
    assert set(displayed(Groin())) == {"text/plain", HTML}


def test_a_vault_that_cannot_be_built_still_shows_its_page(monkeypatch):
    def fails(*_):
        raise ValueError("OpenCASCADE cannot do it")

    monkeypatch.setattr(notebook, "mesh", fails)
    notebook.triangles.cache_clear()
    vault = Groin(4.0, 4.3, Pointed())
    try:
        assert set(displayed(vault)) == {"text/plain", HTML}
    finally:
        notebook.triangles.cache_clear()


def test_the_same_vault_shows_the_same():
    for cls in FAMILIES:
        first = displayed(cls())
        notebook.triangles.cache_clear()
        assert displayed(cls()) == first
