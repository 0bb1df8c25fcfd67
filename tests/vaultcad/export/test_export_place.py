"""Rooms that are fitted one by one stand side by side when their files are opened together."""

import dataclasses
import json
import struct
from pathlib import Path

import numpy as np
import pytest

from segmentation.crs import of_code
from segmentation.notes import Note
from segmentation.units import UNITS
from vaultcad.export.glb import write_glb
from vaultcad.export.ifc import write_ifc
from vaultcad.export.report_html import write_report_html
from vaultcad.export.report_json import write_report_json
from vaultcad.export.step import write_step
from vaultcad.export.world import write_world

ORIGIN = np.array([500_000.0, 4_700_000.0, 0.0])


@pytest.fixture(scope="module")
def model(make_model):
    """A barrel whose scan declares UTM, and was shifted."""
    return dataclasses.replace(make_model("barrel"), origin=ORIGIN, crs=of_code(32633))


@pytest.fixture(scope="module")
def survey(make_model):
    """A barrel whose scan is in US survey feet."""
    return dataclasses.replace(make_model("barrel"), origin=ORIGIN, crs=of_code(2263), unit=UNITS["ftUS"])


def world(path: Path) -> list[list[list[float]]]:
    return [[[float(v) for v in pair.split(",")] for pair in line.split()] for line in path.read_text().splitlines()]


def test_the_world_file_takes_millimetres_to_the_map(model, survey, tmp_path):
    write_world(model, tmp_path / "a.wld")
    assert world(tmp_path / "a.wld") == [[[0, 0], [500_000, 4_700_000]], [[1e6, 0], [501_000, 4_700_000]]]
    write_world(survey, tmp_path / "b.wld")
    (first, second) = world(tmp_path / "b.wld")
    assert np.multiply(first[1], UNITS["ftUS"]) == pytest.approx([500_000, 4_700_000], abs=1e-4)
    assert (second[1][0] - first[1][0]) * UNITS["ftUS"] == pytest.approx(1000, abs=1e-4)


def test_step_says_its_place(model, tmp_path):
    write_step(model, tmp_path / "a.step")
    head = (tmp_path / "a.step").read_text().partition("ENDSEC;")[0]
    assert "FILE_DESCRIPTION(('coordinates relative to origin 500000 4700000 0 m, EPSG:32633'),'2;1');" in head
    from OCP.STEPControl import STEPControl_Reader

    assert STEPControl_Reader().ReadFile(str(tmp_path / "a.step"))


def test_glb_says_its_place(model, tmp_path):
    write_glb(model, tmp_path / "a.glb")
    data = (tmp_path / "a.glb").read_bytes()
    head = json.loads(data[20 : 20 + struct.unpack_from("<I", data, 12)[0]])
    assert head["scenes"][0]["extras"] == {"origin": ORIGIN.tolist(), "crs": "EPSG:32633"}


def test_ifc_takes_the_system_that_the_scan_declares(model, survey, tmp_path):
    import ifcopenshell
    import ifcopenshell.util.unit

    write_ifc(model, tmp_path / "a.ifc")
    file = ifcopenshell.open(str(tmp_path / "a.ifc"))
    (grid,) = file.by_type("IfcProjectedCRS")
    assert (grid.Name, grid.Description) == ("EPSG:32633", "WGS 84 / UTM zone 33N")
    write_ifc(survey, tmp_path / "b.ifc")
    file = ifcopenshell.open(str(tmp_path / "b.ifc"))
    (grid,), (conversion,) = file.by_type("IfcProjectedCRS"), file.by_type("IfcMapConversion")
    assert grid.Name == "EPSG:2263"
    foot = grid.MapUnit.ConversionFactor.ValueComponent.wrappedValue
    assert foot == pytest.approx(UNITS["ftUS"])
    assert conversion.Eastings * foot == pytest.approx(500_000)
    assert conversion.Scale * foot == pytest.approx(1)
    project = ifcopenshell.util.unit.calculate_unit_scale(file)
    assert project == 1  # the model itself stays in metres


def test_what_was_assumed_stands_in_the_reports(model, tmp_path):
    noted = dataclasses.replace(model, notes=(Note("unit-assumed", "metres <assumed>"), Note("specks", "two")))
    write_report_json(noted, tmp_path / "a.json")
    told = json.loads((tmp_path / "a.json").read_text())
    assert told["notes"] == [
        {"code": "unit-assumed", "text": "metres <assumed>"},
        {"code": "specks", "text": "two"},
    ]
    assert told["scan"]["crs"] == {"name": "WGS 84 / UTM zone 33N", "epsg": 32633}
    write_report_html(noted, tmp_path / "a.html")
    page = (tmp_path / "a.html").read_text()
    assert "<li>metres &lt;assumed&gt;</li>" in page
    write_report_html(model, tmp_path / "b.html")
    assert "Notes on the scan" not in (tmp_path / "b.html").read_text()
