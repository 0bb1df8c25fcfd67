"""The add-on in the real FreeCAD, without a window."""

import sys
from dataclasses import replace
from pathlib import Path

import ifcopenshell
import numpy as np
import pytest
from build123d import import_step

from families import FAMILIES, Groin
from families.drawing.deviation_colours import shade
from segmentation.io import write_cloud
from vaultcad.drawings.bundle import sheets
from vaultcad.drawings.cad import write_dxf
from vaultcad.model_file import plain_vault
from vaultcad.workbench.install import INTERPRETER, by_rule, install
from vaultcad.workbench.scans import bay

ROOT = Path(__file__).parents[3]

pytestmark = pytest.mark.freecad


def flat(pose: dict) -> list[float]:
    return [pose["x"], pose["y"], pose["z"], pose["yaw"], *pose["lean"]]


def sound(state: dict) -> bool:
    return (
        state["states"] == ["Up-to-date"]
        and state["valid"]
        and state["faces"] == len(state["names"]) == state["colours"] > 0
    )


def test_every_family_is_edited_to_the_ends_of_its_ranges_undone_saved_and_opened(in_freecad) -> None:
    found = in_freecad("every_family")
    assert list(found["families"]) == [cls.id for cls in FAMILIES]
    for cls in FAMILIES:
        of = found["families"][cls.id]
        assert sound(of["start"]), cls.id
        assert set(of["start"]["names"]) <= set(cls().components)
        for name, edit in of["edits"].items():
            assert sound(edit["after"]), (cls.id, name, edit["after"])
            assert edit["undone"] == of["start"]["box"], (cls.id, name)
        boxes = {str(edit["after"]["box"]) for edit in of["edits"].values()}
        assert len(boxes) > 2, "edits change the shape"
        assert all(" to " in text for text in of["tooltips"])
        assert set(of["types"].values()) <= {f"App::Property{kind}" for kind in ("Length", "Angle", "Float", "Integer")}
        assert sound(of["solid"])
        assert {"extrados", "side"} <= set(of["solid"]["names"])
        assert of["solid"]["volume"] > 0
    assert found["before"] == found["after"], "documents open as they were saved"
    assert found["pid"] is None, "without a worker"
    assert found["kept"] > len(FAMILIES)
    assert found["left"] == len(FAMILIES) - found["kept"] // 2, (
        "all is undone that FreeCAD remembers, two steps a vault"
    )
    assert all("Built" in names and "Report" in names for names in found["hidden"].values())
    assert "RiseRatioX" in found["hidden"][Groin.__name__]
    assert sound(found["edited"])
    assert found["edited"]["box"][1] - found["edited"]["box"][0] == pytest.approx(6500 + 400)
    assert "Traceback" not in found["said"]


def test_what_cannot_be_is_refused_and_a_dead_worker_is_survived(in_freecad) -> None:
    found = in_freecad("refused")
    start, said = found["start"], found["said"]
    assert sound(start)
    refused = found["refused"]
    assert sound(refused)
    assert refused["box"] == start["box"]
    assert (refused["span"], refused["profile"]) == (5000, "semicircular")
    assert "VaultCad: Groin vault: span_x = 400 lies outside [0.5, 40] m; the last good value is back" in said
    assert found["thickness"] == 0

    assert found["no_choice"] == {**start, "rise": 2500}
    assert "rise_x 2: its profile makes it 2.5 m; choose one that has a rise ratio; the last good value is back" in said
    assert found["rise"] == pytest.approx({"ratio": 0.4, "rise": 2000, "top": 2500})
    assert found["fallen"] == start

    driven = found["expression"]
    assert "Invalid" in driven["states"]
    assert "span_x = 100 lies outside" in driven["why"]
    assert driven["box"] == start["box"], "the last good shape stays"
    assert found["mended"] == start

    killed = found["killed"]
    assert "Invalid" in killed["states"]
    assert killed["box"] == start["box"]
    assert killed["why"] == "the worker was killed by signal 9; the next edit starts a new one"
    assert f"VaultCad: Groin vault: {killed['why']}" in said
    assert found["another"]
    assert sound(found["next"])
    assert found["next"]["box"][1] == 3500

    assert found["refused_first"]["null"]
    assert "Invalid" in found["refused_first"]["states"]
    assert "span = 1000 lies outside" in found["refused_first"]["why"]


def test_a_scan_is_fitted_and_exported(in_freecad, tmp_path) -> None:
    shown = [-25.0, -20.0, -4.0, 0.0, 10.0, 13.0, 20.0, 99.0]
    found = in_freecad("fitted", scan=str(ROOT / "examples" / "room.laz"), deviations=shown)
    assert 50_000 < found["shown"] <= 100_000
    assert found["total"] == 350_456
    assert found["start"]["objects"] == ["Scan"]
    assert found["start"]["colours"] > 50
    assert found["killed"] == "the worker was killed by signal 9; the next edit starts a new one"
    assert found["after"] == found["start"], "a fit that did not end leaves the document alone"

    fit = found["fit"]
    assert fit["objects"] == ["Scan", "Groin"]
    assert fit["on"] > 10_000
    assert fit["colours"] > 100
    assert {"finding", "measuring"} & set(fit["stages"])
    assert sound(fit["state"])
    report = fit["report"]
    assert report["family"] == "groin"
    assert fit["values"] == pytest.approx(report["parameters"], abs=1e-9)
    assert fit["values"]["span_x"] == pytest.approx(4.6, abs=0.02)
    assert fit["values"]["span_y"] == pytest.approx(5.4, abs=0.02)
    assert fit["base"] == pytest.approx([1000 * report["pose"][axis] for axis in "xyz"])
    assert flat(fit["pose"]) == pytest.approx(flat(report["pose"]))
    assert all(flag.startswith("profile ") and " or " in flag for flag in report["flags"]), "arches that are not sure"

    assert import_step(tmp_path / "fitted.step").volume > 0
    assert (tmp_path / "fitted.glb").read_bytes().startswith(b"glTF")
    fitted, edited = (ifcopenshell.open(tmp_path / f"{name}.ifc") for name in ("fitted", "edited"))
    sets = [{entity.Name for entity in ifc.by_type("IfcPropertySet")} for ifc in (fitted, edited)]
    assert "VaultCAD_Deviation" in sets[0]
    assert found["edited"]
    assert "VaultCAD_Deviation" not in sets[1], "an edited vault is not what was measured"
    assert found["suffix"].startswith("fitted.dwg: unknown suffix")

    switched = found["switched"]
    assert switched["family"] == "barrel vault with lunettes"
    assert switched["objects"] == ["Scan", "Lunette"]
    assert [name for name, _ in switched["alternatives"]]
    assert found["undone"]["objects"] == ["Scan", "Groin"]
    assert found["undone"]["on"] == fit["on"]
    assert found["empty"] == "the box holds no point of the scan; move it over the vault"
    assert found["opened"]
    for deviation, colour in zip(shown, found["scale"], strict=True):
        assert colour == pytest.approx(shade(deviation / 1000, 0.02).unit, abs=0.003), "as in all other pictures"
    assert found["plain"]
    assert "Traceback" not in found["said"]


def test_documents_open_where_the_worker_cannot_be_had(in_freecad, home, tmp_path) -> None:
    elsewhere = tmp_path / "elsewhere"
    mod = install(by_rule({}, sys.platform, elsewhere))
    found = in_freecad("saved")
    assert sound(found["saved"])
    (mod / INTERPRETER).write_text("/no/such/python\n")
    opened = in_freecad("opened", home=elsewhere)
    assert opened["state"] == found["saved"]
    assert "Invalid" in opened["edited"]["states"]
    assert opened["edited"]["box"] == found["saved"]["box"]
    assert opened["why"].startswith("/no/such/python cannot be started")
    assert opened["why"].endswith("run `vaultcad freecad install` again")


def test_each_vault_of_a_scan_is_an_object_of_its_own(in_freecad, make_model, tmp_path) -> None:
    fitted = [make_model(name).vaults[0] for name in ("groin", "barrel")]
    fitted[1] = replace(fitted[1], pose=replace(fitted[1].pose, lean=(0.03, -0.02)))  # of a scan that was not level
    vaults = [{**plain_vault(vault), "flags": [], "bay": bay(vault)} for vault in fitted]
    write_cloud(tmp_path / "rooms.ply", np.random.default_rng(1).uniform(-4, 4, (5000, 3)))
    found = in_freecad("several", scan=str(tmp_path / "rooms.ply"), vaults=vaults)
    assert found["families"] == ["groin vault", "barrel vault"]
    assert all(map(sound, found["states"]))
    for base, pose, vault in zip(found["bases"], found["poses"], fitted, strict=True):
        assert base == pytest.approx([1000 * v for v in (vault.pose.x, vault.pose.y, vault.pose.z + 1)])
        assert flat(pose) == pytest.approx(flat(vars(vault.pose)), abs=1e-7), (
            "where the points are, whatever the document does with them"
        )
    assert found["asked"] == {"box": vaults[1]["bay"], "family": "sail"}, "only its own bay is fitted anew"
    assert found["objects"] == ["groin vault", "groin vault"]
    assert found["deviations"] == [1, 2], "what lies outside the bay keeps its deviations"
    assert found["undone"] == ["groin vault", "barrel vault"]


def test_drawings_open_in_freecad(in_freecad, make_model, tmp_path) -> None:
    model = make_model("groin")
    (sheet,) = sheets(model)
    write_dxf([sheet], tmp_path / "drawings.dxf", model.place)
    found = in_freecad("drawing")
    assert found["shapes"] > 50
    assert found["box"][0] >= 0
    paper = [1.0 * side * sheet.scale for side in sheet.paper]  # FreeCAD's millimetres
    assert found["box"][1] <= paper[0]
    assert 0.3 * paper[1] < found["box"][2] <= paper[1]
