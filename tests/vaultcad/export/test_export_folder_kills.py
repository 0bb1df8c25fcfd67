"""Whenever a process dies while it writes a result, and whoever writes at once: the old or the new is there whole."""

import os

import pytest

from fuzz.results import REPORT, STATES, apart, killed_after_a_change, killed_before_any_call, listing, two_at_once
from vaultcad.export.folder import clear, replacing_folder
from vaultcad.export.marker import UNFINISHED


@pytest.fixture(autouse=True)
def no_waiting_for_the_disk(monkeypatch):
    monkeypatch.setattr(os, "fsync", lambda fd: None)


@pytest.mark.parametrize("steps", ["one step", "three steps"])
@pytest.mark.parametrize("state", STATES)
def test_a_kill_before_any_call_leaves_the_old_or_the_new_whole(state, steps, tmp_path):
    apart(killed_before_any_call, state, steps, tmp_path)


def test_of_two_that_write_at_once_one_is_there_whole(tmp_path):
    apart(two_at_once, tmp_path)


def test_what_a_person_changed_is_never_lost_whenever_the_process_dies(tmp_path):
    apart(killed_after_a_change, tmp_path)


def test_what_a_dead_process_left_is_taken_away_and_what_a_living_one_makes_is_not(tmp_path):
    out = tmp_path / "out"
    theirs = [".out.backup.part", ".out.11.part", ".outer.0123456789abcdef.part", ".out.fedcba9876543210.part"]
    for name, file, content in (
        (".out.4711.part", "model.step", "half"),  # as versions before the marker named it
        (".out.0123456789abcdef.part", UNFINISHED, ""),
        (".out.0123456789abcdef.gone.part", "thesis.doc", "that of which another name is there"),
        (theirs[0], "model.ifc", "mine"),
        (theirs[1], "thesis.doc", "mine"),
        (theirs[2], UNFINISHED, ""),
        (theirs[3], UNFINISHED, "another computer"),
    ):
        (tmp_path / name).mkdir()
        (tmp_path / name / file).write_text(content)
    with replacing_folder(out) as place:
        clear(out)
        assert listing(tmp_path) == sorted([*theirs, place.part.name])
        (place.part / "report.json").write_text(REPORT % "new")
    assert listing(tmp_path) == sorted([*theirs, "out"])
