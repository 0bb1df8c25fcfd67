"""The 3D view of report.html: what is packed into it, and what a real browser makes of that."""

import dataclasses
import json
import re
import shutil
import struct
from base64 import b64decode
from io import BytesIO
from zlib import decompress

import numpy as np
import pytest
from PIL import Image

from families import family
from tools.browser import Browser
from vaultcad.export.geometry import shell
from vaultcad.export.report_html import write_report_html
from vaultcad.export.viewer import embed, library
from vaultcad.export.viewer.library import three_js
from vaultcad.export.viewer.scene import AROUND, ON_VAULTS, scene

TYPES = {"xyz": "<u2", "moved": "<i2", "index": "<u4", "deviation": "<i2", "component": "<u2"}
ROWS = {"xyz": 3, "moved": 3}
HALF = 0.51  # of a step


def evidence(model, rng, count=3000):
    """Points over each vault, up to 9 mm off it, their components and deviations, and others off all vaults."""
    found = []
    for number, fitted in enumerate(model.vaults, 1):
        low, high = fitted.vault.plan.box
        points = np.column_stack([rng.uniform(low, high, (count, 2)), rng.uniform(0.2, fitted.vault.top, count)])
        off = rng.uniform(-0.009, 0.009, count)
        for _ in range(30):
            surface = fitted.vault.evaluate(points)
            points += (off - surface.distance)[:, None] * surface.normal
        surface = fitted.vault.evaluate(points)
        place = fitted.pose.placement()
        found.append((points @ place[:3, :3].T + place[:3, 3], surface.component, surface.distance, number))
    walls = rng.uniform([0, 0, 0], [9, 5, 2], (500, 3))
    points = np.concatenate([*(one[0] for one in found), walls])
    component = np.concatenate([*(one[1] for one in found), np.zeros(500, int)])
    deviation = np.concatenate([*(one[2] for one in found), np.full(500, np.nan)])
    vault = np.concatenate([*(np.full(count, one[3]) for one in found), np.zeros(500, int)])
    return points, component, deviation, vault


def titles(model):
    return [fitted.vault.title for fitted in model.vaults]


def read(packed):
    """As scene.js does: the head, with the arrays in place of where they lie."""
    (length,) = struct.unpack_from("<I", packed)
    head, start = json.loads(packed[4 : 4 + length]), 4 + length
    for item in (*head["parts"], *head["clouds"]):
        for name in TYPES.keys() & item.keys():
            at, size = item[name]
            rows = np.frombuffer(packed, TYPES[name], size, start + at).reshape(-1, ROWS.get(name, 1))
            item[name] = np.cumsum(rows, axis=0, dtype=rows.dtype)
        item["points"] = item["low"] + item["xyz"] * np.array(item["step"])
    return head


def in_view(model, points):
    """Points of the scan's local frame in that of the view."""
    frame = model.vaults[0].pose.frame()
    return (points - [model.vaults[0].pose.x, model.vaults[0].pose.y, 0]) @ frame[:, :3].T


def test_every_triangle_of_every_family_is_there_where_it_stands(every_family):
    head = read(scene(every_family, titles(every_family), *evidence(every_family, np.random.default_rng(1), 10)))
    for number, fitted in enumerate(every_family.vaults):
        mesh, parts = shell(fitted.vault, 0.15), [part for part in head["parts"] if part["owner"] == number]
        assert sum(len(part["index"]) for part in parts) == mesh.triangles.size
        shown = {part["name"] for part in parts}
        assert shown == {name.replace("_", " ") for name in fitted.vault.components} | {"masonry"}
        place = fitted.pose.placement()
        for part in parts:
            of = (
                mesh.component == part["id"]
                if part["id"]
                else (mesh.component == 0) | (mesh.component > len(parts) - 1)
            )
            corners = mesh.vertices[mesh.triangles[of].ravel()] @ place[:3, :3].T + place[:3, 3]
            off = np.abs(part["points"][part["index"].ravel()] - in_view(every_family, corners))
            assert (off <= HALF * np.array(part["step"])).all()


def test_points_are_thinned_evenly_and_keep_place_and_deviation(building):
    points, component, deviation, vault = evidence(building, np.random.default_rng(2), 20_000)
    head = read(scene(building, titles(building), points, component, deviation, vault))
    on = [cloud for cloud in head["clouds"] if "deviation" in cloud]
    (around,) = [cloud for cloud in head["clouds"] if "deviation" not in cloud]
    assert sum(len(cloud["xyz"]) for cloud in on) == ON_VAULTS
    assert len(around["xyz"]) == min(500, AROUND)
    assert [cloud["owner"] for cloud in on] == [0, 1, 2]
    from scipy.spatial import cKDTree

    for cloud in on:
        mine = vault == cloud["owner"] + 1
        away, at = cKDTree(in_view(building, points[mine])).query(cloud["points"])
        assert away.max() < 2e-4
        off = cloud["deviation"].ravel() * head["fine"] - deviation[mine][at]
        assert np.quantile(np.abs(off), 0.98) <= HALF * head["fine"]  # a few have two neighbours within a step
        assert len(np.unique(at)) > 0.98 * len(at)
        gaps = cKDTree(cloud["points"]).query(in_view(building, points[mine]))[0]
        assert gaps.max() < 6 * head["spacing"]


def test_a_scan_without_points_and_points_without_labels_are_shown_as_far_as_they_go(make_model):
    model = make_model("sail")
    none = embed.viewer_section(model, ["sail"], None, None, None, None)
    bare = embed.viewer_section(model, ["sail"], np.eye(3), None, None, None)
    shown = [
        read(decompress(b64decode(re.search('data-packed="scene">([^<]*)', text)[1])))["clouds"]
        for text in (none, bare)
    ]
    assert shown[0] == []
    assert [(len(cloud["xyz"]), "deviation" in cloud) for cloud in shown[1]] == [(3, False)]


def test_the_same_scan_gives_the_same_bytes(building):
    packed = [
        embed.viewer_section(building, titles(building), *evidence(building, np.random.default_rng(3))) for _ in "ab"
    ]
    assert packed[0] == packed[1]
    assert len(packed[0]) < 2.5e6


def test_the_library_comes_with_its_licence_or_the_page_says_why_there_is_no_view(make_model, monkeypatch):
    assert re.match(
        r"/\*\*\s+\* @license\s+\* Copyright .* Three\.js Authors\s+\* SPDX-License-Identifier: MIT", three_js()
    )
    monkeypatch.setattr(library, "THREE", re.compile("not in it"))
    text = embed.viewer_section(make_model("barrel"), ["barrel"], None, None, None, None)
    assert "brings no three.js along; install trimesh 5.2" in text
    assert "<script" not in text


def settled(model):
    """The model with as-built surfaces, 7 mm off in one direction."""
    moved = [dataclasses.replace(fitted) for fitted in (*model.vaults, *model.arches)]
    for fitted in moved:
        object.__setattr__(fitted, "surface", lambda points: np.full(points.shape, 0.004))
    count = len(model.vaults)
    return dataclasses.replace(model, vaults=tuple(moved[:count]), arches=tuple(moved[count:]))


def test_displacements_are_kept_in_the_frame_of_the_view(building):
    turn = building.vaults[0].pose.frame()[:, :3]
    head = read(scene(settled(building), titles(building), *evidence(building, np.random.default_rng(7), 10)))
    owners = [*building.vaults, *building.arches]
    for part in head["parts"]:
        moved = part["moved"] * head["fine"]
        expected = turn @ owners[part["owner"]].pose.placement()[:3, :3] @ np.full(3, 0.004)
        assert moved == pytest.approx(np.tile(expected, (len(moved), 1)), abs=HALF * head["fine"])
    assert {part["owner"] for part in head["parts"]} == set(range(len(owners)))
    assert not any(
        "moved" in part
        for part in read(scene(building, titles(building), *[np.zeros((0, 3))] + [np.zeros(0)] * 3))["parts"]
    )


@pytest.fixture
def browser(tmp_path):
    program = shutil.which("chromium")
    if program is None:
        pytest.skip("chromium is not installed: apt-get install --no-install-recommends chromium")

    def start(size, *, phone=False):
        return Browser(program, tmp_path / "profile", size, phone=phone)

    return start


def opened(browser, model, path, *evidence):
    """The page, with its view opened."""
    write_report_html(model, path, *evidence)
    browser.open(path)
    assert browser.run("document.querySelector('.view-stage').hidden && !window.THREE")
    browser.click(".view-open")
    browser.run("""new Promise(done => { const look = () => document.activeElement.matches('canvas')
        || !document.querySelector('.view-failed').hidden ? done() : setTimeout(look, 10); look() })""")
    assert browser.run("document.querySelector('.view-failed').textContent") == ""


def shown(browser):
    """The picture (h, w, 3)."""
    return np.asarray(Image.open(BytesIO(browser.picture("canvas"))).convert("RGB"))


def text_of(browser, selector):
    return browser.run(f"document.querySelector('{selector}').textContent")


def place_of(browser):
    """Of the section, along its axis [m]."""
    return float(re.search("= (.*) m", text_of(browser, "[name=place]"))[1].replace("−", "-"))


@pytest.mark.browser
def test_in_a_browser_every_switch_changes_the_picture_and_nothing_is_loaded_or_complained_of(
    building, browser, tmp_path
):
    building = settled(building)
    with browser((600, 700)) as tab:
        opened(tab, building, tmp_path / "report.html", *evidence(building, np.random.default_rng(4)))
        pictures = [shown(tab)]

        def changes(what, doing):
            doing()
            pictures.append(shown(tab))
            assert (pictures[-1] != pictures[-2]).any(axis=2).mean() > 0.003, what

        for selector in (
            "[name=show][value=points]",
            "[name=show][value=as-built]",
            "[name=enlarge][value='30']",
            "[name=masonry]",
            "[name=around]",
            "[name=axis][value=y]",
            "[name=flip]",
            "[value=below]",
            "[value=top]",
            "[type=reset]",
        ):
            changes(selector, lambda selector=selector: tab.click(selector))
        assert (pictures[-1] == pictures[0]).all()
        tab.click("[name=axis][value=x]")
        place = place_of(tab)
        tab.run("document.querySelector('[name=at]').focus()")
        pictures.append(shown(tab))
        changes("the section, by keys", lambda: [tab.press("ArrowRight") for _ in range(40)])
        assert place_of(tab) > place + 1
        tab.run("document.querySelector('canvas').focus()")
        changes("turning, by keys", lambda: tab.press("ArrowLeft"))
        x, y = tab.middle_of("canvas")
        changes(
            "turning",
            lambda: [
                tab.mouse("mousePressed", x, y),
                tab.mouse("mouseMoved", x + 60, y),
                tab.mouse("mouseReleased", x, y),
            ],
        )
        assert tab.console == []
        assert tab.requests == [(tmp_path / "report.html").as_uri()]


@pytest.mark.browser
def test_in_a_browser_distances_are_those_of_the_vault_and_places_are_named(make_model, browser, tmp_path):
    span = 4.6
    model = make_model("barrel")
    flat = dataclasses.replace(model.vaults[0], vault=family("barrel")(span=span, length=3.0))
    model = dataclasses.replace(model, vaults=(flat,))
    with browser((600, 700)) as tab:
        opened(tab, model, tmp_path / "report.html", *evidence(model, np.random.default_rng(5)))
        tab.click("[value=below]")  # whence both springings are seen
        tab.click("[name=measure]")
        assert text_of(tab, ".view-said") == "take two places"
        picture = shown(tab)
        x, y = tab.middle_of("canvas")
        middle = picture[len(picture) // 2].astype(int)
        stone = np.flatnonzero(np.abs(middle - middle[4]).sum(axis=1) > 40)
        left, right = stone[stone > 4].min(), stone[stone < len(middle) - 4].max()
        for column in (left + 1, right - 1):
            tab.click_at(x - len(middle) / 2 + column + 0.5, y)
        told = text_of(tab, ".view-said")
        length, level, plumb = map(float, re.match(r"([\d.]+) m \(level ([\d.]+), plumb ([\d.]+)\)", told).groups())
        assert level == pytest.approx(span, abs=4 * span / (right - left))
        assert length == pytest.approx(np.hypot(level, plumb), abs=0.002)
        assert flat.vault.title in told.lower()
        tab.press("Escape")
        tab.press("Enter")
        assert text_of(tab, ".view-said").startswith("take the second place")
        tab.hover(x + 20, y)
        tab.picture()
        tip = text_of(tab, ".view-tip")
        assert re.search(r"here .[\d.]+ mm into the (stone|room), the mean of \d+ points", tip), tip
        assert tab.console == []


@pytest.mark.browser
def test_on_a_phone_fingers_turn_and_pinch_and_all_is_within_reach(building, browser, tmp_path):
    with browser((360, 740), phone=True) as tab:
        tab.prefer("dark")
        opened(tab, building, tmp_path / "report.html", *evidence(building, np.random.default_rng(6), 500))
        sizes = tab.run("""[...document.querySelectorAll('#view3d button, #view3d label')].map(
            e => e.getBoundingClientRect()).filter(b => b.width).map(b => [b.width, b.height])""")
        assert np.min(sizes) >= 44
        x, y = tab.middle_of("canvas")
        first = shown(tab)
        assert first[5, 5].max() < 60
        for a, b in (((x, y), (x + 80, y)), ((x - 20, y, x + 20, y), (x - 90, y, x + 90, y))):
            before = shown(tab)
            for kind, places in (("touchStart", a), ("touchMove", b), ("touchEnd", ())):
                tab.touch(kind, list(zip(places[::2], places[1::2], strict=True)))
            assert (shown(tab) != before).any(axis=2).mean() > 0.01
        for show in ("ideal", "points"):
            tab.click(f"[name=show][value={show}]")
            assert tab.run("document.documentElement.scrollWidth") == 360
        assert tab.console == []
