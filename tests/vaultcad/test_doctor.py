"""A working library, a missing one and each way of being broken, with libraries made for the purpose."""

import os
import signal
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from vaultcad import doctor
from vaultcad.doctor import LIBRARIES, PROBES, PROGRAMS, Finding, Probe, Program, examine


class Shelf:
    """A folder on the import path of this process's children and its own, to put libraries on."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def put(self, name: str, code: str = "", version: str = "1.2.3", **names: str) -> Probe:
        (self.folder / f"{name}.py").write_text(code)
        metadata = self.folder / f"{name}-{version}.dist-info"
        metadata.mkdir()
        (metadata / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n")
        (metadata / "RECORD").write_text(f"{name}.py,,\n")
        return Probe(name, name, f"import {name}", "testing", **names)


@pytest.fixture
def shelf(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Shelf:
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.syspath_prepend(tmp_path)
    return Shelf(tmp_path)


def look_at(probe: Probe, timeout: float = 30.0) -> Finding:
    [finding] = examine([probe], [], timeout=timeout)
    return finding


def test_a_library_that_imports_is_ok_and_needs_no_remedy(shelf: Shelf):
    assert look_at(shelf.put("sound")) == Finding("sound", "1.2.3", "ok", "testing", "")


def test_a_missing_library_is_named_with_the_command_that_brings_it():
    finding = look_at(Probe("Absent", "vaultcad-absent", "import vaultcad_absent", "testing"))
    assert (finding.state, finding.version) == ("missing", "")
    assert finding.remedy == f"{sys.executable} -m pip install --no-deps 'vaultcad-absent'"


def test_the_remedy_asks_for_the_version_that_the_project_pins():
    probe = next(probe for probe in PROBES if probe.name == "build123d")
    assert doctor._pip(probe.distribution).endswith("'build123d==0.12.0'")


@pytest.mark.parametrize("library", LIBRARIES)
def test_a_missing_system_library_leads_to_its_debian_package(shelf: Shelf, library: str):
    error = f"{library}: cannot open shared object file: No such file or directory"
    finding = look_at(shelf.put("unlinked", f"raise OSError({error!r})"))
    assert finding.state == "broken"
    assert finding.detail == f"OSError: {error}"
    assert LIBRARIES[library] in finding.remedy.split()


def test_an_import_that_crashes_is_a_finding(shelf: Shelf):
    finding = look_at(shelf.put("crashing", f"import os; os.kill(os.getpid(), {signal.SIGSEGV:d})"))
    assert (finding.state, finding.version, finding.detail) == ("broken", "1.2.3", "crashes (SIGSEGV)")
    assert finding.remedy.endswith("--force-reinstall 'crashing'")


def test_an_import_that_hangs_is_a_finding(shelf: Shelf):
    finding = look_at(shelf.put("hanging", "import time; time.sleep(60)"), timeout=0.5)
    assert (finding.state, finding.detail) == ("broken", "no answer within 0.5 s")


def test_a_library_that_lacks_another_is_mended_by_that_other(shelf: Shelf):
    finding = look_at(shelf.put("lacking", "import vaultcad_absent.part"))
    assert finding.state == "broken"
    assert finding.remedy.endswith("'vaultcad_absent'")


def test_a_rival_that_overwrote_the_library_is_removed_first(shelf: Shelf):
    shelf.put("rival")
    finding = look_at(shelf.put("overwritten", "raise ImportError('no VTK')", rival="rival"))
    assert (finding.state, finding.detail) == ("broken", "ImportError: no VTK")
    assert "pip uninstall -y rival && " in finding.remedy
    assert finding.remedy.endswith("--force-reinstall 'overwritten'")


def program(folder: Path, script: str) -> Program:
    path = folder / "vaultcad-program"
    path.write_text(f"#!/bin/sh\n{script}\n")
    path.chmod(0o755)
    return Program("Program", ("vaultcad-other-name", path.name), "program", "testing")


@pytest.mark.parametrize(
    ("script", "state", "version", "detail"),
    [
        ("echo Program 0.20.2 of 2023", "ok", "0.20.2", "testing"),
        ("echo no display >&2; exit 1", "broken", "", "no display"),
        ("exit 3", "broken", "", "exit status 3"),
    ],
)
def test_a_program_is_asked_for_its_version(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, script: str, state: str, version: str, detail: str
):
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    [finding] = examine([], [program(tmp_path, script)])
    assert (finding.state, finding.version, finding.detail, finding.optional) == (state, version, detail, True)
    assert bool(finding.remedy) == (state != "ok")


def test_a_program_that_is_not_there_is_missing_and_optional():
    [finding] = examine([], [Program("Program", ("vaultcad-absent",), "program", "testing")])
    assert (finding.state, finding.optional) == ("missing", True)
    assert "program" in finding.remedy.split()


def test_findings_come_in_the_order_of_the_tables(shelf: Shelf):
    probes = [shelf.put("slow", "import time; time.sleep(0.5)"), shelf.put("quick")]
    programs = [replace(program, commands=("vaultcad-absent",)) for program in PROGRAMS]  # FreeCAD takes seconds
    assert [finding.name for finding in examine(probes, programs)] == ["slow", "quick", *(p.name for p in PROGRAMS)]


@pytest.mark.parametrize(("cadquery", "asked"), [(True, "cadquery-ocp"), (False, "cadquery-ocp-novtk")])
def test_the_kernel_has_vtk_where_cadquery_is(monkeypatch: pytest.MonkeyPatch, cadquery: bool, asked: str):
    seen: list[str] = []
    monkeypatch.setattr(doctor, "_installed", lambda distribution: cadquery and distribution == "cadquery")
    monkeypatch.setattr(doctor, "examine_library", lambda probe, timeout: seen.append(probe.distribution))
    examine(programs=())
    assert [distribution for distribution in seen if "ocp" in distribution] == [asked]


def test_what_a_fit_does_without_is_optional():
    assert {"cadquery", "open3d", "plotly"} <= {probe.name for probe in PROBES if probe.optional}


def test_everything_that_vaultcad_needs_works_here():
    assert [finding for finding in examine(programs=()) if finding.state != "ok"] == []
