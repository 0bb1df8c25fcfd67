"""What a fit leaves of its scan is read back in the model's own frame."""

from dataclasses import replace
from pathlib import Path

import laspy
import numpy as np
import pytest

from families import Groin
from segmentation.cloud import Cloud, turn_back
from segmentation.io import read, write_cloud, write_labelled
from vaultcad.errors import ModelFileError
from vaultcad.fit.label import Labels
from vaultcad.labelled_scan import SEGMENTS, labelled_scan, read_labelled_scan
from vaultcad.model import Model
from vaultcad.model_file import MODEL, write_model
from vaultcad.pose import Pose


def left(folder: Path, model: Model, cloud: Cloud, labels: Labels) -> Model:
    """The files of a fit in a folder, and its model."""
    ends = cloud.in_file(np.array([cloud.xyz.min(axis=0), cloud.xyz.max(axis=0)]))
    settings = {"up": cloud.up, "scale": cloud.scale.tolist()}
    model = replace(model, origin=cloud.origin, bounds=np.sort(ends, axis=0), unit=float(cloud.scale[0]))
    counts = np.bincount(labels.component[labels.vault > 0], minlength=len(model.vaults[0].components) + 1)
    components = tuple(replace(one, points=int(counts[one.id])) for one in model.vaults[0].components)
    model = replace(model, settings=settings, vaults=(replace(model.vaults[0], components=components),))
    folder.mkdir()
    write_model(model, folder / MODEL)
    assert cloud.source is not None
    extra = {"vault": labels.vault, "component": labels.component, "arch": labels.arch, "deviation": labels.deviation}
    write_labelled(cloud.source, folder / SEGMENTS, cloud, extra)
    return model


@pytest.fixture
def vault_scan(tmp_path):
    """A scan of a groin vault far from zero, y up, in feet, its labels, and its points in the vault's frame."""
    rng = np.random.default_rng(7)
    sample = Groin(4.0, 5.0).sample(4000, rng=rng)
    there = turn_back(sample.xyz + [431_000.0, 5_000_000.0, 100.0], "y")
    write_cloud(tmp_path / "scan.laz", there / 0.3048)
    cloud = read(tmp_path / "scan.laz", up="y", unit="ft")
    n = len(cloud)
    deviation = rng.normal(0, 0.003, n).astype(np.float32)
    labels = Labels(sample.component.astype(np.uint16), np.ones(n, np.uint16), deviation, np.zeros(n, np.uint16))
    return sample.xyz, cloud, labels


def test_points_come_back_where_the_model_is(tmp_path, make_model, vault_scan):
    xyz, cloud, labels = vault_scan
    model = left(tmp_path / "out", make_model("groin"), cloud, labels)
    back, fresh = read_labelled_scan(tmp_path / "out"), labelled_scan(model, cloud, labels)
    assert back.xyz.dtype == fresh.xyz.dtype
    np.testing.assert_allclose(back.xyz, fresh.xyz, atol=2e-4)
    for name in ("vault", "component", "arch", "deviation"):
        np.testing.assert_array_equal(getattr(back, name), getattr(fresh, name))
    x, y, z = np.array([431_000.0, 5_000_000.0, 100.0]) - model.origin
    placed = replace(model.vaults[0], pose=Pose(x, y, z, 0.0))
    np.testing.assert_allclose(back.in_frame(placed, back.of(1)), xyz, atol=2e-4)


def test_points_of_no_vault_can_be_left_out(tmp_path, make_model, vault_scan):
    _, cloud, labels = vault_scan
    some = np.arange(len(cloud)) % 3 > 0
    left(tmp_path / "out", make_model("groin"), cloud, replace(labels, vault=some.astype(np.uint16)))
    whole, mine = read_labelled_scan(tmp_path / "out"), read_labelled_scan(tmp_path / "out", labelled=True)
    np.testing.assert_array_equal(mine.xyz, whole.xyz[some])
    np.testing.assert_array_equal(mine.deviation, whole.deviation[some])


def test_a_folder_that_is_no_result_is_refused(tmp_path, make_model, vault_scan):
    xyz, cloud, labels = vault_scan
    with pytest.raises(ModelFileError, match=r"has no model\.json"):
        read_labelled_scan(tmp_path)
    left(tmp_path / "out", make_model("groin"), cloud, replace(labels, vault=labels.vault + 1))
    with pytest.raises(ModelFileError, match="labels of more vaults"):
        read_labelled_scan(tmp_path / "out")
    left(tmp_path / "other", make_model("groin"), cloud, labels)
    las = laspy.read(tmp_path / "other" / SEGMENTS)
    las.points = las.points[1:]
    las.write(tmp_path / "other" / SEGMENTS)
    with pytest.raises(ModelFileError, match=r"has 3,999 points of vault 1, model\.json tells of 4,000"):
        read_labelled_scan(tmp_path / "other")
    las.points = las.points[:0]
    las.write(tmp_path / "out" / SEGMENTS)
    with pytest.raises(ModelFileError, match="has no points"):
        read_labelled_scan(tmp_path / "out")
    write_cloud(tmp_path / "out" / SEGMENTS, xyz)
    with pytest.raises(ModelFileError, match="no dimension"):
        read_labelled_scan(tmp_path / "out")
