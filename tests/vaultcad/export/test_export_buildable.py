"""What OpenCASCADE cannot build is nudged until it can, or refused in one line."""

from __future__ import annotations

from dataclasses import replace

import ifcopenshell
import pytest
import trimesh

from families import FAMILIES, BasketHandle, Groin, Semicircular, Stilted
from vaultcad.errors import ExportError
from vaultcad.export import buildable as module
from vaultcad.export.bundle import WRITERS, write_all
from vaultcad.export.marker import MARKER
from vaultcad.export.step import write_step
from vaultcad.labelled_scan import SEGMENTS
from vaultcad.model_file import read_model

IDS = tuple(cls.id for cls in FAMILIES)
UNSEEN = 0.16  # m; no other test asks for a solid of this thickness, so that none is remembered


def test_a_vault_that_can_be_built_stays_as_it_is(make_model) -> None:
    model = make_model("trough")
    assert module.buildable(model).vaults[0].vault == model.vaults[0].vault


def test_a_vault_that_cannot_be_built_is_moved_by_less_than_a_millimetre(make_model, monkeypatch) -> None:
    model = make_model("groin")
    vault = model.vaults[0].vault
    tried = []

    def masonry(trial, thickness):
        tried.append(trial)
        if trial == vault:
            raise ValueError("OpenCASCADE cannot do it")

    monkeypatch.setattr(module, "masonry", masonry)
    monkeypatch.setattr(module, "exact", lambda *_: ())
    monkeypatch.setattr(module, "cut", lambda *_: ())
    drawn = module.buildable(model)
    moved = drawn.vaults[0].vault
    assert [note.code for note in drawn.notes if note not in model.notes] == ["nudged"]
    assert "mm off the fitted groin vault" in drawn.notes[-1].text
    assert tried[0] == vault
    assert moved != vault
    assert moved.derived_values() == pytest.approx(vault.derived_values(), abs=1e-3)


@pytest.mark.parametrize(
    "vault",
    [
        Groin(5.008893549912352, 5.017148503046791, Stilted(0.5008240296037618), Semicircular()),
        Groin(4.669792448817519, 4.669746390492405, Stilted(0.5007358811106092), Semicircular(), 0.0, 0.0421895281),
        Groin(5.600789675341074, 5.614254317397447, Stilted(0.5008506768048707), BasketHandle(0.4899506210073029, 0.5)),
        Groin(
            3.717822108881830, 4.161868033436969, Stilted(0.5008943931), BasketHandle(0.4897435106, 0.5), 0.0, 0.0086888
        ),
    ],
    ids=["stilted and round", "with an offset", "stilted and basket-handle", "of a rectangle"],
)
def test_arches_that_are_nearly_one_are_built_as_they_are(make_model, vault) -> None:
    model = make_model("groin")
    drawn = module.buildable(replace(model, vaults=(replace(model.vaults[0], vault=vault),)))
    assert [fitted.vault for fitted in drawn.vaults] == [vault]
    assert not [note for note in drawn.notes if note.code in {"nudged", "unbuilt"}]


@pytest.fixture
def broken(monkeypatch):
    """OpenCASCADE builds nothing."""

    def never(*_):
        raise ValueError("OpenCASCADE cannot do it")

    monkeypatch.setattr("families.solid.brep.masonry", never)


@pytest.mark.parametrize("family", IDS)
def test_a_vault_that_cannot_be_built_at_all_leaves_all_but_the_solid(make_model, broken, tmp_path, family) -> None:
    model = make_model(family, thickness=UNSEEN)
    drawn = write_all(model, tmp_path / "out", segments=lambda path: path.write_bytes(b"")).model
    (note,) = drawn.notes
    assert note.code == "unbuilt"
    assert f"cannot build this {model.vaults[0].vault.title} with walls of {UNSEEN:g} m" in note.text
    assert {path.name for path in (tmp_path / "out").iterdir()} == {*WRITERS, SEGMENTS, MARKER} - {"model.step"}
    assert "cannot build" in (tmp_path / "out" / "report.html").read_text()
    assert read_model(tmp_path / "out" / "model.json").notes == model.notes  # whoever reads it builds it again
    scene = trimesh.load(tmp_path / "out" / "model.glb")
    assert set(model.vaults[0].vault.components) <= set(scene.geometry)
    slabs = ifcopenshell.open(str(tmp_path / "out" / "model.ifc")).by_type("IfcSlab")
    assert {slab.Name for slab in slabs} == set(model.vaults[0].vault.components)


def test_a_step_file_is_not_written_without_a_solid(make_model, broken, tmp_path) -> None:
    with pytest.raises(ExportError, match="no vault has a solid"):
        write_step(module.buildable(make_model("groin", thickness=UNSEEN)), tmp_path / "a.step")


def test_files_of_an_earlier_result_that_this_one_has_not_go_with_it(make_model, tmp_path, monkeypatch) -> None:
    model, out = make_model("sail"), tmp_path / "out"
    write_all(model, out, segments=lambda path: path.write_bytes(b""))
    assert (out / "model.step").exists()
    monkeypatch.setattr("vaultcad.export.buildable._built", lambda *_: None)
    write_all(model, out, segments=lambda path: path.write_bytes(b""))
    assert not (out / "model.step").exists()
