"""The pages of the documentation: what is written from declarations is up to date, links lead somewhere, code runs."""

import re
import xml.etree.ElementTree as ET
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from families import FAMILIES, ideal
from families.drawing.section import outlines
from families.drawing.svg import NAMESPACE
from tools.handbook.pages import DRAWN, PAGE, PICTURES, README, pages, table
from tools.sections import replaced

DOCUMENTS = [README, *sorted(PAGE.parent.glob("*.md"))]
CODE = re.compile(r"```python\n(.*?)```", re.DOTALL)
LINK = re.compile(r"\]\(([^)#:\s]+)(?:#[^)]*)?\)")


def test_what_is_said_of_the_families_is_what_they_declare():
    for path, text in pages().items():
        assert path.read_text(encoding="utf-8") == text, f"{path.name} is old: make handbook"


@pytest.mark.parametrize("path", DRAWN, ids=lambda path: path.stem)
def test_a_picture_is_small_and_names_the_components(path):
    assert path.stat().st_size < 30_000
    tree = ET.parse(path)
    (cls,) = (cls for cls in FAMILIES if path.stem.startswith(f"{cls.id}-"))
    named = {title.text for path in tree.iter(f"{{{NAMESPACE}}}path") for title in path}
    assert named == set(cls().components)


def test_no_picture_is_left_of_a_family_that_is_gone():
    assert set(PICTURES.iterdir()) == set(DRAWN)


def drawn(vault):
    """Points (x, y, z) on lines as pictures have them."""
    rows = []
    for across, at in product((0, 1), np.linspace(-1.9, 1.9, 7)):
        line = outlines(vault, across, at)[0][0][2:-2]  # without the walls
        row = np.full((3, len(line)), at)
        row[[across, 2]] = line.T
        rows.append(row)
    return np.concatenate(rows, axis=1)


def test_pictures_follow_the_formulas_of_the_page():
    sail = ideal("sail", span_x=4, span_y=4, rise=1.5)
    radius = (8 + 1.5**2) / 3
    x, y, z = drawn(sail)
    assert np.allclose(z, np.sqrt(radius**2 - x**2 - y**2) + 1.5 - radius, atol=1e-6)
    groin = ideal("groin", span_x=4, span_y=4, crown_rise=0.4)
    x, y, z = drawn(groin)
    barrels = [np.sqrt(4 - u**2) + 0.4 * (1 - (v / 2) ** 2) for u, v in ((x, y), (y, x))]
    assert np.allclose(z, np.max(barrels, axis=0), atol=1e-6)
    cloister = ideal("trough", span_x=4, span_y=4, south_ratio=1, north_ratio=1)
    x, y, z = drawn(cloister)
    assert np.allclose(z, np.sqrt(4 - np.maximum(np.abs(x), np.abs(y)) ** 2), atol=1e-6)
    dome = ideal("dome", radius=2, drum_height=0.5, pendentive_ratio=0.3)
    ring = 2 * (np.sqrt(1 + 0.3**2) - 0.3)
    x, y, z = drawn(dome)
    within = x**2 + y**2 < 3.9
    assert within.sum() > 1000
    assert np.allclose(z[within], ring + 0.5 + np.sqrt(4 - (x**2 + y**2)[within]), atol=1e-6)


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
