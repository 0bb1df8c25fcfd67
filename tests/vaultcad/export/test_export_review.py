"""review.png: one picture from which a person sees whether a fit is right."""

import dataclasses
import struct
from functools import cache

import numpy as np
import pytest

from families import family
from families.drawing.deviation_colours import UNKNOWN, shades
from vaultcad.export.bundle import REVIEW, write_all
from vaultcad.export.drawing import ENLARGED
from vaultcad.export.review import draw_review, write_review
from vaultcad.pose import Pose


@cache
def scanned(name, seed=5):
    """Points on a family's vault 8 mm off it, with a hole, then a floor; component and deviation of each."""
    vault = family(name)()
    sample = vault.sample(20_000, np.random.default_rng(seed))
    into = vault.evaluate(sample.xyz).normal
    hole = np.hypot(*(sample.xyz[:, :2] - [1.0, 0.6]).T) < 0.6
    floor = np.random.default_rng(seed).uniform([-3, -3, -1], [3, 3, -1], (500, 3))
    local = np.concatenate([(sample.xyz + 0.008 * into)[~hole], floor])
    component = np.concatenate([sample.component[~hole], np.zeros(500, int)])
    return local, component, np.where(component > 0, 0.008, np.nan)


def seen(model):
    """What the review of a model takes: points in the scan's frame, component, deviation, vault."""
    columns = []
    for k, fitted in enumerate(model.vaults, 1):
        local, component, deviation = scanned(fitted.vault.id)
        out = fitted.pose.placement()
        columns.append((local @ out[:3, :3].T + out[:3, 3], component, deviation, np.where(component > 0, k, 0)))
    return [np.concatenate(column) for column in zip(*columns, strict=True)]


def texts(figure):
    return " ".join(text.get_text() for text in [*figure.texts, *(t for a in figure.axes for t in [*a.texts, a.title])])


def test_every_family_is_drawn_with_its_sizes_and_how_sure_they_are(every_family):
    for fitted in every_family.vaults:
        model = dataclasses.replace(every_family, vaults=(fitted,))
        said = texts(draw_review(model, *seen(model)))
        assert fitted.vault.title.capitalize() in said
        assert "confidence 97%" in said
        for name, estimate in fitted.parameters.items():
            if estimate.unit == "m":
                assert name.replace("_", " ") in said
                assert f"{estimate.value:.3f} m" in said
        assert all(component.name.replace("_", " ") in said for component in fitted.components)
        assert "± 2.0 mm" in said


def test_several_vaults_stand_in_one_plan_and_each_has_its_drawings(make_model):
    first = make_model("barrel").vaults[0]
    second = dataclasses.replace(make_model("sail").vaults[0], pose=Pose(14.0, 3.0, 2.5, 0.3))
    model = make_model("barrel", vaults=(first, second))
    figure = draw_review(model, *seen(model))
    said = texts(figure)
    assert "2 vaults" in said
    assert "1  Barrel vault" in said
    assert "2  Sail vault" in said
    assert len(figure.axes) == 2 + 2 * 4  # the plans of all; plan, map and two sections of each


def test_the_map_is_open_where_the_scan_saw_nothing_and_grey_behind(make_model):
    model = make_model("sail")
    figure = draw_review(model, *seen(model))
    (axes,) = (axes for axes in figure.axes if axes.get_title().startswith("Deviation"))
    picture, scale = axes.images
    pixels = np.asarray(picture.get_array())
    rows, columns = np.indices(pixels.shape[:2])
    half_x, _, _, half_y = (abs(v) for v in picture.get_extent())
    x, y = (
        (k + 0.5) / n * 2 * half - half
        for k, n, half in zip((columns, rows), pixels.shape[1::-1], (half_x, half_y), strict=True)
    )
    off, open_ = np.hypot(x - 1.0, y - 0.6), pixels[..., 3] == 0
    assert open_[off < 0.4].all()
    assert open_[off > 0.8].mean() < 0.1
    assert (pixels[~open_][:, :3] == shades(np.array(0.008), 0.01)).all()
    assert any(patch.get_facecolor()[:3] == pytest.approx(UNKNOWN.unit) for patch in axes.patches)
    ends = np.asarray(scale.get_array())[0, [0, -1], :3]
    assert (ends == shades(np.array([-0.00975, 0.00975]), 0.01)).all()
    said = " ".join(text.get_text() for text in axes.texts)
    assert all(word in said for word in ("−10 mm", "room", "+10 mm", "stone"))


@pytest.mark.parametrize("name", ["barrel", "groin", "dome"])
def test_sections_show_points_where_they_are_and_their_deviations_larger(make_model, name):
    model = make_model(name)
    vault = model.vaults[0].vault
    figure = draw_review(model, *seen(model))
    sections = [axes for axes in figure.axes if axes.get_title().startswith("Section")]
    assert len(sections) == 2
    for axes, across in zip(sections, (0, 1), strict=True):
        behind, at_crown, grown = (np.asarray(c.get_offsets()) for c in axes.collections)
        assert len(behind) > 10
        for points, distance in ((at_crown, 0.008), (grown, 0.008 * ENLARGED)):
            xyz = np.zeros((len(points), 3))
            xyz[:, [across, 2]] = points
            # A slice is not a plane: what is drawn lies up to its width beside the cut.
            assert len(points) > 10
            assert np.median(vault.distance(xyz)) == pytest.approx(distance, abs=0.002)


def test_a_fit_that_did_not_settle_says_so(make_model):
    fitted = dataclasses.replace(make_model("sail").vaults[0], converged=False)
    model = make_model("sail", vaults=(fitted,))
    assert "not come to rest" in texts(draw_review(model, *seen(model)))


def test_a_vault_without_points_is_drawn_all_the_same(make_model):
    draw_review(make_model("sail"), np.zeros((0, 3)), np.zeros(0, int), np.zeros(0))


def chunks(png):
    at, found = 8, []
    while at < len(png):
        (size,) = struct.unpack(">I", png[at : at + 4])
        found.append(png[at + 4 : at + 8])
        at += 12 + size
    return found


def test_the_same_bytes_again_without_date_or_version(make_model, tmp_path, monkeypatch):
    model = make_model("trough")
    write_review(model, tmp_path / "one.png", *seen(model))
    import matplotlib as mpl

    monkeypatch.setitem(mpl.rcParams, "font.size", 20)  # what a user sets elsewhere does not matter
    write_review(model, tmp_path / "two.png", *seen(model))
    png = (tmp_path / "one.png").read_bytes()
    assert png == (tmp_path / "two.png").read_bytes()
    assert set(chunks(png)) == {b"IHDR", b"pHYs", b"IDAT", b"IEND"}


def test_a_review_is_part_of_the_result_and_goes_with_it(make_model, tmp_path):
    model, out = make_model("barrel"), tmp_path / "out"
    points, component, deviation, _ = seen(model)

    def write(**more):
        write_all(model, out, segments=lambda path: path.write_bytes(b"LASF"), **more)

    with pytest.raises(ValueError, match="give points"):
        write(review=True)
    assert not out.exists()
    write(points=points, component=component, deviation=deviation, review=True)
    assert (out / REVIEW).read_bytes().startswith(b"\x89PNG")
    write()
    assert not (out / REVIEW).exists()
