"""The add-on in FreeCAD's real window, on a screen that nobody sees. Pictures stay in the test's folder."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from families import FAMILIES
from segmentation.io import write_cloud
from vaultcad.model_file import plain_vault

pytestmark = pytest.mark.freecad
ROOM = Path(__file__).parents[3] / "examples" / "room.laz"


def test_from_the_menu_to_a_fitted_vault(in_window, tmp_path: Path) -> None:
    found = in_window("window", scan=str(ROOM))
    assert found["menu"] == ["New vault", "Import scan", "Fit vault", "Export vaults"]
    assert found["families"] == [cls.title.capitalize() for cls in FAMILIES]
    assert "VaultCad" in found["toolbar"]
    vault = found["vault"]
    assert vault["states"] == ["Up-to-date"]
    assert vault["pixels"] > 100, "it is in the picture"
    assert found["painted"] == 5, "four webs and the stone"
    assert found["status"].startswith("Groin vault001: span_x = 400 lies outside")
    assert found["face"] == "web_south"
    assert found["legend"] == ["−20 mm\nroom", "0", "+20 mm\nstone"], "as the points are coloured"
    assert "edited since the fit" not in found["as fitted"]
    assert "edited since the fit" in found["edited"]
    assert found["scan"]["mode"] == "Color"
    assert found["scan"]["pixels"] > 50
    fitted = found["fitted"]
    assert fitted["same"]
    assert fitted["states"] == ["Up-to-date"]
    assert fitted["pixels"] > 200
    value, std = found["table"]["span x"]
    assert float(value.split()[0]) == pytest.approx(4.6, abs=0.02)
    assert std.endswith(" mm")
    assert len(found["alternatives"]) > 1
    assert found["undone"] == ["Groin", "Scan"]
    assert found["again"] == 5, "colours are there again"
    assert all((tmp_path / f"{name}.png").stat().st_size > 30_000 for name in ("vault", "scan", "fitted"))


def test_new_vaults_lie_beside_what_is_there(in_window, tmp_path: Path) -> None:
    write_cloud(tmp_path / "room.ply", np.random.default_rng(1).uniform(-4, 4, (1000, 3)))
    found = in_window("beside", scan=str(tmp_path / "room.ply"))
    ids = [cls.id for cls in FAMILIES]
    assert found["pictures"] == len(ids), "each command has its own"
    assert found["fallback"].endswith("vault.svg")
    assert [vault["icon"] for vault in found["vaults"]] == [f"{name}.svg" for name in ids]
    assert found["vaults"][0]["base"] == [0, 0, 0], "the first lies at the origin"
    for vault in found["vaults"]:
        assert vault["states"] == ["Up-to-date"]
        assert vault["selected"], "it alone"
        assert vault["base"][1:] == [0, 0]
        assert vault["box"][4] == pytest.approx(0, abs=1e-3)
    for before, vault in pairwise(found["vaults"]):
        assert vault["box"][0] == pytest.approx(before["box"][1] + 1000, abs=0.01)
    assert found["past"][0] == pytest.approx(found["scan"][1] + 1000, abs=0.01), "past a scan where it was moved to"
    assert found["steps"] == 1
    assert found["undone"]
    assert found["redone"] == [found["past"], "dome.svg"]
    assert found["opened"] == [f"{name}.svg" for name in (*ids, "dome")]
    assert "Traceback" not in found["said"]


def test_nothing_of_the_panel_is_cut_in_a_narrow_dock(in_window, make_model) -> None:
    flags = ["profile x: semicircular or stilted or segmental", "springing: known only roughly"]
    others = [(cls.id, 0.1) for cls in reversed(FAMILIES)]  # that of the longest title is shown
    vaults = []
    for cls in FAMILIES:
        report = plain_vault(make_model(cls.id).vaults[0])
        size = {"value": 12.3456, "unit": "m", "std": None, "meaning": "one whose name takes several lines"}
        report["estimates"]["ratio_of_a_family_that_is_added_later"] = size
        for estimate in report["estimates"].values():
            estimate["std"] = 0.2431
        vaults.append({**report, "flags": flags, "alternatives": others, "region": None})
    found = in_window("narrow", vaults=vaults)
    for cls in FAMILIES:
        seen = found[cls.id]
        assert seen["dock"] <= 310
        assert (seen["scrolled"], seen["cut"], seen["labels"]) == (0, [], []), cls.id
