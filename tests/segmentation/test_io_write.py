"""Writing: other libraries read what is written, and nothing half written stays."""

import laspy
import numpy as np
import pye57
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from segmentation import ReadError, read, write_cloud, write_labelled
from segmentation.io import WRITERS

ORIGIN = np.array([512_345.0, 4_712_345.0, 120.0])


def labels(n):
    rng = np.random.default_rng(9)
    deviation = rng.normal(size=n).astype(np.float32)
    deviation[::3] = np.nan
    return {"component": rng.integers(0, 9, n).astype(np.uint16), "deviation": deviation}


@pytest.mark.parametrize("suffix", sorted(WRITERS))
def test_what_is_written_is_read(tmp_path, clouds, suffix):
    path, xyz, more = tmp_path / f"a{suffix}", clouds.points(), clouds.attributes()
    write_cloud(path, xyz, origin=ORIGIN, **more, extra=labels(len(xyz)))
    cloud = read(path)
    np.testing.assert_allclose(cloud.in_file(cloud.xyz), xyz + ORIGIN, atol=1e-5)
    np.testing.assert_allclose(cloud.normals, more["normals"], atol=1e-5)
    np.testing.assert_array_equal(cloud.color, more["color"].astype(int) * 257)
    np.testing.assert_array_equal(cloud.intensity, more["intensity"])


@pytest.mark.parametrize("suffix", sorted(WRITERS))
def test_the_same_cloud_gives_the_same_bytes(tmp_path, clouds, suffix):
    xyz, more = clouds.points(), clouds.attributes()
    for name in "ab":
        (tmp_path / name).mkdir()
        write_cloud(tmp_path / name / f"x{suffix}", xyz, **more, extra=labels(len(xyz)))
    assert (tmp_path / "a" / f"x{suffix}").read_bytes() == (tmp_path / "b" / f"x{suffix}").read_bytes()


def test_las_for_laspy(tmp_path, clouds):
    xyz, more = clouds.points(), clouds.attributes()
    classes = (np.arange(len(xyz)) % 200).astype(np.uint8)
    extra = labels(len(xyz))
    write_cloud(tmp_path / "a.las", xyz, origin=ORIGIN, classification=classes, **more, extra=extra)
    las = laspy.read(tmp_path / "a.las")
    np.testing.assert_allclose(np.stack([las.x, las.y, las.z], axis=1), xyz + ORIGIN, atol=1e-6)
    np.testing.assert_array_equal(las.classification, classes)
    np.testing.assert_array_equal(las.intensity, more["intensity"])
    np.testing.assert_array_equal(las.red, more["color"][:, 0].astype(int) * 257)
    np.testing.assert_array_equal(las.component, extra["component"])
    np.testing.assert_array_equal(las.deviation, extra["deviation"])
    assert las["component"].dtype == np.uint16
    np.testing.assert_allclose(las.header.mins, (xyz + ORIGIN).min(0), atol=1e-6)


def test_ply_for_trimesh(tmp_path, clouds):
    xyz, more = clouds.points(), clouds.attributes()
    write_cloud(tmp_path / "a.ply", xyz, **more, extra=labels(len(xyz)))
    made = trimesh.load(tmp_path / "a.ply")
    np.testing.assert_allclose(made.vertices, xyz)
    np.testing.assert_array_equal(made.colors[:, :3], more["color"])


def test_ply_turns_what_it_has_no_type_for_into_doubles(tmp_path, clouds):
    write_cloud(tmp_path / "a.ply", clouds.points(), extra={"index": np.arange(5000)})
    made = trimesh.load(tmp_path / "a.ply")
    np.testing.assert_array_equal(made.metadata["_ply_raw"]["vertex"]["data"]["index"].ravel(), np.arange(5000.0))


def test_e57_for_pye57(tmp_path, clouds):
    xyz, more = clouds.points(), clouds.attributes()
    write_cloud(tmp_path / "a.e57", xyz, origin=ORIGIN, **more, extra=labels(len(xyz)) | {"big": np.arange(5000) << 40})
    with pye57.E57(str(tmp_path / "a.e57")) as file:
        data = file.read_scan(0, intensity=True, colors=True, ignore_missing_fields=True)
        fields = file.get_header(0).point_fields
    for k, axis in enumerate("XYZ"):
        np.testing.assert_allclose(data[f"cartesian{axis}"], xyz[:, k] + ORIGIN[k], atol=1e-9)
    np.testing.assert_array_equal(data["intensity"], more["intensity"])
    np.testing.assert_array_equal(data["colorGreen"], more["color"][:, 1])
    assert {"nor:normalX", "vaultcad:component", "vaultcad:deviation", "vaultcad:big"} <= set(fields)


@pytest.mark.parametrize(
    ("dtype", "step"), [(np.uint8, 1), (np.uint32, 800_000), (np.int64, 1 << 40), (np.float32, 0.5)]
)
def test_extras_of_e57(tmp_path, clouds, dtype, step):
    from pye57 import libe57

    values = (np.arange(200) * step).astype(dtype)
    write_cloud(tmp_path / "a.e57", clouds.points(200), extra={"label": values})
    image = libe57.ImageFile(str(tmp_path / "a.e57"), "r")
    found, buffers = np.empty(200), libe57.VectorSourceDestBuffer()
    buffers.append(libe57.SourceDestBuffer(image, "vaultcad:label", found, 200, True, True))
    reader = image.root()["data3D"][0]["points"].reader(buffers)
    assert reader.read() == 200
    reader.close()
    image.close()
    np.testing.assert_array_equal(found, values.astype(float))


@pytest.mark.parametrize("suffix", sorted(WRITERS))
def test_nothing_half_written_stays(tmp_path, clouds, suffix, monkeypatch):
    path = tmp_path / f"a{suffix}"
    path.write_text("what was there")
    writer = WRITERS[suffix]

    def broken(*args):
        writer(*args)
        raise OSError("no space left on device")

    monkeypatch.setitem(WRITERS, suffix, broken)
    with pytest.raises(OSError, match="no space"):
        write_cloud(path, clouds.points())
    assert [p.name for p in tmp_path.iterdir()] == [path.name]
    assert path.read_text() == "what was there"


@pytest.mark.parametrize(
    ("more", "match"),
    [
        ({"normals": np.zeros((9, 3))}, r"normals has the shape \(9, 3\)"),
        ({"color": np.zeros((5000, 4), np.uint8)}, "color has the shape"),
        ({"intensity": np.zeros(1, np.uint16)}, "intensity has the shape"),
        ({"extra": {"component": np.zeros((5000, 1))}}, "component has the shape"),
        ({"extra": {"intensity": np.zeros(5000)}}, "'intensity' is a dimension of LAS"),
        ({"extra": {"x" * 40: np.zeros(5000)}}, "longer than the 32 bytes"),
        ({"extra": {"label": np.zeros(5000, bool)}}, "'label' is of type bool"),
    ],
)
def test_what_cannot_be_written_is_named(tmp_path, clouds, more, match):
    with pytest.raises(ValueError, match=match):
        write_cloud(tmp_path / "a.laz", clouds.points(), **more)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("suffix", [".las", ".laz", ".e57"])
def test_nan_is_refused_where_the_format_cannot_hold_it(tmp_path, clouds, suffix):
    xyz = clouds.points()
    xyz[3] = np.nan
    with pytest.raises(ValueError, match="NaN"):
        write_cloud(tmp_path / f"a{suffix}", xyz)
    assert not list(tmp_path.iterdir())


def test_e57_refuses_names_that_are_none(tmp_path, clouds):
    with pytest.raises(ValueError, match="'a b' cannot name a field"):
        write_cloud(tmp_path / "a.e57", clouds.points(), extra={"a b": np.zeros(5000)})


def test_an_unknown_suffix_to_write(tmp_path, clouds):
    with pytest.raises(ValueError, match=r"unknown suffix '.docx'"):
        write_cloud(tmp_path / "a.docx", clouds.points())


def test_las_scales_grow_with_the_extent(tmp_path):
    xyz = np.array([[0.0, 0, 0], [1e6, 1, 1], [5e5, 2, 2], [1, 3, 3]])
    write_cloud(tmp_path / "a.las", xyz)
    np.testing.assert_allclose(read(tmp_path / "a.las").in_file(read(tmp_path / "a.las").xyz), xyz, atol=1e-3)


# A scan once more, with labels


def full_las(path, n=5000, version="1.4", fmt=7):
    rng = np.random.default_rng(10)
    header = laspy.LasHeader(version=version, point_format=fmt)
    header.scales, header.offsets = [0.001, 0.002, 0.0005], [500_000, 4_000_000, -100]
    header.add_extra_dims(
        [
            laspy.ExtraBytesParams("reflectance", np.float32, "dB"),
            laspy.ExtraBytesParams("angle", np.int16, offsets=[1.0], scales=[0.01]),
            laspy.ExtraBytesParams("component", np.int32),
        ]
    )
    header.vlrs.append(laspy.VLR("LASF_Projection", 2112, "a coordinate system", b"PROJCS[...]\0"))
    las = laspy.LasData(header)
    las.points = laspy.ScaleAwarePointRecord(
        np.frombuffer(rng.bytes(n * header.point_format.size), header.point_format.dtype()).copy(),
        header.point_format, header.scales, header.offsets,
    )  # fmt: skip
    for axis in "XYZ":
        las[axis] = rng.integers(0, 100_000, n)
    las["return_number"][:] = 1
    las["gps_time"] = np.arange(n) / 7
    las["reflectance"] = rng.normal(size=n)
    if version == "1.4":
        las.evlrs = laspy.vlrs.vlrlist.VLRList([laspy.VLR("ours", 7, "kept as well", b"evlr")])
    las.write(path)
    return laspy.read(path)


@pytest.mark.parametrize("suffix", [".las", ".laz"])
@pytest.mark.parametrize(("version", "fmt"), [("1.4", 7), ("1.4", 8), ("1.2", 3), ("1.3", 1)])
def test_a_las_scan_keeps_all_it_has(tmp_path, suffix, version, fmt, monkeypatch):
    monkeypatch.setattr("segmentation.io.las.SIZE", 999)
    path = tmp_path / f"scan{suffix}"
    scan = full_las(path, version=version, fmt=fmt)
    cloud, extra = read(path, unit="m", keep_marked=True), labels(len(scan))
    write_labelled(path, tmp_path / "segments.laz", cloud, extra)
    found = laspy.read(tmp_path / "segments.laz")
    for name in scan.points.array.dtype.names:
        if name != "component":
            assert found.points.array[name].tobytes() == scan.points.array[name].tobytes(), name
    assert set(found.point_format.dimension_names) == set(scan.point_format.dimension_names) | set(extra)
    np.testing.assert_array_equal(found["component"], extra["component"])
    np.testing.assert_array_equal(found["deviation"], extra["deviation"])
    assert found["component"].dtype == np.uint16
    np.testing.assert_array_equal(found["angle"], scan["angle"])
    assert found.point_format.dimension_by_name("reflectance").description == "dB"
    assert found.header.version == scan.header.version
    np.testing.assert_array_equal(found.header.scales, scan.header.scales)
    np.testing.assert_array_equal(found.header.offsets, scan.header.offsets)
    assert [v.record_data_bytes() for v in found.vlrs if v.user_id == "LASF_Projection"] == [b"PROJCS[...]\0"]
    if version == "1.4":
        assert [(v.user_id, v.record_data) for v in found.evlrs] == [("ours", b"evlr")]


def test_labels_of_labels_replace_them(tmp_path, clouds):
    path = clouds.sample(tmp_path, ".laz")
    cloud = read(path)
    first, second = {"component": np.full(5000, 1, np.uint16)}, {"component": np.full(5000, 2, np.uint16)}
    write_labelled(path, tmp_path / "a.laz", cloud, first)
    write_labelled(tmp_path / "a.laz", tmp_path / "a.laz", read(tmp_path / "a.laz"), second)
    found = laspy.read(tmp_path / "a.laz")
    assert (found.component == 2).all()
    assert list(found.point_format.extra_dimension_names).count("component") == 1


@pytest.mark.parametrize("up", ["z", "y"])
@pytest.mark.parametrize("suffix", [".ply", ".e57", ".xyz"])
def test_other_scans_become_laz(tmp_path, clouds, suffix, up):
    path, xyz, more = tmp_path / f"scan{suffix}", clouds.points(), clouds.attributes()
    write_cloud(path, xyz, origin=ORIGIN, **more)
    extra = labels(len(xyz))
    write_labelled(path, tmp_path / "segments.laz", read(path, up=up), extra)
    found = laspy.read(tmp_path / "segments.laz")
    np.testing.assert_allclose(np.stack([found.x, found.y, found.z], axis=1), xyz + ORIGIN, atol=1e-4)
    np.testing.assert_array_equal(found.component, extra["component"])
    np.testing.assert_array_equal(found.intensity, more["intensity"])
    np.testing.assert_array_equal(
        np.stack([found.red, found.green, found.blue], axis=1), more["color"].astype(int) * 257
    )
    np.testing.assert_allclose(
        np.stack([found.NormalX, found.NormalY, found.NormalZ], axis=1), more["normals"], atol=1e-5
    )


def test_dropped_points_of_other_scans_are_left_out(tmp_path, clouds):
    xyz = clouds.points()
    xyz[10:20] = np.nan
    write_cloud(tmp_path / "a.ply", xyz)
    cloud = read(tmp_path / "a.ply")
    write_labelled(tmp_path / "a.ply", tmp_path / "s.laz", cloud, {"component": np.arange(4990).astype(np.uint16)})
    found = laspy.read(tmp_path / "s.laz")
    np.testing.assert_array_equal(found.component, np.arange(4990))
    np.testing.assert_allclose(found.x, xyz[cloud.kept, 0], atol=1e-4)


def test_labels_of_another_length_are_refused(tmp_path, clouds):
    path = clouds.sample(tmp_path, ".laz")
    with pytest.raises(ValueError, match=r"component has the shape \(7,\)"):
        write_labelled(path, tmp_path / "s.laz", read(path), {"component": np.zeros(7, np.uint16)})
    assert not (tmp_path / "s.laz").exists()


def test_a_scan_that_has_changed_is_refused(tmp_path, clouds):
    path = clouds.sample(tmp_path, ".laz")
    cloud = read(path)
    clouds.sample(tmp_path, ".laz", 4000)
    with pytest.raises(ReadError, match="holds 4000 points, 5000 when it was read"):
        write_labelled(path, tmp_path / "s.laz", cloud, {})
    assert sorted(p.name for p in tmp_path.iterdir()) == ["scan.laz"]


@settings(max_examples=25, deadline=None)
@given(
    st.integers(1, 3000),
    st.sampled_from(sorted(WRITERS)),
    st.sampled_from([0.0, 1234.5, 512_345.678, 4_712_345.6789]),
    st.booleans(),
)
def test_round_trips(tmp_path_factory, n, suffix, shift, colored):
    rng = np.random.default_rng(n)
    xyz = rng.uniform(-20, 20, (n + 4, 3))
    color = rng.integers(0, 256, (n + 4, 3)).astype(np.uint8) if colored else None
    path = tmp_path_factory.mktemp("trip") / f"a{suffix}"
    write_cloud(path, xyz, origin=np.full(3, shift), color=color)
    cloud = read(path)
    assert np.abs(cloud.in_file(cloud.xyz) - xyz - shift).max() < 1e-4
    assert (cloud.color is None) == (color is None)
    if color is not None:
        np.testing.assert_array_equal(cloud.color, color.astype(int) * 257)
