"""Readers on damaged files of every format: a Cloud or a ReadError, never anything else. Long; `make fuzz` runs it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from segmentation import Cloud, ReadError, read, write_cloud

SUFFIXES = (".ply", ".las", ".laz", ".e57", ".xyz")


@pytest.mark.parametrize("suffix", SUFFIXES)
@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_a_damaged_file_is_read_or_refused(suffix: str, tmp_path: Path, data: st.DataObject) -> None:
    path = tmp_path / f"scan{suffix}"
    write_cloud(path, np.random.default_rng(0).uniform(0, 5, (500, 3)))
    content = bytearray(path.read_bytes())
    for _ in range(data.draw(st.integers(1, 8))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path.write_bytes(bytes(content[: data.draw(st.integers(0, len(content)))]))
    told = _outcome(path)
    if isinstance(told, Cloud):
        assert np.isfinite(told.xyz).all()
    else:
        assert path.name in told
        assert "\n" not in told


def _outcome(path: Path) -> Cloud | str:
    try:
        return read(path)
    except ReadError as error:
        return str(error)
