"""PTX: stations one after the other, each a grid of beams with the matrix that places it."""

import numpy as np
import pytest

from segmentation import ReadError, read

XYZ = np.round(np.random.default_rng(0).uniform(-3, 3, (60, 3)), 4)
TURN = np.array([[0.8, 0.6, 0.0], [-0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])  # rows: where the scanner's axes point
PLACE = np.array([10.0, -20.0, 1.5])


def station(xyz, rotation=None, place=(0, 0, 0), extra="0.5", size=None, columns=False):
    rotation = np.eye(3) if rotation is None else rotation
    matrix = np.eye(4)
    matrix[:3, :3], matrix[3, :3] = rotation, place
    head = [[*place], *rotation, *(matrix.T if columns else matrix)]
    width, height = size or (len(xyz) // 6, 6)
    rows = [" ".join(f"{v:.4f}" for v in row) + f" {extra}" for row in xyz]
    return "\n".join([str(width), str(height), *(" ".join(f"{v:.6f}" for v in row) for row in head), *rows]) + "\n"


def written(tmp_path, *stations):
    path = tmp_path / "a.ptx"
    path.write_text("".join(stations))
    return path


def test_stations_are_placed_by_their_matrices(tmp_path):
    cloud = read(written(tmp_path, station(XYZ), station(XYZ, TURN, PLACE)))
    np.testing.assert_allclose(cloud.xyz, np.concatenate([XYZ, XYZ @ TURN + PLACE]), atol=1e-4)
    np.testing.assert_allclose(cloud.stations, [[0, 0, 0], PLACE])
    assert cloud.color is None
    assert set(cloud.intensity) == {32768}


def test_a_matrix_for_columns_is_understood(tmp_path):
    cloud = read(written(tmp_path, station(XYZ, TURN, PLACE, columns=True)))
    np.testing.assert_allclose(cloud.xyz, XYZ @ TURN + PLACE, atol=1e-4)


def test_beams_that_nothing_sent_back_are_dropped_and_counted(tmp_path):
    beams = XYZ.copy()
    beams[::4] = 0
    cloud = read(written(tmp_path, station(beams, TURN, PLACE)))
    np.testing.assert_allclose(cloud.xyz, beams[beams.any(axis=1)] @ TURN + PLACE, atol=1e-4)
    assert cloud.dropped == 15
    assert dict(cloud.notes)["dropped"].startswith("15 points")


def test_colours(tmp_path):
    cloud = read(written(tmp_path, station(XYZ, extra="0.25 10 20 30"), station(XYZ, extra="0.25 1 2 3")))
    assert cloud.color[0].tolist() == [10 * 257, 20 * 257, 30 * 257]
    assert cloud.color[-1].tolist() == [257, 2 * 257, 3 * 257]


def test_stations_with_and_without_colour(tmp_path):
    cloud = read(written(tmp_path, station(XYZ, extra="0.25 10 20 30"), station(XYZ)))
    assert cloud.color[0].tolist() == [2570, 5140, 7710]
    assert cloud.color[-1].tolist() == [0, 0, 0]


def test_projected_stations_are_shifted(tmp_path):
    far = PLACE + [500_000, 4_700_000, 0]
    cloud = read(written(tmp_path, station(XYZ, TURN, far)))
    np.testing.assert_allclose(cloud.in_file(cloud.xyz), XYZ @ TURN + far, atol=1e-4)


@pytest.mark.parametrize("rows", [1, 7, 60])
def test_blocks_of_rows_make_no_difference(tmp_path, monkeypatch, rows):
    monkeypatch.setattr("segmentation.io.ptx.ROWS", rows)
    cloud = read(written(tmp_path, station(XYZ), station(XYZ, TURN, PLACE)))
    np.testing.assert_allclose(cloud.xyz, np.concatenate([XYZ, XYZ @ TURN + PLACE]), atol=1e-4)


def test_a_zero_matrix_is_said(tmp_path):
    cloud = read(written(tmp_path, station(XYZ, np.zeros((3, 3)))))
    np.testing.assert_allclose(cloud.xyz, XYZ, atol=1e-4)
    assert "matrix of scan 1 is zero" in dict(cloud.notes)["pose"]


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (
            lambda text: text[: len(text) * 4 // 5].rsplit("\n", 1)[0] + "\n",
            "is truncated: .* points of scan 2 are missing",
        ),
        (lambda text: text[: len(text) * 4 // 5], "no row of 4 or 7 numbers|is truncated"),
        (lambda text: text.replace("0.5\n", "0.5 9\n"), "no row of 4 or 7 numbers"),
        (lambda text: text.replace("0.5\n", "0.5 x\n", 1), "line 11 is no row"),
        (lambda text: text.replace("0.800000 0.600000", "0.100000 0.600000"), "matrix of scan 2 is no motion"),
        (lambda text: text.replace("0.800000 0.600000", "-0.800000 -0.600000"), "matrix of scan 2 is no motion"),
        (lambda text: text.replace("\n6\n", "\nsix\n", 1), "no whole PTX header of scan 1"),
        (lambda text: text + "7\n", "no whole PTX header of scan 3"),
        (lambda text: text.replace("\n6\n", "\n-6\n", 1), "no whole PTX header"),
    ],
)
def test_what_is_wrong_is_named(tmp_path, change, complaint):
    path = written(tmp_path, change(station(XYZ) + station(XYZ, TURN, PLACE)))
    with pytest.raises(ReadError, match=complaint):
        read(path)
