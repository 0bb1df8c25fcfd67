import dataclasses
import re
import shutil
import subprocess
from html import escape
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from families import FAMILIES
from vaultcad.export.report_html import write_report_html
from vaultcad.uncertain import Estimate

IDS = [cls.id for cls in FAMILIES]
VOID = {"meta", "link", "br", "img", "hr", "input"}


class Strict(HTMLParser):
    """Collects tags, attributes and text; every element must be closed in its order."""

    def __init__(self):
        super().__init__()
        self.open, self.seen, self.words = [], [], []

    def handle_starttag(self, tag, attrs):
        self.seen.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.seen.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.words.append(data)


@pytest.fixture
def page(tmp_path):
    def write(model, *evidence):
        write_report_html(model, tmp_path / "report.html", *evidence)
        text = (tmp_path / "report.html").read_text(encoding="utf-8")
        parser = Strict()
        parser.feed(text)
        parser.close()
        assert parser.open == []
        return text, parser

    return write


def drawings(text):
    return [ElementTree.fromstring(svg) for svg in re.findall(r'<svg class="drawing".*?</svg>', text)]


def evidence(fitted, rng):
    """Points 5 mm above the intrados over the whole plan, their components and signed distances."""
    half = np.array([fitted.vault.plan.half_x, fitted.vault.plan.half_y])
    x, y = half[:, None] * rng.uniform(-1, 1, (2, 4000))
    points = np.column_stack([x, y, rng.uniform(0, 8, 4000)])
    for _ in range(40):
        surface = fitted.vault.evaluate(points)
        points += (0.005 - surface.distance)[:, None] * surface.normal
    place = fitted.pose.placement()
    return points @ place[:3, :3].T + place[:3, 3], surface.component, surface.distance


@pytest.mark.parametrize("name", IDS)
def test_the_page_is_whole_and_tells_every_figure(name, make_model, page):
    model = make_model(name)
    (fitted,) = model.vaults
    text, parser = page(model)
    words = " ".join(parser.words)
    for component in fitted.components:
        assert component.name.replace("_", " ") in words
    for parameter, estimate in fitted.parameters.items():
        assert parameter.replace("_", " ") in words
        assert estimate.meaning in words
    for shown in ("LOA20", "97.0 %", "2.4 cm", "report.json", "segments.laz"):
        assert shown in words
    plan, *sections = drawings(text)
    assert len(sections) == 2
    areas = [path for path in plan.iter() if path.get("class") == "stone"]
    assert [area.find("title").text for area in areas] == list(fitted.vault.components)
    assert all(any(path.get("class") == "stone" for path in section.iter()) for section in sections)


def test_nothing_comes_from_outside(make_model, page):
    text, parser = page(make_model("groin"))
    assert not {tag for tag, _ in parser.seen} & {"link", "img", "iframe", "object"}
    assert not any("src" in attrs for tag, attrs in parser.seen if tag == "script")
    links = [attrs[key] for _, attrs in parser.seen for key in ("src", "href") if key in attrs]
    assert links
    assert not any(":" in link or link.startswith("/") for link in links)
    assert "@import" not in text
    assert "url(" not in text


def test_names_are_escaped(make_model, page):
    model = make_model("barrel", scan=Path("<script>alert(1)<b> & co.laz"), settings={"a<b": ['"&"']})
    text, parser = page(model)
    assert "<script>alert" not in text
    assert any("<script>alert(1)<b> & co.laz" in words for words in parser.words)
    assert "a<b" in parser.words


def test_points_near_the_sections_and_a_histogram_are_drawn(make_model, page):
    model = make_model("trough")
    points, component, deviation = evidence(model.vaults[0], np.random.default_rng(2))
    text, _ = page(model, points, component, deviation)
    dots = [path for svg in drawings(text) for path in svg.iter() if path.get("class") == "scan"]
    assert len(dots) == 2
    assert all(dot.get("d").count("M") > 5 for dot in dots)
    chart = re.search(r'<svg class="chart".*?</svg>', text)[0]
    counted = sum(int(n) for n in re.findall(r"mm: (\d+)</title>", chart))
    assert counted == np.isfinite(deviation).sum()


def test_points_of_no_component_are_not_counted(make_model, page):
    deviation = np.array([0.001, 0.002, np.nan, 0.003])
    text, _ = page(make_model("barrel"), np.zeros((4, 3)), np.array([1, 0, 0, 1]), deviation)
    assert sum(int(n) for n in re.findall(r"mm: (\d+)</title>", text)) == 2


def test_a_fit_that_did_not_come_to_rest_says_so(make_model, page):
    model = make_model("sail")
    restless = dataclasses.replace(model.vaults[0], converged=False)
    assert "take the figures with care" in page(dataclasses.replace(model, vaults=(restless,)))[0]
    assert "take the figures with care" not in page(model)[0]


def test_times_do_not_show_so_that_the_page_is_reproducible(make_model, page):
    one, other = (page(make_model("mirror", seconds={"fit": t}))[0] for t in (1.0, 2.0))
    assert one == other


def test_numbers_that_hang_on_unseen_stone_are_marked_and_the_marks_explained(make_model, page):
    model = make_model("groin")
    blind = Estimate(2.5, "m", 0.3, "crown above the springing", seen=0.2, flags=("unseen", "weak"))
    fitted = dataclasses.replace(model.vaults[0], parameters={"rise": blind})
    text, _ = page(dataclasses.replace(model, vaults=(fitted,)))
    assert "300.0 mm ?~" in text
    assert "crown above the springing; hangs on stone that the scan did not see; is known only roughly" in text
    assert "<b>?</b> hangs on stone that the scan did not see" in text
    assert "<b>?</b>" not in page(model)[0]


def test_each_table_has_its_own_box_and_each_cell_its_title(every_family, page):
    text, parser = page(every_family)
    assert text.count('<div class="wide"><table>') == text.count("<table>") > len(FAMILIES)
    assert ".wide { overflow-x: auto; }" in text
    assert all(attrs["data-title"] for tag, attrs in parser.seen if tag == "td")


@pytest.mark.browser
def test_the_page_is_no_wider_than_a_phone(every_family, page, tmp_path):
    chromium = shutil.which("chromium")
    if chromium is None:
        pytest.skip("chromium is not installed: apt-get install --no-install-recommends chromium")
    long = "a_scan_whose_name_has_no_place_where_it_could_be_broken_into_lines.laz"
    text = escape(page(dataclasses.replace(every_family, scan=Path(long)))[0])
    widths = (320, 360, 375, 390)
    frames = "".join(f'<iframe width="{width}" height="700" srcdoc="{text}"></iframe>' for width in widths)
    # What is hidden in the boxes of tables counts as well: on a phone nothing is to be scrolled sideways.
    look = """onload = () => { document.title = [...document.querySelectorAll("iframe")].map(frame => {
        const page = frame.contentDocument, boxes = [page.documentElement, ...page.querySelectorAll(".wide")];
        return boxes.filter(box => box.scrollWidth > box.clientWidth).length
    }).join(" ") }"""
    (tmp_path / "phones.html").write_text(f"<!doctype html><body>{frames}<script>{look}</script>", encoding="utf-8")
    flags = ["--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={tmp_path / 'profile'}", "--dump-dom"]
    done = subprocess.run(
        [chromium, *flags, (tmp_path / "phones.html").as_uri()], capture_output=True, text=True, timeout=120, check=True
    )
    assert re.search("<title>(.*?)</title>", done.stdout)[1] == " ".join("0" for _ in widths)


@pytest.mark.parametrize("name", IDS)
def test_the_terms_of_its_family_are_explained_and_no_others(make_model, page, name):
    text, _ = page(make_model(name))
    explained = set(re.findall(r"<dt>([a-z]+)</dt>", text))
    terms = {cls.id: {term for term, _ in cls.glossary} for cls in FAMILIES}
    assert explained & set().union(*terms.values()) == terms[name]
