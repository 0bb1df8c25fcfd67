import os

import numpy as np
import pytest

from segmentation import write_cloud
from segmentation.io.whole import replacing
from segmentation.io.write import WRITERS


@pytest.mark.parametrize("suffix", WRITERS)
def test_a_file_has_the_permissions_that_the_mask_leaves(suffix, tmp_path):
    mask = os.umask(0o027)
    try:
        write_cloud(tmp_path / f"cloud{suffix}", np.random.default_rng(1).random((50, 3)))
    finally:
        os.umask(mask)
    (written,) = tmp_path.iterdir()
    assert written.stat().st_mode & 0o777 == 0o640
    assert written.stat().st_size > 0


def test_the_file_beside_is_new_and_its_name_cannot_be_foreseen(tmp_path):
    names = set()
    for _ in range(3):
        with replacing(tmp_path / "a.laz") as beside:
            assert beside.is_file()
            assert not beside.is_symlink()
            names.add(beside.name)
    assert len(names) == 3


def test_a_link_in_the_place_of_the_file_beside_is_not_followed(tmp_path, monkeypatch):
    monkeypatch.setattr("secrets.token_hex", lambda n: "known")
    (tmp_path / "precious").write_text("mine")
    (tmp_path / ".vaultcad-known.txt").symlink_to(tmp_path / "precious")
    with pytest.raises(OSError, match="File exists"), replacing(tmp_path / "a.txt"):
        raise AssertionError("got inside")
    assert (tmp_path / "precious").read_text() == "mine"
    assert (tmp_path / ".vaultcad-known.txt").is_symlink()


def test_the_longest_name_that_a_file_can_have_is_written(tmp_path):
    path = tmp_path / ("n" * 251 + ".ply")
    write_cloud(path, np.zeros((1, 3)))
    assert path.is_file()
