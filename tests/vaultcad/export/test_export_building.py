"""A row of two bays with an arch, and a vault above, in all files."""

import dataclasses
import json
import re

import ifcopenshell
import ifcopenshell.util.element
import ifcopenshell.validate
import numpy as np
import pytest
import trimesh

from families.drawing.sheet import Area
from vaultcad.cli.summary import show_summary
from vaultcad.errors import ModelFileError
from vaultcad.export.building_plan import building_plans
from vaultcad.export.glb import write_glb
from vaultcad.export.ifc import write_ifc
from vaultcad.export.report_html import write_report_html
from vaultcad.export.report_json import report
from vaultcad.export.step import write_step
from vaultcad.model_file import plain_model, read_model, write_model
from vaultcad.notebook import of_model


@pytest.fixture(scope="module")
def ifc(building, tmp_path_factory):
    path = tmp_path_factory.mktemp("ifc") / "model.ifc"
    write_ifc(building, path)
    return ifcopenshell.open(str(path))


def test_report_tells_of_arches_rows_rooms_and_storeys(building):
    told = report(building)
    (arch,) = told["arches"]
    assert (arch["id"], arch["family"], arch["between"]) == (1, "transverse", [2, 1])
    assert arch["span"]["value"] == pytest.approx(4.6)
    assert arch["springing"] == {"value": 213.0, "unit": "m", "std": 0.002, "derived": True}
    assert arch["depth"] == {"south": 0.25, "north": None}
    assert arch["thickness"] == 0.25
    assert arch["arcs"][0]["radius"]["value"] == pytest.approx(0.8 * 4.6)
    assert arch["setting_out"][0]["rule"] == "fifth-point"
    assert arch["setting_out"][0]["chance"] > 0.9
    assert told["vaults"][0]["bay"] == {"row": "A", "number": 2, "room": 1, "storey": 1}
    assert told["building"]["rows"] == {"A": [2, 1], "B": [3]}
    assert told["building"]["rooms"] == [[1, 2], [3]]
    floors = [storey["floor"] for storey in told["building"]["storeys"]]
    assert floors == [None, pytest.approx(215.65)]


def test_model_json_keeps_arches_whole(building, tmp_path):
    write_model(building, tmp_path / "model.json")
    back = read_model(tmp_path / "model.json")
    assert plain_model(back) == plain_model(building)
    assert back.arches[0].beside == (2, 1)
    assert np.isnan(back.arches[0].depth[1])


def test_an_arch_that_was_edited_is_named_and_one_that_cannot_be_is_refused(building, tmp_path):
    path = tmp_path / "model.json"
    told = plain_model(building)
    told["arches"][0]["parameters"]["span"] = 4.7
    path.write_text(json.dumps(told))
    assert [note.text for note in read_model(path).notes if note.code == "edited"] == [
        "arch 1 was edited after the fit, whose deviations and coverage are told; bodies are ideal ones"
    ]
    told["arches"][0]["depth"] = [True, None]
    path.write_text(json.dumps(told))
    with pytest.raises(ModelFileError, match="depth = True is no number"):
        read_model(path)


def test_models_of_before_there_were_arches_are_read(building, tmp_path):
    told = plain_model(building)
    del told["arches"]
    (tmp_path / "model.json").write_text(json.dumps(told))
    assert read_model(tmp_path / "model.json").arches == ()


def test_step_has_the_arch_as_a_part_of_the_assembly(building, tmp_path):
    write_step(building, tmp_path / "model.step")
    names = re.findall(r"PRODUCT\('([^']*)'", (tmp_path / "model.step").read_text())
    assert names == ["two bays", "1 groin vault", "2 groin vault", "3 sail vault", "arch 1"]


def test_glb_has_the_arch_where_it_stands(building, tmp_path):
    write_glb(building, tmp_path / "model.glb")
    scene = trimesh.load(tmp_path / "model.glb")
    low, high = np.concatenate([scene.geometry[f"arch 1/{name}"].vertices for name in ("barrel", "extrados")]).T[[0, 2]]
    assert (low.min(), low.max()) == pytest.approx((2.3, 2.8), abs=1e-3)  # as wide as the arch
    assert np.ptp(high) == pytest.approx(5.1, abs=1e-3)  # the span and its depth on both sides


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # it leaves its own rules' file open
def test_ifc_is_valid_and_has_members_storeys_and_rooms(ifc):
    log = ifcopenshell.validate.json_logger()
    ifcopenshell.validate.validate(ifc, log, express_rules=True)
    assert log.statements == []
    (member,) = ifc.by_type("IfcMember")
    assert member.Name == "Arch 1"
    assert ifcopenshell.util.element.get_type(member).ElementType == "ARCH"
    told = ifcopenshell.util.element.get_psets(member)
    assert told["VaultCAD_Arch"]["depth"] == 0.25
    assert told["VaultCAD_Arch"]["setting_out"].startswith("fifth-point")
    assert told["Pset_MemberCommon"]["Span"] == pytest.approx(4.6)
    lower, upper = ifc.by_type("IfcBuildingStorey")
    assert (lower.Name, upper.Name, upper.Elevation) == ("Storey 1", "Storey 2", pytest.approx(5.65))
    assert [e.Name for e in upper.ContainsElements[0].RelatedElements] == ["Row B bay 1: sail vault"]
    assert len(lower.ContainsElements[0].RelatedElements) == 3
    spaces = {space.Name: space.LongName for space in ifc.by_type("IfcSpace")}
    assert spaces == {"Room 1": "bays A1 to A2", "Room 2": "bay B1"}


def test_the_upper_storey_is_not_moved_by_its_elevation(ifc, building):
    import ifcopenshell.util.placement

    (roof,) = (roof for roof in ifc.by_type("IfcRoof") if "sail" in roof.Name)
    place = ifcopenshell.util.placement.get_local_placement(roof.ObjectPlacement)
    assert place == pytest.approx(building.vaults[2].pose.placement())


def test_plans_are_drawn_storey_by_storey_by_family_and_by_deviation(building):
    plans = list(building_plans(building))
    assert ["storey 1" in p.title for p in plans] == [True, True, False, False]
    areas = [mark for mark in plans[0].marks if isinstance(mark, Area)]
    assert [area.name for area in areas] == ["row A bay 2", "row A bay 1", "arch 1"]
    assert areas[0].colour == areas[1].colour != areas[2].colour


def test_the_page_opens_with_plan_and_tables_then_a_sheet_a_vault(building, tmp_path):
    write_report_html(building, tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    heads = re.findall(r"<h1>(.*?)</h1>", page)
    assert heads == [
        "3 vaults, 1 arch",
        "1 · row A bay 2: groin vault",
        "2 · row A bay 1: groin vault",
        "3 · row B bay 1: sail vault",
    ]
    links = set(re.findall(r'href="#(.*?)"', page))
    assert links == set(re.findall(r'id="(vault-.*?)"', page)) == {"vault-1", "vault-2", "vault-3"}
    assert "fifth-point" in page
    assert "http" not in page.replace("http://www.w3.org", "")


def test_the_summary_has_a_line_a_vault_and_one_for_the_arches(building, tmp_path, capsys):
    show_summary(building, tmp_path)
    told = capsys.readouterr().out
    assert re.search(r"2 +A1 +groin +97% +4.60 × 5.00 +2.50 +213.00 +12.0", told)
    assert "1 arch: 1 pointed; spans 4.60 m, rms 12.0 mm" in told


def test_a_notebook_shows_the_plan_and_the_arch(building):
    page = of_model(building)["text/html"]
    assert page.count("<svg") == 4 + 2 * 3
    assert "3 vaults, 1 arch" in page
    assert "arch 1: pointed" in page


def test_one_arch_beside_one_vault_needs_no_plan(building, tmp_path):
    alone = dataclasses.replace(building, vaults=building.vaults[:1])
    arch = dataclasses.replace(building.arches[0], beside=(1, 0))
    write_report_html(dataclasses.replace(alone, arches=(arch,)), tmp_path / "report.html")
    assert "1 vault, 1 arch" in (tmp_path / "report.html").read_text(encoding="utf-8")
