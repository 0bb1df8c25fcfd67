"""What people and other programs change in the folder of a result, or add to it, is kept or refused."""

import os

import pytest

from fuzz.results import FILES, MAP, REPORT, listing, words, write
from vaultcad.errors import ExportError
from vaultcad.export import exchange as module
from vaultcad.export import folder
from vaultcad.export.folder import check_target


@pytest.fixture(autouse=True)
def no_waiting_for_the_disk(monkeypatch):
    monkeypatch.setattr(os, "fsync", lambda fd: None)


def test_what_others_add_while_it_changes_places_is_not_lost(tmp_path, monkeypatch):
    """An application saves into the folder that it had open, at the worst of times."""
    out = tmp_path / "out"
    write(out, "old")
    swap = module.exchange

    def late(one, other):
        swap(one, other)
        (one / "late.txt").write_text("mine")

    monkeypatch.setattr("vaultcad.export.folder.exchange", late)
    write(out, "new")
    assert words(out) == {REPORT % "new"}
    assert (out / "late.txt").read_text() == "mine"
    assert listing(tmp_path) == ["out"]


def test_what_a_person_changes_while_it_changes_places_is_kept(tmp_path, monkeypatch):
    out = tmp_path / "out"
    write(out, "old")
    carry = folder._carry_along

    def late(source, part):
        carry(source, part)
        (source / "model.ifc").write_text("with a wall more")

    monkeypatch.setattr(folder, "_carry_along", late)
    assert (write(out, "new").kept / "model.ifc").read_text() == "with a wall more"


def test_a_file_of_somebody_elses_does_not_come_over_ours_by_its_date(tmp_path):
    out = tmp_path / "out"
    write(out, "old")
    (out / "review.png").write_text("mine")
    os.utime(out / "review.png", (4e9, 4e9))
    write(out, "new", names=[*FILES, "review.png"], force=True)
    assert words(out, [*FILES, "review.png"]) == {REPORT % "new"}
    check_target(out, FILES)


def test_what_a_person_changed_is_refused_and_replaced_by_force(tmp_path):
    out = tmp_path / "out"
    write(out, "old")
    (out / "model.ifc").write_text("with a wall more")
    with pytest.raises(ExportError, match=r"model\.ifc was changed since it was written .* --force"):
        check_target(out, FILES)
    check_target(out, FILES, force=True)
    assert write(out, "new", force=True).kept is None
    assert words(out) == {REPORT % "new"}
    assert listing(tmp_path) == ["out"]


@pytest.mark.parametrize("names", [["sections.json"], ["sections.json", "model.ifc"]])
def test_a_result_of_another_kind_is_not_replaced_even_by_force(tmp_path, names):
    out = tmp_path / "out"
    write(out, "a fit")
    for force in (False, True):
        with pytest.raises(ExportError, match=r"another kind of result, with .* name another folder"):
            check_target(out, names, force=force)
    assert words(out) == {REPORT % "a fit"}


def test_what_a_person_changed_in_the_meantime_is_kept(tmp_path):
    out = tmp_path / "out"
    write(out, "old")
    for number in (1, 2):
        (out / "model.ifc").write_text("with a wall more")
        assert write(out, "new").kept == tmp_path / f"out-before-{number}"
        assert (tmp_path / f"out-before-{number}" / "model.ifc").read_text() == "with a wall more"
        assert words(out) == {REPORT % "new"}


def test_a_file_of_somebody_elses_under_a_name_of_ours_is_refused(tmp_path):
    out = tmp_path / "out"
    write(out, "old")
    (out / "review.png").write_text("mine")
    check_target(out, FILES)
    with pytest.raises(ExportError, match=r"review\.png is not of the earlier result"):
        check_target(out, [*FILES, "review.png"])
    kept = write(out, "new", names=[*FILES, "review.png"]).kept
    assert (kept / "review.png").read_text() == "mine"


def test_what_was_taken_out_by_a_person_is_no_change(tmp_path):
    out = tmp_path / "out"
    write(out, "old")
    (out / "report.json").unlink()
    check_target(out, FILES)
    write(out, "new")
    assert words(out) == {REPORT % "new"}


def test_what_others_put_into_a_folder_of_ours_goes_along(tmp_path):
    out = tmp_path / "out"
    write(out, "old", names=[*FILES, MAP])
    (out / "unrolled" / "cracks.dxf").write_text("mine")
    write(out, "new", names=[*FILES, MAP])
    assert words(out, [*FILES, MAP]) == {REPORT % "new"}
    write(out, "without")
    assert listing(out / "unrolled") == ["cracks.dxf"]
    assert (out / "unrolled" / "cracks.dxf").read_text() == "mine"
    assert listing(tmp_path) == ["out"]


def test_what_a_person_draws_on_a_file_in_a_folder_of_ours_is_refused_and_kept(tmp_path):
    out = tmp_path / "out"
    write(out, "old", names=[*FILES, MAP])
    (out / MAP).write_text("with a crack")
    with pytest.raises(ExportError, match=r"vault-1\.dxf was changed since it was written .* --force"):
        check_target(out, [*FILES, "unrolled"])
    assert (write(out, "new", names=[*FILES, MAP]).kept / MAP).read_text() == "with a crack"


def test_a_folder_of_somebody_elses_under_a_name_of_ours_is_refused(tmp_path):
    out = tmp_path / "out"
    write(out, "old")
    (out / "unrolled").mkdir()
    with pytest.raises(ExportError, match=r"unrolled is not of the earlier result"):
        check_target(out, [*FILES, "unrolled"])
