"""The worker alone, asked by the add-on's own client, without FreeCAD."""

import importlib.util
import json
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from OCP.BRep import BRep_Builder
from OCP.BRepTools import BRepTools
from OCP.TopoDS import TopoDS_Shape

from families import FAMILIES, Vault, family
from families.solid import brep
from families.solid.occ.shapes import volume
from segmentation import write_cloud
from vaultcad.workbench.declarations import declared
from vaultcad.workbench.install import ADD_ON

ROOM = Path(__file__).parents[3] / "examples" / "room.laz"
IDS = [cls.id for cls in FAMILIES]


def _client() -> ModuleType:
    """The add-on's client, which needs nothing of FreeCAD's."""
    spec = importlib.util.spec_from_file_location("client", ADD_ON / "freecad" / "vaultcad_wb" / "client.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


client = _client()


@pytest.fixture(scope="module")
def worker() -> Iterator[Any]:
    worker = client.Worker(sys.executable)
    worker.ask("ping")
    yield worker
    worker.stop()


def shape_in(path: Path) -> TopoDS_Shape:
    shape = TopoDS_Shape()
    assert BRepTools.Read_s(shape, str(path), BRep_Builder())
    return shape


def test_the_unit_of_a_scan_is_said_or_asked_for(worker: Any, tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    xyz = rng.uniform(0, 1, (4000, 3))
    xyz[np.arange(4000), np.arange(4000) % 3] = 0
    write_cloud(tmp_path / "a.ply", xyz * [500, 600, 400])
    asked = {"scan": str(tmp_path / "a.ply"), "up": "z", "path": str(tmp_path / "points")}
    with pytest.raises(client.RefusedError, match="--unit cm"):
        worker.ask("read", **asked)
    told = worker.ask("read", **asked, unit="cm")
    assert told["notes"] == ["unit: centimetre, as asked (coordinates times 0.01)"]
    shown = np.fromfile(tmp_path / "points", "<f4", 3 * told["shown"]).reshape(-1, 3)
    assert np.ptp(shown, axis=0) == pytest.approx([5000, 6000, 4000], abs=50)


def test_every_vault_is_written_with_its_own_thickness_and_label(worker: Any, tmp_path: Path) -> None:
    import ifcopenshell

    vaults = []
    for k, thickness in enumerate((0.4, 0.1, 0.0)):
        vault = family("barrel")()
        told = {"family": "barrel", "profiles": vault.kinds, "parameters": vault.values()}
        pose = {"x": 20.0 * k, "y": 0.0, "z": 0.0, "yaw": 0.0}
        vaults.append({**told, "pose": pose, "thickness": thickness, "label": f"Nave {k}"})
    worker.ask("export", path=str(tmp_path / "a.ifc"), vaults=vaults)
    file = ifcopenshell.open(str(tmp_path / "a.ifc"))
    assert [roof.Name for roof in file.by_type("IfcRoof")] == ["Nave 0", "Nave 1", "Nave 2"]
    layers = [layer.LayerThickness for layer in file.by_type("IfcMaterialLayer")]
    assert layers == pytest.approx([0.4, 0.1, 0.15])
    worker.ask("export", path=str(tmp_path / "a.step"), vaults=vaults)
    assert all(f"'Nave {k}'" in (tmp_path / "a.step").read_text() for k in range(3))
    volumes = [volume(brep.masonry(family("barrel")(), thickness)) for thickness in (0.4, 0.1, 0.15)]
    from OCP.STEPControl import STEPControl_Reader

    reader = STEPControl_Reader()
    reader.ReadFile(str(tmp_path / "a.step"))
    reader.TransferRoots()
    assert volume(reader.OneShape()) == pytest.approx(sum(volumes), rel=1e-6)


@pytest.mark.parametrize("name", IDS)
def test_what_is_declared_makes_the_vault(name: str) -> None:
    vault, told = family(name)(), json.loads(json.dumps(declared(family(name))))
    numbers, profiles = {}, {}
    for parameter in told["parameters"]:
        assert parameter["meaning"]
        if parameter["kind"] == "choice":
            profiles[parameter["name"]] = parameter["default"]
            numbers |= {p["name"]: p["default"] for p in parameter["choices"][parameter["default"]]}
        else:
            numbers[parameter["name"]] = parameter["default"]
            assert parameter["low"] <= parameter["default"] <= parameter["high"]
    assert Vault.from_plain({"family": name, "profiles": profiles, "parameters": numbers}) == vault
    assert vault.kinds == profiles
    assert {size["name"] for size in told["sizes"]} == set(vault.derived_values())


@pytest.mark.parametrize("name", IDS)
def test_shapes_come_as_they_are_made_here(worker: Any, tmp_path: Path, name: str) -> None:
    vault, path = family(name)(), tmp_path / "shape.brep"
    surface = worker.ask("build", family=name, path=str(path))
    named = brep.face_names(shape_in(path), vault)
    assert surface["faces"] == [component for _, component in named]
    assert set(surface["faces"]) <= set(vault.components)
    assert surface["sizes"] == pytest.approx(vault.derived_values())
    solid = worker.ask("build", family=name, thickness=0.2, path=str(path))
    body = shape_in(path)
    assert volume(body) == pytest.approx(volume(brep.masonry(vault, 0.2)), rel=1e-6)
    assert solid["faces"] == [component for _, component in brep.face_names(body, vault)]
    assert set(solid["faces"]) <= set(solid["colours"])


def test_a_length_decides_on_its_ratio(worker: Any, tmp_path: Path) -> None:
    asked = {"family": "groin", "profiles": {"profile_x": "segmental"}, "path": str(tmp_path / "shape.brep")}
    told = worker.ask("build", lengths={"rise_x": 1.5}, **asked)
    assert told["sizes"]["rise_x"] == pytest.approx(1.5)
    assert told["parameters"]["rise_ratio_x"] == pytest.approx(0.3)
    with pytest.raises(client.RefusedError, match=r"rise_x 9: with the other sizes it can be 0.25 to 2.5 m"):
        worker.ask("build", lengths={"rise_x": 9}, **asked)


BAD = {
    "do": ({"do": "dance"}, 'cannot do "dance"; there are ping, families, build'),
    "nothing": ({}, "cannot do null"),
    "no family": ({"do": "build", "path": "x.brep"}, "family = null is no text; give one"),
    "family": ({"do": "build", "family": "igloo", "path": "x.brep"}, "no vault family is called 'igloo'"),
    "range": (
        {"do": "build", "family": "barrel", "parameters": {"span": 400}, "path": "x.brep"},
        "span = 400 lies outside [0.5, 40] m",
    ),
    "name": (
        {"do": "build", "family": "barrel", "parameters": {"breadth": 4}, "path": "x.brep"},
        "no parameter 'breadth' here",
    ),
    "text": (
        {"do": "build", "family": "barrel", "parameters": {"span": "wide"}, "path": "x.brep"},
        'span = "wide" is no number; give one',
    ),
    "list": ({"do": "build", "family": "barrel", "parameters": [4], "path": "x.brep"}, "parameters = [4] is no table"),
    "profile": (
        {"do": "build", "family": "barrel", "profiles": {"profile": "gothic"}, "path": "x.brep"},
        "no profile is called 'gothic'",
    ),
    "no such profile": (
        {"do": "build", "family": "barrel", "profiles": {"crown": "pointed"}, "path": "x.brep"},
        "a barrel vault has no profile 'crown'; it has profile",
    ),
    "thickness": (
        {"do": "build", "family": "barrel", "thickness": -1, "path": "x.brep"},
        "thickness = -1 m must be above 0",
    ),
    "folder": ({"do": "build", "family": "barrel", "path": "/no/such/folder/x.brep"}, "/no/such/folder"),
    "scan": ({"do": "read", "scan": "/no/such/scan.laz", "path": "x"}, "/no/such/scan.laz"),
    "up": ({"do": "read", "scan": str(ROOM), "up": "x", "path": "x"}, "up = 'x': give z or y"),
    "not a scan": ({"do": "fit", "scan": __file__, "path": "x"}, "test_worker.py"),
    "fit what": ({"do": "fit", "scan": str(ROOM), "family": "igloo", "path": "x"}, "no vault family is called"),
    "box": ({"do": "fit", "scan": str(ROOM), "box": {"low": 1}, "path": "x"}, "box: give frame (3 rows of 4)"),
    "vaults": ({"do": "export", "path": "x.step"}, "vaults = null is no list of tables; give at least one"),
    "suffix": ({"do": "export", "path": "x.dwg", "vaults": [{}]}, "x.dwg: unknown suffix '.dwg'; name one of .step"),
    "half": ({"do": "export", "path": "x.step", "vaults": [{"family": "sail"}]}, "vaults: KeyError 'pose'"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_refused_in_one_line(worker: Any, name: str) -> None:
    asked, why = BAD[name]
    pid = worker.pid
    call = worker.begin(asked.get("do"), **{key: value for key, value in asked.items() if key != "do"})
    with pytest.raises(client.RefusedError) as refused:
        call.result()
    assert why in str(refused.value)
    assert "\n" not in str(refused.value)
    assert "vaultcad itself" not in str(refused.value)
    assert worker.pid == pid, "it goes on"


def test_lines_that_are_no_requests() -> None:
    lines = b'rubbish\n\n[1, 2]\n"text"\n{"id": 5, "do": ["ping"]}\n\xff\xfe\n{"id": 6, "do": "families"}\n'
    process = subprocess.Popen(
        [sys.executable, "-I", "-m", client.MODULE], stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0
    )
    assert process.stdin is not None
    assert process.stdout is not None
    process.stdin.write(lines)
    stream = process.stdout
    replies = [json.loads(_line(stream)) for _ in range(6)]
    assert [reply["id"] for reply in replies] == [None, None, None, 5, None, 6]
    assert ["error" in reply for reply in replies] == [True] * 5 + [False]
    process.stdin.close()
    assert process.wait(10) == 0, "it ends with its input"
    stream.close()


def _line(stream: Any) -> bytes:
    found = b""
    while not found.endswith(b"\n"):
        found += stream.read(1)
    return found


def test_a_scan_is_read_and_fitted_in_a_box(worker: Any, tmp_path: Path) -> None:
    points, deviations = tmp_path / "points", tmp_path / "deviations"
    shown = worker.ask("read", scan=str(ROOM), path=str(points))
    n = shown["shown"]
    content = points.read_bytes()
    assert len(content) == 15 * n
    xyz = np.frombuffer(content, "<f4", 3 * n).reshape(-1, 3) / 1000
    assert shown["points"] > n > 10_000
    low, high = xyz.min(axis=0), xyz.max(axis=0)
    identity = np.eye(3, 4).tolist()
    box = {"frame": identity, "low": (low - 1).tolist(), "high": [*(high + 1)[:2].tolist(), float(high[2]) - 0.05]}
    call = worker.begin("fit", scan=str(ROOM), box=box, family="groin", path=str(deviations))
    stages = []
    while "result" not in (reply := call.poll(60)):
        assert "progress" in reply, reply
        stages.append((reply["progress"], reply["share"]))
    assert [share for _, share in stages] == sorted(share for _, share in stages)
    assert stages[0] == ("reading", 0)
    (vault,) = reply["result"]["vaults"]
    assert vault["family"] == "groin"
    assert 0 < vault["estimates"]["span_x"]["std"] < 0.05
    assert vault["bay"] is None
    d = np.frombuffer(deviations.read_bytes(), "<f4")
    assert len(d) == n
    assert np.isinf(d[xyz[:, 2] > high[2] - 0.03]).all(), "beyond the box nothing was tried"
    on = d[np.isfinite(d)]
    assert len(on) > 10_000
    assert np.sqrt(np.mean(on**2)) == pytest.approx(1000 * vault["deviation"]["rms"], rel=0.3)


def test_a_worker_that_is_killed_says_so_and_the_next_request_starts_another() -> None:
    worker = client.Worker(sys.executable)
    worker.ask("families")
    first = worker.pid
    os.kill(first, signal.SIGSTOP)
    calls = [worker.begin("families") for _ in range(2)]
    threading.Timer(0.1, os.kill, (first, signal.SIGKILL)).start()
    for call in calls:
        with pytest.raises(client.GoneError, match="killed by signal 9; the next edit starts a new one"):
            call.result(30)
    assert worker.ask("families")["families"]
    assert worker.pid not in {None, first}
    worker.stop()
    assert worker.pid is None


def test_a_worker_that_does_not_answer_is_ended() -> None:
    worker = client.Worker(sys.executable)
    worker.ask("families")
    os.kill(worker.pid, signal.SIGSTOP)
    with pytest.raises(client.GoneError, match=r"no answer within 0.2 s"):
        worker.begin("families").result(0.2)
    assert worker.pid is None


def test_a_worker_that_cannot_be_started_says_how_to_mend_it(tmp_path: Path) -> None:
    with pytest.raises(client.GoneError, match=r"cannot be started .*vaultcad freecad install"):
        client.Worker(str(tmp_path / "python")).ask("ping")
    with pytest.raises(client.GoneError, match=r"interpreter.txt is missing; run `vaultcad freecad install` again"):
        client.Worker().ask("ping")
    bare = tmp_path / "bare"
    bare.write_text("#!/bin/sh\necho 'No module named vaultcad' >&2\nexit 1\n")
    bare.chmod(0o755)
    with pytest.raises(client.GoneError, match=r"ended with code 1 \(No module named vaultcad\)"):
        client.Worker(str(bare)).ask("ping")
