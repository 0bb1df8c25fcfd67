"""Points that a file marks, and points far from all others: left out of the work, kept in what is written, said."""

import laspy
import numpy as np
import pye57
import pytest

from segmentation import ReadError, read, write_cloud, write_labelled
from vaultcad.survey.thinned_scan import thin_scan

N = 3000


def shell(n=N, seed=0):
    """Points on the six faces of a room of 5 by 6 by 4 m."""
    rng = np.random.default_rng(seed)
    xyz = rng.uniform(0, 1, (n, 3))
    face = rng.integers(0, 6, n)
    xyz[np.arange(n), face // 2] = face % 2
    return np.round(xyz * [5, 6, 4], 4)


def las(path, xyz, fmt, **dimensions):
    header = laspy.LasHeader(version="1.4" if fmt >= 6 else "1.2", point_format=fmt)
    header.scales, header.offsets = [1e-4] * 3, np.floor(xyz.min(axis=0))
    data = laspy.LasData(header)
    data.x, data.y, data.z = xyz.T
    for name, values in dimensions.items():
        data[name] = values
    data.write(path)
    return path


MARKS = [
    ("withheld", {"withheld": 1}),
    ("synthetic", {"synthetic": 1}),
    ("noise (class 7)", {"classification": 7}),
    ("high noise (class 18)", {"classification": 18}),
]


@pytest.mark.parametrize("suffix", [".las", ".laz"])
@pytest.mark.parametrize("fmt", [1, 3, 6, 7])
@pytest.mark.parametrize(("name", "mark"), MARKS)
def test_marked_points_of_las_take_no_part_but_stay_in_the_file(tmp_path, suffix, fmt, name, mark):
    xyz = shell()
    marked = np.arange(N) % 7 == 2
    dimensions = {key: np.where(marked, value, 0).astype(np.uint8) for key, value in mark.items()}
    path = las(tmp_path / f"a{suffix}", xyz, fmt, **dimensions)
    cloud = read(path)
    np.testing.assert_allclose(cloud.xyz, xyz[~marked], atol=1e-5)
    assert dict(cloud.notes)["marked"].startswith(f"left out as the file marks them: {marked.sum()} {name}")
    labels = {"component": np.full(len(cloud), 3, np.uint16), "deviation": np.zeros(len(cloud), np.float32)}
    write_labelled(path, tmp_path / "out.laz", cloud, labels)
    found = laspy.read(tmp_path / "out.laz")
    np.testing.assert_allclose(found.xyz, xyz, atol=1e-4)
    np.testing.assert_array_equal(found["component"], np.where(marked, 0, 3))
    np.testing.assert_array_equal(np.isnan(found["deviation"]), marked)
    whole = read(path, keep_marked=True)
    assert len(whole) == N
    assert "as asked" in dict(whole.notes)["marked"]


def test_a_point_with_several_marks_is_counted_once(tmp_path):
    flags = {"withheld": np.arange(N) < 10, "classification": np.where(np.arange(N) < 30, 7, 0)}
    cloud = read(las(tmp_path / "a.laz", shell(), 6, **flags))
    assert len(cloud) == N - 30
    assert "10 withheld, 20 noise (class 7)" in dict(cloud.notes)["marked"]


def test_where_all_are_marked_the_way_out_is_said(tmp_path):
    path = las(tmp_path / "a.las", shell(), 6, synthetic=np.ones(N, np.uint8))
    with pytest.raises(ReadError, match=r"all but 0 of its 3,000 points are marked .* say --keep-marked"):
        read(path)
    assert len(read(path, keep_marked=True)) == N


@pytest.mark.parametrize("state", [1, 2])
def test_invalid_points_of_e57_stay_in_the_file(tmp_path, state):
    xyz = shell()
    marked = np.arange(N) % 5 == 0
    path = tmp_path / "a.e57"
    data = dict(zip(("cartesianX", "cartesianY", "cartesianZ"), xyz.T, strict=True))
    with pye57.E57(str(path), mode="w") as file:
        file.write_scan_raw(data | {"cartesianInvalidState": np.where(marked, state, 0).astype(np.int8)})
    cloud = read(path)
    np.testing.assert_allclose(cloud.xyz, xyz[~marked], atol=1e-5)
    write_labelled(path, tmp_path / "out.laz", cloud, {"component": np.full(len(cloud), 3, np.uint16)})
    found = laspy.read(tmp_path / "out.laz")
    np.testing.assert_allclose(found.xyz, xyz, atol=1e-4)
    np.testing.assert_array_equal(found["component"], np.where(marked, 0, 3))
    assert len(read(path, keep_marked=True)) == N


@pytest.mark.parametrize("suffix", [".las", ".laz", ".ply", ".e57", ".xyz"])
@pytest.mark.parametrize("shift", [0.0, 500_000.0])
@pytest.mark.parametrize(
    "far",
    [
        pytest.param([[0, 0, 0]], id="one zero"),
        pytest.param([[600, 10, 20], [610, 15, 2], [3, -700, 1]], id="through windows"),
        pytest.param([[0, 0, 9e5]], id="high"),
        pytest.param([[0, 0, 0]] * 900, id="many zeros"),
    ],
)
def test_specks_far_from_all_others_are_set_aside(tmp_path, suffix, shift, far):
    far = np.array(far, float)
    if not far.any():
        shift = shift or 2000.0
    else:
        far[:, :2] += shift
    xyz = shell() + [shift, shift, 0]
    mixed = np.concatenate([xyz[:1000], far, xyz[1000:]])
    path = tmp_path / f"a{suffix}"
    write_cloud(path, mixed)
    cloud = read(path)
    np.testing.assert_allclose(cloud.in_file(cloud.xyz), xyz, atol=1e-3)
    assert len(cloud.aside) == len(far)
    assert cloud.xyz.dtype == (np.float64 if shift == 2000 else np.float32)
    assert f"{len(far):,} point" in dict(cloud.notes)["specks"]
    write_labelled(path, tmp_path / "out.laz", cloud, {"component": np.full(len(cloud), 3, np.uint16)})
    found = laspy.read(tmp_path / "out.laz")
    np.testing.assert_allclose(found.xyz, mixed, atol=1e-3)
    assert (found["component"] == 0).sum() == len(far)


def test_chunks_make_no_difference(tmp_path, monkeypatch):
    xyz = np.concatenate([shell(), [[900.0, 0, 0]], shell(seed=1)])
    write_cloud(tmp_path / "a.ply", xyz)
    whole = read(tmp_path / "a.ply")
    monkeypatch.setattr("segmentation.io.ply.SIZE", 700)
    np.testing.assert_array_equal(read(tmp_path / "a.ply").xyz, whole.xyz)
    assert len(whole) == 2 * N


@pytest.mark.parametrize("gap", [3.0, 20.0, 200.0])
def test_another_room_is_no_speck(tmp_path, gap):
    other = shell(N // 4, seed=1) + [5 + gap, 0, 0]
    write_cloud(tmp_path / "a.ply", np.concatenate([shell(), other]))
    cloud = read(tmp_path / "a.ply")
    assert len(cloud) == N + N // 4
    assert cloud.aside is None


def test_a_long_thin_tail_is_no_speck(tmp_path):
    tail = np.column_stack([np.linspace(0, 120, 240), np.full((240, 2), 2.0)])
    write_cloud(tmp_path / "a.ply", np.concatenate([shell(20_000), tail]))
    assert read(tmp_path / "a.ply").aside is None


@pytest.mark.parametrize("up", ["y", "-x"])
def test_what_is_set_aside_is_turned_as_well(tmp_path, up):
    xyz = np.concatenate([shell(), [[900.0, 0, 0]]])
    write_cloud(tmp_path / "a.ply", xyz)
    cloud = read(tmp_path / "a.ply", up=up).whole()
    np.testing.assert_allclose(cloud.in_file(cloud.xyz), xyz, atol=1e-3)


@pytest.mark.parametrize(("place", "step"), [((500_000, 4_700_000), "0.5 m"), ((300_000, 200_000), "31 mm")])
def test_projected_coordinates_in_single_precision_are_refused(tmp_path, place, step):
    xyz = (shell() + [*place, 100]).astype(np.float32)
    write_cloud(tmp_path / "a.xyz", xyz)
    with pytest.raises(ReadError, match=f"single precision: near .* in steps of {step}"):
        read(tmp_path / "a.xyz")
    np.savetxt(tmp_path / "b.txt", xyz.astype(float), fmt="%.5f")
    with pytest.raises(ReadError, match="single precision"):
        read(tmp_path / "b.txt", columns="x,y,z")


@pytest.mark.parametrize("suffix", [".las", ".xyz"])
def test_single_precision_is_known_when_it_was_rounded_since(tmp_path, suffix):
    xyz = (shell() + [600_000, 200_000, 400]).astype(np.float32).astype(float)
    if suffix == ".las":
        header = laspy.LasHeader(version="1.2", point_format=1)
        header.scales, header.offsets = [1e-3] * 3, np.floor(xyz.min(axis=0))
        data = laspy.LasData(header)
        data.x, data.y, data.z = xyz.T
        data.write(tmp_path / "a.las")
    else:
        np.savetxt(tmp_path / "a.xyz", xyz, fmt="%.3f")
    with pytest.raises(ReadError, match=r"single precision: near .* in steps of 62 mm"):
        read(tmp_path / f"a{suffix}")


def test_points_set_aside_keep_their_colours(tmp_path):
    rng = np.random.default_rng(0)
    color = rng.integers(20_000, 60_000, (N, 3)).astype(np.uint16)
    color[:50] = rng.integers(0, 200, (50, 3))
    xyz = shell()
    red, green, blue = color.T
    classes = np.where(np.arange(N) < 50, 7, 0).astype(np.uint8)
    path = las(tmp_path / "a.las", xyz, 7, red=red, green=green, blue=blue, classification=classes)
    np.testing.assert_array_equal(read(path).whole().color, color)


@pytest.mark.parametrize("value", [1e300, -1e15, np.inf, np.nan])
@pytest.mark.parametrize("suffix", [".ply", ".xyz"])
def test_numbers_that_are_no_lengths_are_dropped(tmp_path, suffix, value):
    xyz = shell()
    xyz[[5, 70], [0, 2]] = value
    path = tmp_path / f"a{suffix}"
    if suffix == ".ply":
        write_cloud(path, xyz)
    else:
        np.savetxt(path, xyz)
    cloud = read(path)
    assert cloud.dropped == 2
    assert cloud.kept is not None
    assert np.flatnonzero(~cloud.kept).tolist() == [5, 70]


def test_an_origin_that_is_no_place(tmp_path):
    write_cloud(tmp_path / "a.laz", shell())
    for origin in ((0, np.nan, 0), (1.0, 2.0)):
        with pytest.raises(ValueError, match="is no place"):
            read(tmp_path / "a.laz", origin=origin)


def test_single_precision_that_costs_millimetres_is_said(tmp_path):
    write_cloud(tmp_path / "a.ply", (shell() + [90_000, 0, 0]).astype(np.float32))
    assert "in steps of 7.8 mm" in dict(read(tmp_path / "a.ply").notes)["precision"]


@pytest.mark.parametrize("shift", [(500_000, 4_700_000, 100), (499_998, 4_699_997, 15_000), (-20_300, 40, 0)])
def test_rooms_of_one_survey_share_their_origin(tmp_path, shift):
    origins = []
    for k, step in enumerate([(0, 0, 0), (7, 3, 4), (0, 25, -3)]):
        write_cloud(tmp_path / f"{k}.laz", shell() + np.array(shift) + step)
        cloud = read(tmp_path / f"{k}.laz")
        assert cloud.xyz.dtype == np.float32
        origins.append(cloud.origin.tolist())
        assert "whole kilometres" in dict(cloud.notes)["origin"]
    assert origins[0] == origins[1] == origins[2]


def test_the_user_says_the_origin(tmp_path):
    write_cloud(tmp_path / "a.laz", shell() + [500_000, 4_700_000, 100])
    cloud = read(tmp_path / "a.laz", origin=(499_900, 4_700_100, 95.5))
    np.testing.assert_array_equal(cloud.origin, [499_900, 4_700_100, 95.5])
    np.testing.assert_allclose(cloud.xyz, shell() + [100, -100, 4.5], atol=1e-3)
    with pytest.raises(ReadError, match=r"lies 4,700 km from --origin 0 0 0; .* as 500000 4700000 0"):
        read(tmp_path / "a.laz", origin=(0, 0, 0))


def test_no_grid_is_larger_than_its_points_deserve():
    from vaultcad.errors import NoVaultError
    from vaultcad.survey.bays import CeilingGrid

    class Cloud:
        xyz = np.concatenate([shell(), shell() + [9000, 8000, 0]])

        def __len__(self) -> int:
            return len(self.xyz)

    with pytest.raises(NoVaultError, match=r"scattered over .* crop the scan"):
        CeilingGrid.of(thin_scan(Cloud()))


@pytest.mark.parametrize("place", [1e12, 1e15, -1e16, 1e150])
def test_coordinates_that_are_no_place_on_earth_are_refused(tmp_path, place):
    """At 1e15 double precision has steps of 12 cm."""
    write_cloud(tmp_path / "a.ply", shell() + [place, 0, 0] - 2.5)
    with pytest.raises(ReadError, match=r"has coordinates up to 1e\+.*, which are no lengths on earth; .* a shift"):
        read(tmp_path / "a.ply")


@pytest.mark.parametrize("far", [1e9, 1e20, 1e300])
def test_a_few_points_that_are_nowhere_do_no_harm(tmp_path, far):
    xyz = shell()
    xyz[:5] = far * np.random.default_rng(0).normal(size=(5, 3))
    write_cloud(tmp_path / "a.ply", xyz)
    cloud = read(tmp_path / "a.ply")
    assert len(cloud) == len(xyz) - 5
    assert any(note.code in ("specks", "dropped") and note.text.startswith("5 points") for note in cloud.notes)
