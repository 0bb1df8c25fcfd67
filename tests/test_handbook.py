"""The pages of the documentation: what is written from declarations is up to date, links lead somewhere, code runs."""

import re
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest

from families import FAMILIES, ideal
from tools.handbook.drawing import surface
from tools.handbook.pages import PAGE, PICTURES, README, pages, table
from tools.sections import replaced

DOCUMENTS = [README, *sorted(PAGE.parent.glob("*.md"))]
CODE = re.compile(r"```python\n(.*?)```", re.DOTALL)
LINK = re.compile(r"\]\(([^)#:\s]+)(?:#[^)]*)?\)")


def test_what_is_said_of_the_families_is_what_they_declare():
    for path, text in pages().items():
        assert path.read_text(encoding="utf-8") == text, f"{path.name} is old: make handbook"


@pytest.mark.parametrize("cls", FAMILIES)
def test_a_picture_is_small_and_names_the_components_that_show_in_plan(cls):
    path = PICTURES / f"{cls.id}.svg"
    assert path.stat().st_size < 30_000
    titles = {element.text for element in ET.parse(path).iter("{http://www.w3.org/2000/svg}title")}
    assert titles - {cls.title} == set(cls().components) - {"drum"}  # which is upright


def test_no_picture_is_left_of_a_family_that_is_gone():
    assert {path.stem for path in PICTURES.iterdir()} == {cls.id for cls in FAMILIES}


def test_pictures_follow_the_formulas_of_the_page():
    x, y = xy = np.random.default_rng(1).uniform(-2, 2, (2, 500))
    sail = ideal("sail", span_x=4, span_y=4, rise=1.5)
    radius = (8 + 1.5**2) / 3
    assert np.allclose(surface(sail, xy.T)[0], np.sqrt(radius**2 - x**2 - y**2) + 1.5 - radius, atol=1e-6)
    groin = ideal("groin", span_x=4, span_y=4, crown_rise=0.4)
    barrels = [np.sqrt(4 - u**2) + 0.4 * (1 - (v / 2) ** 2) for u, v in ((x, y), (y, x))]
    assert np.allclose(surface(groin, xy.T)[0], np.max(barrels, axis=0), atol=1e-6)
    cloister = ideal("trough", span_x=4, span_y=4, south_ratio=1, north_ratio=1)
    assert np.allclose(surface(cloister, xy.T)[0], np.sqrt(4 - np.max(np.abs(xy), axis=0) ** 2), atol=1e-6)
    dome = ideal("dome", radius=2, drum_height=0.5, pendentive_ratio=0.3)
    ring = 2 * (np.sqrt(1 + 0.3**2) - 0.3)
    within = x**2 + y**2 < 3.9
    top = ring + 0.5 + np.sqrt(4 - x[within] ** 2 - y[within] ** 2)
    assert np.allclose(surface(dome, xy.T[within])[0], top, atol=1e-6)


def test_places_outside_the_plan_have_no_height():
    height, component = surface(ideal("barrel", span=4, length=6), np.array([[0.0, 2.9], [0.0, 3.1], [2.1, 0.0]]))
    assert np.isnan(height).tolist() == [False, True, True]
    assert component.tolist() == [1, 0, 0]


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.name)
def test_links_lead_to_files(path: Path):
    for link in LINK.findall(path.read_text(encoding="utf-8")):
        assert (path.parent / link).exists(), link


@pytest.mark.parametrize(
    "code",
    [code for path in DOCUMENTS for code in CODE.findall(path.read_text(encoding="utf-8")) if "room.laz" not in code],
)
def test_code_of_the_pages_runs(code):
    exec(code, {})


def test_a_section_that_is_new_comes_before_the_one_that_is_last():
    page = replaced("# Page\n\n## Last\n\nend\n", "family", "conch", "round", before="## Last")
    assert page == "# Page\n\n## Conch\n\n<!-- family conch -->\n\nround\n\n<!-- end conch -->\n\n## Last\n\nend\n"
    assert replaced(page, "family", "conch", "round", before="## Last") == page


def test_cells_do_not_break_a_table():
    assert table(("a", "b"), [("|x|", "two\nlines")]) == "| a | b |\n|---|---|\n| \\|x\\| | two lines |"
    assert not table(("a", "b"), [])
