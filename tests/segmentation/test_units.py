"""Lengths are metres, whatever unit a file is in: stated, said by the user, or assumed if rooms can have that size."""

from ctypes import c_double

import laspy
import numpy as np
import pytest
from laspy.vlrs.known import GeoDoubleParamsVlr, GeoKeyDirectoryVlr, GeoKeyEntryStruct, WktCoordinateSystemVlr
from pye57 import libe57
from pyproj import CRS

from segmentation import ReadError, read, write_cloud
from segmentation.crs import of_geokeys, of_wkt
from segmentation.units import UNITS, unit_named, unit_said

FT_US = UNITS["ftUS"]
CODES = {"m": 9001, "ft": 9002, "ftUS": 9003}
EPSG = {"m": 32633, "ft": 2222, "ftUS": 2263}  # projected systems in these units
SHELL = 4000


def room(n=SHELL, size=(5.0, 6.0, 4.0)):
    """Points on the six faces of a box [m]."""
    rng = np.random.default_rng(0)
    xyz = rng.uniform(0, 1, (n, 3))
    face = rng.integers(0, 6, n)
    xyz[np.arange(n), face // 2] = face % 2
    return xyz * size


def las(path, xyz, *, wkt=None, keys=None, doubles=None, version="1.4"):
    header = laspy.LasHeader(version=version, point_format=6 if version == "1.4" else 1)
    header.scales, header.offsets = [1e-4] * 3, np.floor(xyz.min(axis=0))
    if wkt is not None:
        header.vlrs.append(WktCoordinateSystemVlr(wkt))
        header.global_encoding.wkt = True
    if keys is not None:
        directory = GeoKeyDirectoryVlr()
        directory.geo_keys = [GeoKeyEntryStruct(*key) for key in keys]
        directory.geo_keys_header.number_of_keys = len(keys)
        header.vlrs.append(directory)
    if doubles is not None:
        record = GeoDoubleParamsVlr()
        record.doubles = [c_double(v) for v in doubles]
        header.vlrs.append(record)
    data = laspy.LasData(header)
    data.x, data.y, data.z = xyz.T
    data.write(path)
    return path


def size_of(cloud):
    return np.ptp(cloud.xyz, axis=0)


def notes(cloud):
    return dict(cloud.notes)


@pytest.mark.parametrize("suffix", [".las", ".laz"])
@pytest.mark.parametrize("unit", list(EPSG))
@pytest.mark.parametrize("version", ["WKT1_GDAL", "WKT2_2019"])
def test_a_wkt_of_las_states_the_unit(tmp_path, unit, version, suffix):
    path = las(tmp_path / f"a{suffix}", room() / UNITS[unit] + 300_000, wkt=CRS.from_epsg(EPSG[unit]).to_wkt(version))
    cloud = read(path)
    np.testing.assert_allclose(size_of(cloud), [5, 6, 4], atol=1e-3)
    np.testing.assert_allclose(cloud.in_file(cloud.xyz), room() / UNITS[unit] + 300_000, atol=1e-3)
    assert cloud.crs is not None
    assert cloud.crs.epsg == EPSG[unit]
    assert f"EPSG:{EPSG[unit]}" in notes(cloud)["unit"]


@pytest.mark.parametrize(
    ("keys", "doubles", "factor"),
    [
        ([(1024, 0, 1, 1), (3072, 0, 1, 2260), (3076, 0, 1, 9003)], None, FT_US),
        ([(1024, 0, 1, 1), (3072, 0, 1, 2260)], None, FT_US),
        ([(1024, 0, 1, 1), (3072, 0, 1, 2222)], None, 0.3048),
        ([(1024, 0, 1, 1), (3072, 0, 1, 32767), (3076, 0, 1, 9002)], None, 0.3048),
        ([(1024, 0, 1, 1), (3072, 0, 1, 32633), (3076, 0, 1, 9001)], None, 1.0),
        ([(1024, 0, 1, 1), (3076, 0, 1, 32767), (3077, 34736, 1, 0)], [0.01], 0.01),
        ([(3076, 0, 1, 9003)], None, FT_US),
        ([(4099, 0, 1, 9002)], None, 0.3048),
    ],
)
def test_geotiff_keys_of_las_state_the_unit(tmp_path, keys, doubles, factor):
    path = las(tmp_path / "a.laz", room() / factor, keys=keys, doubles=doubles, version="1.2")
    np.testing.assert_allclose(size_of(read(path)), [5, 6, 4], atol=1e-3)


def test_heights_may_be_in_another_unit(tmp_path):
    xyz = room() / [FT_US, FT_US, 1]
    for k, system in enumerate(["EPSG:2263+5703", "EPSG:2263+6360"]):
        wkt = CRS.from_user_input(system).to_wkt()
        heights = xyz if k == 0 else room() / FT_US
        cloud = read(las(tmp_path / f"{k}.las", heights, wkt=wkt))
        np.testing.assert_allclose(size_of(cloud), [5, 6, 4], atol=1e-3)
        np.testing.assert_allclose(cloud.in_file(cloud.xyz), heights, atol=1e-3)
    keys = [(1024, 0, 1, 1), (3072, 0, 1, 2263), (4099, 0, 1, 9001)]
    np.testing.assert_allclose(size_of(read(las(tmp_path / "k.las", xyz, keys=keys))), [5, 6, 4], atol=1e-3)


@pytest.mark.parametrize("unit", ["ft", "ftUS"])
def test_the_metadata_of_e57_state_the_unit(tmp_path, unit):
    write_cloud(tmp_path / "a.e57", room() / UNITS[unit])
    stated = e57_with_metadata(tmp_path / "b.e57", room() / UNITS[unit], CRS.from_epsg(EPSG[unit]).to_wkt())
    np.testing.assert_allclose(size_of(read(stated)), [5, 6, 4], atol=1e-3)
    plain = read(tmp_path / "a.e57")
    np.testing.assert_allclose(size_of(plain), np.array([5, 6, 4]) / UNITS[unit], atol=1e-3)
    assert "as E57 prescribes" in notes(plain)["unit-assumed"]


def e57_with_metadata(path, xyz, text):
    """What write_cloud makes, with another text for the coordinate system."""
    image = libe57.ImageFile(str(path), "w")
    root = image.root()
    for name, value in {"formatName": "ASTM E57 3D Imaging Data File", "guid": "{1}"}.items():
        root.set(name, libe57.StringNode(image, value))
    root.set("versionMajor", libe57.IntegerNode(image, 1))
    root.set("versionMinor", libe57.IntegerNode(image, 0))
    root.set("coordinateMetadata", libe57.StringNode(image, text))
    scans, scan, prototype = libe57.VectorNode(image, True), libe57.StructureNode(image), libe57.StructureNode(image)
    root.set("data3D", scans)
    root.set("images2D", libe57.VectorNode(image, True))
    buffers = libe57.VectorSourceDestBuffer()
    arrays = {f"cartesian{a}": np.ascontiguousarray(xyz[:, k]) for k, a in enumerate("XYZ")}
    for name, array in arrays.items():
        prototype.set(name, libe57.FloatNode(image, 0.0, libe57.E57_DOUBLE))
        buffers.append(libe57.SourceDestBuffer(image, name, array, len(array), True, True))
    points = libe57.CompressedVectorNode(image, prototype, libe57.VectorNode(image, True))
    scan.set("guid", libe57.StringNode(image, "{2}"))
    scan.set("points", points)
    scans.append(scan)
    writer = points.writer(buffers)
    writer.write(len(xyz))
    writer.close()
    image.close()
    return path


HEADS = {
    ".ply": "ply\nformat ascii 1.0\n{comment}element vertex {n}\nproperty double x\nproperty double y\n"
    "property double z\nend_header\n",
    ".pcd": "# .PCD v0.7\n{comment}VERSION 0.7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nWIDTH {n}\nHEIGHT 1\n"
    "POINTS {n}\nDATA ascii\n",
    ".xyz": "{comment}",
}


@pytest.mark.parametrize("unit", list(UNITS))
@pytest.mark.parametrize(
    ("suffix", "comment"),
    [
        (".ply", "comment units: {}\n"),
        (".ply", "obj_info unit = {}\n"),
        (".pcd", "# units: {}\n"),
        (".xyz", "# unit: {}\n"),
        (".xyz", "//x [{0}] y [{0}] z [{0}]\n"),
        (".xyz", "X({0}) Y({0}) Z({0})\n"),
        (".xyz", "x_{0} y_{0} z_{0}\n"),
        (".xyz", "x y z\n[{0}] [{0}] [{0}]\n"),
    ],
)
def test_a_header_states_the_unit(tmp_path, suffix, comment, unit):
    path = tmp_path / f"a{suffix}"
    xyz = room() / UNITS[unit]
    head = HEADS[suffix].format(comment=comment.format(unit), n=len(xyz))
    path.write_text(head + "\n".join(" ".join(f"{v:.6f}" for v in row) for row in xyz) + "\n")
    cloud = read(path)
    np.testing.assert_allclose(size_of(cloud), [5, 6, 4], atol=1e-3)
    assert "its header" in notes(cloud)["unit"]


@pytest.mark.parametrize("suffix", [".las", ".laz", ".ply", ".e57", ".xyz", ".txt"])
@pytest.mark.parametrize("unit", list(UNITS))
def test_the_user_says_the_unit(tmp_path, suffix, unit):
    path = tmp_path / f"a{suffix}"
    write_cloud(path, room() / UNITS[unit])
    cloud = read(path, unit=unit)
    np.testing.assert_allclose(size_of(cloud), [5, 6, 4], atol=1e-2)
    assert "as asked" in notes(cloud)["unit"]
    np.testing.assert_allclose(cloud.in_file(cloud.xyz), room() / UNITS[unit], atol=2e-2 / UNITS[unit] * 0.01)


def test_the_user_knows_better_than_the_file(tmp_path):
    path = las(tmp_path / "a.las", room(), wkt=CRS.from_epsg(2263).to_wkt())
    cloud = read(path, unit="m")
    np.testing.assert_allclose(size_of(cloud), [5, 6, 4], atol=1e-3)
    assert "though US survey foot is stated" in notes(cloud)["unit"]


@pytest.mark.parametrize("suffix", [".las", ".laz", ".ply", ".e57", ".xyz"])
@pytest.mark.parametrize("unit", ["mm", "cm", "in"])
def test_no_room_has_that_size_in_metres(tmp_path, suffix, unit):
    path = tmp_path / f"a{suffix}"
    write_cloud(path, room() / UNITS[unit])
    with pytest.raises(ReadError, match=rf"in metres, .* would be .* say --unit .*\b{unit} for 5.0 × 6.0 × 4.0 m"):
        read(path)


def test_a_scan_that_is_millimetres_large_is_none(tmp_path):
    write_cloud(tmp_path / "a.ply", room() / 1000)
    with pytest.raises(ReadError, match=r"would be 0.005 × 0.006 × 0.004 m small; say --unit"):
        read(tmp_path / "a.ply")


@pytest.mark.parametrize("apart", [(5000, 0, 0), (3000, 4000, 0), (0, 0, 300), (1e5, 0, 0)])
def test_two_rooms_far_apart_are_no_scan_of_one_building(tmp_path, apart):
    write_cloud(tmp_path / "a.ply", np.concatenate([room(), room() + apart]))
    with pytest.raises(ReadError, match=r"is of parts [0-9,]+ m apart; crop it to one building"):
        read(tmp_path / "a.ply")


@pytest.mark.parametrize("size", [1e-300, 1e-8])
def test_a_scan_of_no_size_is_none(tmp_path, size):
    write_cloud(tmp_path / "a.ply", size * room())
    with pytest.raises(ReadError, match="m small"):
        read(tmp_path / "a.ply")


def test_a_large_building_is_no_room_in_centimetres(tmp_path):
    write_cloud(tmp_path / "a.ply", room(60_000, (130.0, 64.0, 48.0)))
    assert "metre" in notes(read(tmp_path / "a.ply"))["unit-assumed"]


@pytest.mark.parametrize("system", ["EPSG:4326", "EPSG:4258", "EPSG:4326+5773", "EPSG:4979"])
def test_longitude_and_latitude_are_refused_by_name(tmp_path, system):
    degrees = room() * [1e-5, 1e-5, 1] + [13, 43, 100]
    path = las(tmp_path / "a.laz", degrees, wkt=CRS.from_user_input(system).to_wkt())
    with pytest.raises(ReadError, match="longitude and latitude in degrees"):
        read(path)


def test_other_ways_to_have_degrees(tmp_path):
    degrees = room() * [1e-5, 1e-5, 1] + [13, 43, 100]
    with pytest.raises(ReadError, match="longitude and latitude in degrees"):
        read(las(tmp_path / "a.las", degrees, keys=[(1024, 0, 1, 2), (2048, 0, 1, 4326)]))
    rows = "\n".join(",".join(f"{v:.9f}" for v in row) for row in degrees) + "\n"
    for k, head in enumerate(["Longitude,Latitude,Height\n", "lon,lat,h\n", "Länge;Breite;Höhe\n".replace(";", ",")]):
        (tmp_path / f"{k}.csv").write_text(head + rows)
        with pytest.raises(ReadError, match="longitude and latitude"):
            read(tmp_path / f"{k}.csv")
    (tmp_path / "bare.csv").write_text(rows)
    with pytest.raises(ReadError, match="look like longitude and latitude"):
        read(tmp_path / "bare.csv")


def test_geocentric_coordinates_have_no_axis_up(tmp_path):
    xyz = room() + np.array([4_000_000, 1_000_000, 4_800_000])
    with pytest.raises(ReadError, match="geocentric, with no axis up"):
        read(las(tmp_path / "a.las", xyz, wkt=CRS.from_epsg(4978).to_wkt()))


def test_a_system_that_cannot_be_read_is_said(tmp_path):
    cloud = read(las(tmp_path / "a.las", room(), wkt="nonsense"))
    assert "cannot be read" in notes(cloud)["crs"]
    assert cloud.crs is None


def test_a_damaged_wkt_still_states_its_unit():
    found = of_wkt('PROJCS["grid",GEOGCS["x",UNIT["degree",0.0174]],UNIT["US survey foot",0.3048006096012192]')
    assert found is not None
    assert (found.unit, found.kind) == (pytest.approx(FT_US), "projected")
    assert of_wkt("") is None
    assert of_geokeys({}) is None


@pytest.mark.parametrize(
    ("text", "unit"),
    [("[mm]", "mm"), ("Feet", "ft"), ("U.S. survey feet", "ftUS"), ("Zoll", "in"), ("Meter", "m"), ("furlong", None)],
)
def test_units_by_their_names(text, unit):
    assert unit_named(text) == unit
    assert unit_said(f"units: {text}") == unit


def test_an_unknown_unit_is_refused(tmp_path):
    write_cloud(tmp_path / "a.ply", room())
    with pytest.raises(ValueError, match="unit = 'furlong' is not one of m, cm"):
        read(tmp_path / "a.ply", unit="furlong")


@pytest.mark.parametrize(
    ("line", "unit"),
    [
        ("# Units: in metres", "m"), ("# Units in feet", "ft"), ("# Unit: in", "in"), ("# Unit in", "in"),
        ("# Units = US survey ft", "ftUS"), ("# Einheit: Fuß", "ft"), ("# Unità: piedi", "ft"),
        ("# Unité : pied", "ft"),
        ("# unit_of_length: ft", "ft"), ("# lengthUnit=ft", "ft"), ("# Unit: 1 ft", "ft"),
        ("# Unit system: feet", "ft"),
        ("# Intensity units: in dB", None), ("# angular unit: degree", None), ("# tested in unit 3", None),
    ],
)  # fmt: skip
def test_lines_that_state_a_unit(line, unit):
    assert unit_said(line) == unit


@pytest.mark.parametrize("unit", ["US survey ft", "survey ft", "int. ft", "usSurveyFoot", "ft NAVD88"])
def test_feet_by_other_names(tmp_path, unit):
    factor = 0.3048 if unit in ("int. ft", "ft NAVD88") else FT_US
    np.savetxt(
        tmp_path / "a.csv", room() / factor, "%.5f", ",", header=",".join(f"{a} ({unit})" for a in "XYZ"), comments=""
    )
    np.testing.assert_allclose(size_of(read(tmp_path / "a.csv")), [5, 6, 4], atol=1e-3)


@pytest.mark.parametrize("unit", ["dm", "km", "yd", "varas"])
def test_units_that_nobody_knows_are_no_metres(tmp_path, unit):
    np.savetxt(tmp_path / "a.csv", room(), "%.5f", ",", header=",".join(f"{a} [{unit}]" for a in "XYZ"), comments="")
    with pytest.raises(ReadError, match="a unit that is not known"):
        read(tmp_path / "a.csv")


@pytest.mark.parametrize("units", ["-;ft;ft;ft", ";[ft];[ft];[ft]", "ft;ft;ft"])
def test_a_line_of_units_with_gaps(tmp_path, units):
    rows = "\n".join(f"{k};" + ";".join(f"{v:.5f}" for v in row) for k, row in enumerate(room() / 0.3048))
    (tmp_path / "a.csv").write_text(f"Nr;X;Y;Z\n{units}\n{rows}\n")
    np.testing.assert_allclose(size_of(read(tmp_path / "a.csv")), [5, 6, 4], atol=1e-3)


def test_a_unit_goes_before_that_of_a_code(tmp_path):
    for k, head in enumerate(["# units: mm\n# EPSG:25832\n", "# EPSG:25832\n# units: mm\n"]):
        rows = "\n".join(" ".join(f"{v:.3f}" for v in row) for row in 1000 * room())
        (tmp_path / f"{k}.xyz").write_text(head + rows + "\n")
        cloud = read(tmp_path / f"{k}.xyz")
        np.testing.assert_allclose(size_of(cloud), [5, 6, 4], atol=1e-2)
        assert cloud.crs.epsg == 25832


def test_other_ways_to_name_a_system():
    for text, epsg in (("EPSG:2263", 2263), ("urn:ogc:def:crs:EPSG::25832", 25832)):
        assert of_wkt(text).epsg == epsg
    broken = 'COMPD_CS["x",PROJCS["g",GEOGCS["h",UNIT["degree",0.017]],UNIT["metre",1],VERT_CS["z",UNIT["foot",0.3048]]'
    assert (of_wkt(broken).unit, of_wkt(broken).height_unit) == (1.0, 0.3048)
    assert of_wkt('COMPD_CS["geo",GEOGCS["x",UNIT["degree",0.0174]],VERT_CS["z",UNIT["metre",1]]').kind == "geographic"
    assert of_wkt('PROJCS["x",UNIT["m",.]]').unit is None
    assert of_geokeys({1024: 1, 3076: 9005}).unit == pytest.approx(0.3047972654)
    assert of_geokeys({1024: float("nan")}) is None
