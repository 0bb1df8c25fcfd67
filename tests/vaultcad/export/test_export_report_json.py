import dataclasses
import json
from math import degrees, nan, radians
from pathlib import Path

import numpy as np
import pytest

from families import FAMILIES
from vaultcad.export.report_json import report, write_report_json
from vaultcad.model import FittedPier
from vaultcad.pose import Pose
from vaultcad.uncertain import Covariance, Estimate

IDS = [cls.id for cls in FAMILIES]


@pytest.mark.parametrize("name", IDS)
def test_the_file_holds_the_contract(name, make_model, tmp_path):
    model = make_model(name)
    write_report_json(model, tmp_path / "report.json")
    told = json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))
    assert told["schema"] == 1
    assert told["scan"] == {
        "path": f"scan of a {name}.laz",
        "points": 123456,
        "bounds": [[0, 0, 0], [9, 8, 7]],
        "unit": {"name": "m", "metres": 1.0},
        "crs": None,
    }
    (vault,) = told["vaults"]
    (fitted,) = model.vaults
    assert vault["family"] == name
    assert [c["name"] for c in vault["components"]] == list(fitted.vault.components)
    assert [c["id"] for c in vault["components"]] == list(range(1, len(fitted.vault.components) + 1))
    for parameter, value in fitted.vault.values().items():
        row = vault["parameters"][parameter]
        assert row["value"] == pytest.approx(np.degrees(value) if row["unit"] == "deg" else value, abs=1e-6)
        assert "derived" not in vault["parameters"][parameter]
    for size, value in fitted.vault.derived_values().items():
        assert vault["parameters"][size] == {
            "value": pytest.approx(value, abs=1e-6),
            "unit": "m",
            "std": None,
            "derived": True,
        }
    assert vault["deviation"]["within"] == {"0.01": 0.61, "0.03": 0.95, "0.06": 0.998}
    assert vault["alternatives"][0] == {"family": "barrel", "score": 0.4}


def test_angles_are_told_in_degrees(make_model):
    model = make_model("groin")
    (vault,) = report(model)["vaults"]
    assert vault["parameters"]["yaw"] == {"value": 25.0, "unit": "deg", "std": pytest.approx(0.02)}
    assert vault["pose"]["yaw_deg"] == pytest.approx(degrees(model.vaults[0].pose.yaw))


def test_the_pose_is_in_the_scans_own_coordinates(make_model):
    model = make_model("sail", origin=np.array([500_000.0, 5_000_000.0, 100.0]))
    assert report(model)["vaults"][0]["pose"]["origin"] == [500_004.0, 5_000_003.0, 102.5]


def test_no_time_and_no_folder_is_told(make_model):
    scans = Path("here/dome.laz"), Path("/there/dome.laz")
    quick, slow = (report(make_model("dome", seconds={"fit": t}, scan=s)) for t, s in zip((1, 2), scans, strict=True))
    assert json.dumps(quick) == json.dumps(slow)


def test_what_is_no_number_becomes_null(make_model, tmp_path):
    model = make_model("barrel")
    blind = dataclasses.replace(model.vaults[0], deviation=dataclasses.replace(model.vaults[0].deviation, p95=nan))
    write_report_json(dataclasses.replace(model, vaults=(blind,)), tmp_path / "report.json")
    told = json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))
    assert told["vaults"][0]["deviation"]["p95"] is None


def test_settings_of_any_kind_are_written(make_model, tmp_path):
    settings = {"path": tmp_path, "limit": float("inf"), "sizes": (1, 2.5), "inner": {"on": True, "none": None}}
    told = report(make_model("trough", settings=settings))["settings"]
    expected = {"path": str(tmp_path), "limit": "inf", "sizes": [1, 2.5], "inner": {"on": True, "none": None}}
    assert told == expected


def test_how_sure_pose_and_parameters_are_is_told(make_model, tmp_path):
    model = make_model("sail")
    spread = Covariance(("x", "y", "z", "yaw", "span_x"), np.diag([0.01, 0.02, 0.0, radians(0.1), 0.1]) ** 2)
    spread.matrix[0, 4] = spread.matrix[4, 0] = -0.25 * 0.01 * 0.1
    blind = Estimate(1.5, "m", 0.3, seen=0.2, flags=("unseen", "weak"))
    fitted = dataclasses.replace(model.vaults[0], covariance=spread, parameters={"rise": blind})
    model = dataclasses.replace(model, vaults=(fitted,))
    write_report_json(model, tmp_path / "report.json", correlations=True)
    (vault,) = json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))["vaults"]
    assert vault["pose"]["std"] == {"x": 0.01, "y": 0.02, "z": None, "yaw_deg": pytest.approx(0.1)}
    assert vault["parameters"]["rise"] == {
        "value": 1.5,
        "unit": "m",
        "std": 0.3,
        "seen": 0.2,
        "flags": ["unseen", "weak"],
    }
    assert vault["correlations"]["names"] == ["x", "y", "z", "yaw", "span_x"]
    assert vault["correlations"]["matrix"][0] == [1, 0, 0, 0, -0.25]
    assert "correlations" not in report(model)["vaults"][0]


def test_piers_and_the_ceiling_are_told_in_the_coordinates_of_the_scan(make_model):
    (vault,) = make_model("barrel").vaults
    sizes = {name: Estimate(value, "m", 0.004, "") for name, value in (("diameter", 0.5), ("height", 3.0))}
    covariance = Covariance(("x", "y", "z", "yaw", *sizes), np.diag([4e-6, 4e-6, 1e-6, 0.0, 1.6e-5, 1.6e-5]))
    pier = FittedPier("round", Pose(1.0, 2.0, 0.5, 0.0), sizes, 800, vault.deviation, covariance)
    model = make_model("barrel", piers=(pier,), ceiling={"area": 9.0, "vault": 9.0}, origin=np.array([100.0, 0.0, 7.0]))
    told = report(model)
    (row,) = told["piers"]
    assert (row["plan"], row["points"], row["pose"]["origin"]) == ("round", 800, [101.0, 2.0, 7.5])
    assert row["pose"]["std"] == {"x": 0.002, "y": 0.002, "z": 0.001, "yaw_deg": None}
    assert row["parameters"]["height"] == {"value": 3.0, "unit": "m", "std": 0.004}
    assert told["ceiling"] == {"area": 9.0, "vault": 9.0}


def test_a_doubt_is_told_with_its_reason(make_model):
    model = make_model("dome")
    assert report(model)["vaults"][0]["doubt"] is None
    doubted = dataclasses.replace(model.vaults[0], doubt="the stone is 3.0 cm off it")
    assert report(dataclasses.replace(model, vaults=(doubted,)))["vaults"][0]["doubt"] == "the stone is 3.0 cm off it"
    assert doubted.unlike.endswith("nearest is a dome on drum and pendentives, but the stone is 3.0 cm off it.")
