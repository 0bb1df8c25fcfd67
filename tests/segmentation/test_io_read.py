"""Reading what other libraries, or hands, wrote."""

import laspy
import numpy as np
import pye57
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from pye57 import libe57

from segmentation import read, write_cloud

UTM = np.array([512_345.0, 4_712_345.0, 120.0])
XYZ = ("cartesianX", "cartesianY", "cartesianZ")


def las_of(path, xyz, **dimensions):
    las = laspy.create(point_format=3, file_version="1.2")
    las.header.scales, las.header.offsets = [1e-4] * 3, np.floor(xyz.min(0))
    las.x, las.y, las.z = xyz.T
    for name, values in dimensions.items():
        las[name] = values
    las.write(path)
    return path


@pytest.mark.parametrize("suffix", [".las", ".laz"])
def test_las_by_laspy(tmp_path, clouds, suffix):
    xyz, n = clouds.points(), len(clouds.points())
    rng = np.random.default_rng(2)
    rgb = rng.integers(0, 65536, (n, 3)).astype(np.uint16)
    intensity, classes = rng.integers(0, 65536, n).astype(np.uint16), rng.integers(0, 32, n).astype(np.uint8)
    red, green, blue = rgb.T
    names = {"red": red, "green": green, "blue": blue, "intensity": intensity, "classification": classes}
    cloud = read(las_of(tmp_path / f"a{suffix}", xyz, **names), keep_marked=True)
    np.testing.assert_allclose(cloud.xyz, xyz, atol=1e-6)
    np.testing.assert_array_equal(cloud.color, rgb)
    np.testing.assert_array_equal(cloud.intensity, intensity)
    np.testing.assert_array_equal(cloud.classification, classes)
    assert cloud.xyz.dtype == np.float32
    assert (cloud.origin == 0).all()
    assert cloud.source == tmp_path / f"a{suffix}"
    assert (cloud.normals, cloud.kept, cloud.dropped, len(cloud.stations)) == (None, None, 0, 0)


def test_las_with_eight_bits_of_colour_in_sixteen(tmp_path, clouds):
    grey = np.arange(5000) % 256
    cloud = read(las_of(tmp_path / "a.las", clouds.points(), red=grey, green=grey, blue=grey))
    np.testing.assert_array_equal(cloud.color[:, 0], grey * 257)


@pytest.mark.parametrize("suffix", [".laz", ".ply", ".e57", ".xyz"])
def test_projected_coordinates_are_shifted_by_whole_kilometres(tmp_path, clouds, suffix):
    xyz = clouds.points() + UTM
    path = tmp_path / f"a{suffix}"
    write_cloud(path, clouds.points(), origin=UTM)
    cloud = read(path)
    assert cloud.xyz.dtype == np.float32
    np.testing.assert_array_equal(cloud.origin, [512_000, 4_712_000, 0])
    np.testing.assert_allclose(cloud.in_file(cloud.xyz), xyz, atol=1e-5)


@pytest.mark.parametrize(("size", "dtype"), [(700, np.float32), (1000, np.float64), (9999, np.float64)])
def test_double_precision_where_single_would_round(tmp_path, size, dtype):
    xyz = np.random.default_rng(3).uniform(0, size, (1000, 3))
    xyz[0] = size
    write_cloud(tmp_path / "a.ply", xyz)
    cloud = read(tmp_path / "a.ply", unit="m")
    assert cloud.xyz.dtype == dtype
    assert (cloud.origin == 0).all()
    assert np.abs(cloud.xyz - xyz).max() < 1e-4


@settings(max_examples=30, deadline=None)
@given(
    arrays(np.float64, st.tuples(st.integers(4, 50), st.just(3)), elements=st.floats(-1e7, 1e7)),
    st.sampled_from(["y", "z"]),
)
def test_coordinates_come_back_within_a_tenth_of_a_millimetre(tmp_path_factory, xyz, up):
    path = tmp_path_factory.mktemp("ply") / "a.ply"
    write_cloud(path, xyz)
    cloud = read(path, up=up)
    assert np.abs(cloud.in_file(cloud.xyz) - xyz).max() < 1e-4
    assert (cloud.origin % 1000 == 0).all()
    if np.abs(xyz).max() <= 10_000:
        assert (cloud.origin == 0).all()


@pytest.mark.parametrize("suffix", [".laz", ".ply", ".e57", ".xyz"])
def test_y_up_files_are_turned(tmp_path, clouds, suffix):
    xyz, path = clouds.points(), tmp_path / f"a{suffix}"
    normals = clouds.attributes()["normals"]
    write_cloud(path, xyz, normals=normals)
    cloud = read(path, up="y")
    x, y, z = xyz.T
    np.testing.assert_allclose(cloud.xyz, np.stack([x, -z, y], axis=1), atol=1e-5)
    np.testing.assert_allclose(cloud.normals, normals[:, [0, 2, 1]] * [1, -1, 1], atol=1e-5)
    np.testing.assert_allclose(cloud.in_file(cloud.xyz), xyz, atol=1e-5)
    assert cloud.up == "y"


@pytest.mark.parametrize("suffix", [".ply", ".xyz"])
def test_points_that_are_not_finite_are_dropped_and_can_be_mapped_back(tmp_path, clouds, suffix):
    xyz, more = clouds.points(), clouds.attributes()
    gone = np.zeros(len(xyz), bool)
    gone[[0, 17, 4999]] = True
    xyz[0, 1], xyz[17], xyz[4999, 2] = np.nan, np.inf, -np.inf
    path = tmp_path / f"a{suffix}"
    write_cloud(path, xyz, **more)
    cloud = read(path)
    assert cloud.dropped == 3
    np.testing.assert_array_equal(cloud.kept, ~gone)
    np.testing.assert_allclose(cloud.xyz, xyz[~gone], atol=1e-5)
    np.testing.assert_array_equal(cloud.intensity, more["intensity"][~gone])


def test_ply_by_trimesh_with_colours(tmp_path, clouds):
    rgb = clouds.attributes()["color"]
    trimesh.PointCloud(clouds.points(), colors=rgb).export(tmp_path / "a.ply")
    cloud = read(tmp_path / "a.ply")
    np.testing.assert_allclose(cloud.xyz, clouds.points(), atol=1e-5)
    np.testing.assert_array_equal(cloud.color, rgb.astype(int) * 257)


@pytest.mark.parametrize("encoding", ["ascii", "binary"])
def test_a_mesh_gives_its_vertices(tmp_path, encoding):
    mesh = trimesh.creation.icosphere(subdivisions=3)
    mesh.export(tmp_path / "a.ply", encoding=encoding)
    cloud = read(tmp_path / "a.ply")
    np.testing.assert_allclose(cloud.xyz, mesh.vertices, atol=1e-6)


def test_ply_of_any_properties_in_big_endian_after_another_element(tmp_path):
    dtype = np.dtype(
        [("a", ">i2"), ("z", ">f8"), ("x", ">f8"), ("y", ">f8"), ("nx", ">f4"), ("ny", ">f4"), ("nz", ">f4")]
    )
    values = np.zeros(10, dtype)
    values["x"], values["y"], values["z"], values["nz"] = np.arange(10), 2, 3, 1
    names = {"i2": "short", "f8": "double", "f4": "float"}
    properties = "".join(f"property {names[dtype[n].str[1:]]} {n}\n" for n in dtype.names)
    header = (
        "ply\r\nformat binary_big_endian 1.0\r\ncomment element vertex 3\r\nelement camera 2\r\nproperty uchar id\r\n"
        f"element vertex 10\n{properties}element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    )
    (tmp_path / "a.ply").write_bytes(header.encode() + b"\1\2" + values.tobytes() + b"\3" + bytes(12))
    cloud = read(tmp_path / "a.ply")
    np.testing.assert_array_equal(cloud.xyz, np.stack([np.arange(10), np.full(10, 2), np.full(10, 3)], axis=1))
    np.testing.assert_array_equal(cloud.normals, np.tile([0, 0, 1], (10, 1)))


@pytest.mark.parametrize("kind", ["ascii", "binary", "compressed"])
def test_pcd_by_open3d(tmp_path, clouds, kind):
    open3d = pytest.importorskip("open3d", exc_type=ImportError)
    xyz, more = clouds.points(), clouds.attributes()
    made = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(xyz))
    made.colors = open3d.utility.Vector3dVector(more["color"] / 255)
    made.normals = open3d.utility.Vector3dVector(more["normals"].astype(float))
    path = str(tmp_path / "a.pcd")
    assert open3d.io.write_point_cloud(path, made, write_ascii=kind == "ascii", compressed=kind == "compressed")
    cloud = read(path)
    np.testing.assert_allclose(cloud.xyz, xyz, atol=1e-5)
    np.testing.assert_allclose(cloud.normals, more["normals"], atol=1e-5)
    np.testing.assert_array_equal(cloud.color, more["color"].astype(int) * 257)


def test_lzf_copies_what_overlaps():
    from segmentation.io.lzf import unpack

    plain = np.zeros(20, np.uint8)
    # "abc", then 3 bytes back for 7 + 2 + 2 = 11 bytes, then "xyz"
    packed = np.frombuffer(b"\x02abc" + bytes([7 << 5, 2, 2]) + b"\x02xyz", np.uint8)
    assert unpack(packed, plain) == 17
    assert plain[:17].tobytes() == b"abcabcabcabcabxyz"
    assert unpack(packed[:2], plain) == -1
    assert unpack(np.frombuffer(b"\x20\x05", np.uint8), plain) == -1
    assert unpack(packed, plain[:5]) == -1


def test_pcd_with_padding_arrays_and_a_viewpoint(tmp_path):
    dtype = np.dtype([("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("_", "u1", (4,)), ("f", "<f4", (3,)), ("i", "<f4")])
    values = np.zeros(8, dtype)
    values["x"], values["i"] = np.arange(8), np.linspace(0, 1, 8)
    header = (
        "VERSION 0.7\nFIELDS x y z _ f intensity\nSIZE 4 4 4 1 4 4\nTYPE F F F U F F\nCOUNT 1 1 1 4 3 1\nWIDTH 4\n"
        "HEIGHT 2\nVIEWPOINT 1 2 3 1 0 0 0\nPOINTS 8\nDATA binary\n"
    )
    (tmp_path / "a.pcd").write_bytes(header.encode() + values.tobytes())
    cloud = read(tmp_path / "a.pcd")
    np.testing.assert_array_equal(cloud.xyz[:, 0], np.arange(8))
    np.testing.assert_array_equal(cloud.intensity, np.round(np.linspace(0, 65535, 8)))
    np.testing.assert_array_equal(cloud.stations, [[1, 2, 3]])


def test_e57_of_two_scans_by_pye57(tmp_path, clouds):
    xyz, more = clouds.points(), clouds.attributes()
    quarter = [np.sqrt(0.5), 0, 0, np.sqrt(0.5)]  # about +Z
    path = tmp_path / "a.e57"
    state = (np.arange(len(xyz)) % 10 == 3).astype(np.int8)
    data = dict(zip(XYZ, xyz.T, strict=True))
    data |= {"intensity": more["intensity"].astype(np.float32), "cartesianInvalidState": state}
    data |= dict(zip(("colorRed", "colorGreen", "colorBlue"), more["color"].T, strict=True))
    with pye57.E57(str(path), mode="w") as file:
        file.write_scan_raw(data, rotation=np.array([1.0, 0, 0, 0]), translation=np.array([0.0, 0, 0]))
        file.write_scan_raw(data, rotation=np.array(quarter), translation=np.array([10.0, 20, 30]))
    cloud = read(path)
    one = xyz[state == 0]
    two = np.stack([10 - one[:, 1], 20 + one[:, 0], 30 + one[:, 2]], axis=1)
    np.testing.assert_allclose(cloud.xyz, np.concatenate([one, two]), atol=1e-5)
    np.testing.assert_allclose(cloud.stations, [[0, 0, 0], [10, 20, 30]])
    np.testing.assert_array_equal(cloud.color, np.tile(more["color"][state == 0].astype(int) * 257, (2, 1)))
    assert cloud.intensity[: len(one)].max() == 65535
    assert cloud.dropped == 0
    assert len(cloud.aside) == 2 * state.sum()
    np.testing.assert_array_equal(cloud.kept, np.tile(state == 0, 2))


def test_e57_agrees_with_pye57(tmp_path, clouds):
    path = tmp_path / "a.e57"
    rotation = np.array([0.5, -0.5, 0.5, 0.5])
    with pye57.E57(str(path), mode="w") as file:
        file.write_scan_raw(
            dict(zip(XYZ, clouds.points().T, strict=True)), rotation=rotation, translation=np.array([3e5, 4e6, 50])
        )
    with pye57.E57(str(path)) as file:
        data = file.read_scan(0, ignore_missing_fields=True)
        theirs = np.stack([data[name] for name in XYZ], axis=1)
    cloud = read(path)
    np.testing.assert_allclose(cloud.in_file(cloud.xyz), theirs, atol=1e-5)
    np.testing.assert_allclose(cloud.stations + cloud.origin, [[3e5, 4e6, 50]])


def test_a_lone_e57_scan_with_the_identity_as_pose_tells_no_station(tmp_path, clouds):
    with pye57.E57(str(tmp_path / "a.e57"), mode="w") as file:
        file.write_scan_raw(dict(zip(XYZ, clouds.points().T, strict=True)))
    assert read(tmp_path / "a.e57").stations.shape == (0, 3)


def test_e57_in_spherical_coordinates(tmp_path):
    rng = np.random.default_rng(5)
    spherical = {
        "sphericalRange": rng.uniform(1, 9, 100),
        "sphericalAzimuth": rng.uniform(-np.pi, np.pi, 100),
        "sphericalElevation": rng.uniform(-1.5, 1.5, 100),
    }
    image = libe57.ImageFile(str(tmp_path / "a.e57"), "w")
    image.extensionsAdd("", libe57.E57_V1_0_URI)
    scan, prototype = libe57.StructureNode(image), libe57.StructureNode(image)
    buffers = libe57.VectorSourceDestBuffer()
    for name, values in spherical.items():
        prototype.set(name, libe57.FloatNode(image, 0.0))
        buffers.append(libe57.SourceDestBuffer(image, name, values, 100, True, True))
    data = libe57.VectorNode(image, True)
    image.root().set("data3D", data)
    points = libe57.CompressedVectorNode(image, prototype, libe57.VectorNode(image, True))
    scan.set("points", points)
    data.append(scan)
    writer = points.writer(buffers)
    writer.write(100)
    writer.close()
    image.close()
    r, azimuth, elevation = spherical.values()
    cloud = read(tmp_path / "a.e57")
    np.testing.assert_allclose(np.linalg.norm(cloud.xyz, axis=1), r, rtol=1e-5)
    np.testing.assert_allclose(np.arctan2(cloud.xyz[:, 1], cloud.xyz[:, 0]), azimuth, atol=1e-5)
    np.testing.assert_allclose(np.arcsin(cloud.xyz[:, 2] / r), elevation, atol=1e-3)


def test_progress_rises_to_one(tmp_path, clouds, monkeypatch):
    monkeypatch.setattr("segmentation.io.las.SIZE", 1000)
    shares = []
    read(clouds.sample(tmp_path, ".laz"), progress=shares.append)
    assert len(shares) == 5
    assert shares == sorted(shares)
    assert shares[-1] == 1


@pytest.mark.parametrize("suffix", [".e57", ".las", ".laz", ".ply", ".pcd"])
def test_chunks_make_no_difference(tmp_path, clouds, suffix, monkeypatch):
    path = clouds.sample(tmp_path, suffix)
    whole = read(path)
    for module in ("e57", "las", "pcd", "ply"):
        monkeypatch.setattr(f"segmentation.io.{module}.SIZE", 777)
    pieces = read(path)
    for name in ("xyz", "normals", "color", "intensity", "classification", "stations"):
        a, b = getattr(whole, name), getattr(pieces, name)
        assert (a is None and b is None) or (a.dtype == b.dtype and a.tobytes() == b.tobytes())
