"""Readers on damaged files of every format: points or a ReadError within limits, and a word where points are wrong.

`FUZZ_MUTANTS=10000 make fuzz` reads so many of each format; `python -m fuzz` prints what becomes of them.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from fuzz.outcomes import FATAL, good_file, tally
from fuzz.samples import MAKERS
from segmentation import ReadError, read

MUTANTS = int(os.environ.get("FUZZ_MUTANTS", "200"))
REDUNDANT = tuple(name for name in MAKERS if name not in ("xyz", "csv"))
"""Formats in which no lost sector may go unseen.

LAS has a box and, by this library, counts by return; what packs the points of LAZ comes to nothing without one of its
bytes or, where colours and intensities have layers of their own, has no so many zeros together; each page of an E57 has
a checksum; PLY, PCD, PTS and PTX say how many points they have, texts hold no zero bytes, and points of
zero bytes are told. XYZ and CSV say nothing: one that is cut behind a line is whole.
"""


@pytest.mark.parametrize("name", MAKERS)
def test_the_sample_is_good(tmp_path: Path, name: str) -> None:
    sample = MAKERS[name](tmp_path)
    path = tmp_path / f"good{sample.suffix}"
    path.write_bytes(good_file(sample))
    assert sample.name == name
    if sample.is_empty:
        with pytest.raises(ReadError, match="holds no points"):
            read(path)
        return
    assert {note.code for note in read(path).notes} <= {"unit", "unit-assumed", "columns"}


@pytest.mark.parametrize("name", MAKERS)
def test_a_mutant_is_read_or_refused_within_limits(tmp_path: Path, name: str) -> None:
    found = tally(name, range(MUTANTS), tmp_path)
    assert found.number(*FATAL) == 0, {outcome: found.examples.get(outcome) for outcome in FATAL}


@pytest.mark.parametrize("name", REDUNDANT)
def test_no_lost_sector_goes_unseen(tmp_path: Path, name: str) -> None:
    found = tally(name, range(MUTANTS), tmp_path, ("zeroed", "cut"))
    assert found.number(*FATAL, "silent") == 0, found.examples
