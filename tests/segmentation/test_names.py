import os

import numpy as np
import pytest

from segmentation import read, write_cloud, write_labelled
from segmentation.io.write import WRITERS


@pytest.mark.parametrize("suffix", WRITERS)
def test_a_file_in_a_folder_whose_names_are_no_text_is_written_read_and_labelled(suffix, tmp_path):
    folder = tmp_path / os.fsdecode(b"Gew\xf6lbe \xff")
    folder.mkdir()
    path = folder / (os.fsdecode(b"\xfcber\n") + suffix)
    xyz = np.random.default_rng(2).random((60, 3)) * 5
    write_cloud(path, xyz)
    cloud = read(path)
    assert np.allclose(cloud.in_file(cloud.xyz), xyz, atol=1e-3)
    write_labelled(path, folder / "labelled.laz", cloud, {"component": np.ones(60, np.uint16)})
    assert len(read(folder / "labelled.laz")) == 60
