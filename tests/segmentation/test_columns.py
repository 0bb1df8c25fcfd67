"""What the columns of a text are: understood by their names in five languages, or refused with the line."""

import numpy as np
import pytest

from segmentation import ReadError, read
from segmentation.io.header import NotUnderstoodError, names_of, understood

# a room of a survey: easting, northing, height
XYZ = np.array([[500_000.25, 4_700_010.5, 101.0], [500_003.5, 4_700_011.25, 102.5], [500_001.0, 4_700_014.75, 103.125],
                [500_002.0, 4_700_012.0, 104.0], [500_004.75, 4_700_013.5, 101.5]])  # fmt: skip
LOCAL = XYZ - [500_000, 4_700_010, 100]
RGB = np.array([[10, 20, 30], [200, 190, 180], [90, 91, 92], [0, 5, 9], [255, 250, 240]])
I = np.array([700, 1000, 2000, 12, 4095])  # noqa: E741


def written(tmp_path, head, *columns, sep=",", name="a.csv", encoding="utf-8", end="\n", decimal="."):
    rows = [[f"{v:.0f}" if float(v).is_integer() else f"{v:.4f}" for v in row] for row in np.column_stack(columns)]
    text = head + end + end.join(sep.join(v.replace(".", decimal) for v in row) for row in rows) + end
    path = tmp_path / name
    path.write_bytes(text.encode(encoding))
    return path


def points(cloud):
    return cloud.in_file(cloud.xyz)


@pytest.mark.parametrize(
    ("head", "order"),
    [
        ("N,E,Z", "yxz"),
        ("E,N,Z", "xyz"),
        ("E,N,H", "xyz"),
        ("Northing (m),Easting (m),Elevation (m)", "yxz"),
        ("northing [m];easting [m];height [m]", "yxz"),
        ("Hochwert;Rechtswert;Höhe", "yxz"),
        ("Rechtswert;Hochwert;Höhe", "xyz"),
        ("R;H;Z", "xyz"),
        ("H;R;Z", "yxz"),
        ("Nordwert\tOstwert\tHöhe", "yxz"),
        ("Nord;Est;Quota", "yxz"),
        ("Est;Nord;Quota", "xyz"),
        ("Nord,Est,Altitude", "yxz"),
        ("Est,Nord,Altitude", "xyz"),
        ("Norte;Este;Cota", "yxz"),
        ("Este;Norte;Altura", "xyz"),
        ("coordinata X,coordinata Y,coordinata Z", "xyz"),
        ("X coordinate,Y coordinate,Z coordinate", "xyz"),
        ("z,y,x", "zyx"),
        ("//X,Y,Z", "xyz"),
        ("# N E Z", "yxz"),
        ("# order: N E Z", "yxz"),
        ("\"Northing\",\"Easting\",\"Height\"", "yxz"),
        ("UTM_N,UTM_E,Alt.", "yxz"),
        ("POINT_X,POINT_Y,POINT_Z", "xyz"),
        ('"Points:0","Points:1","Points:2"', "xyz"),
        ("Hochwert / m;Rechtswert / m;Höhe ü. NN", "yxz"),
    ],
)  # fmt: skip
def test_names_of_coordinates(tmp_path, head, order):
    sep = next((mark for mark in (";", "\t", ",") if mark in head), " ")
    columns = [LOCAL[:, "xyz".index(axis)] for axis in order]
    cloud = read(written(tmp_path, head, *columns, sep=sep))
    np.testing.assert_allclose(points(cloud), LOCAL, atol=1e-4)
    projected = [XYZ[:, "xyz".index(axis)] for axis in order]
    if head != "z,y,x":
        np.testing.assert_allclose(points(read(written(tmp_path, head, *projected, sep=sep))), XYZ, atol=1e-3)


@pytest.mark.parametrize(
    "first",
    ["Point ID", "point_id", "PointNo", "Punktnummer", "Pkt.-Nr.", "Punkt Nr", "Nr.", "ID", "Punto", "Numero", "N°",
     "Nombre", "Matricule", "No."],
)  # fmt: skip
@pytest.mark.parametrize("sep", [",", ";", "\t", " "])
def test_numbers_of_points_in_front(tmp_path, first, sep):
    head = sep.join([first.replace(" ", "_") if sep == " " else first, "X", "Y", "Z"])
    cloud = read(written(tmp_path, head, np.arange(7, 12), LOCAL, sep=sep))
    np.testing.assert_allclose(points(cloud), LOCAL, atol=1e-4)
    assert "- x y z" in dict(cloud.notes)["columns"]


def test_two_words_in_a_name_are_one_column(tmp_path):
    cloud = read(written(tmp_path, "Point ID X Y Z", np.arange(5), LOCAL, sep=" "))
    np.testing.assert_allclose(points(cloud), LOCAL, atol=1e-4)


@pytest.mark.parametrize("sep", [",", ";", "\t", " "])
@pytest.mark.parametrize("head", ["", "name{0}x{0}y{0}z\n", "Punkt{0}Rechtswert{0}Hochwert{0}Höhe\n"])
def test_words_in_front_are_no_coordinates(tmp_path, sep, head):
    rows = "\n".join(sep.join([f"P{k}", *(f"{v:.4f}" for v in row)]) for k, row in enumerate(LOCAL))
    (tmp_path / "a.txt").write_text(head.format(sep) + rows + "\n", encoding="utf-8")
    np.testing.assert_allclose(points(read(tmp_path / "a.txt")), LOCAL, atol=1e-4)


def test_names_with_blanks_between_tabs(tmp_path):
    rows = "\n".join("\t".join([f"room {k} east", *(f"{v:.4f}" for v in row)]) for k, row in enumerate(LOCAL))
    (tmp_path / "a.txt").write_text("point name\tX\tY\tZ\n" + rows + "\n")
    np.testing.assert_allclose(points(read(tmp_path / "a.txt")), LOCAL, atol=1e-4)


@pytest.mark.parametrize("start", [0, 1, 1000])
def test_a_running_number_that_nothing_names(tmp_path, start):
    cloud = read(written(tmp_path, f"{start},1.5,2.5,3.5", np.arange(start + 1, start + 6), LOCAL))
    np.testing.assert_allclose(points(cloud)[1:], LOCAL, atol=1e-4)
    assert "by their place" in dict(cloud.notes)["columns"]


def test_whole_numbers_in_front_that_do_not_run(tmp_path):
    with pytest.raises(ReadError, match=r"first column holds whole numbers.*--columns"):
        read(written(tmp_path, "7,1.5,2.5,3.5", [3, 9, 1, 4, 4], LOCAL))


def test_northing_before_easting_that_nothing_names(tmp_path):
    rows = XYZ[:, [1, 0, 2]]
    path = written(tmp_path, ",".join(f"{v:.4f}" for v in rows[0]), rows[1:])
    with pytest.raises(ReadError, match=r"look like northing and easting.*--columns"):
        read(path)
    np.testing.assert_allclose(points(read(path, columns="y,x,z")), XYZ, atol=1e-3)


@pytest.mark.parametrize(
    "head",
    [
        "Southing,Westing,Z",
        "a1,a2,a3",
        "X,Y,foo",
        "X,Easting,Z",
        "X,Y",
        "a survey of the crypt",
        "X,Y,Z,Intensity",
        "Y,X,H",
    ],
)
def test_what_is_not_understood_is_quoted(tmp_path, head):
    with pytest.raises(ReadError, match="--columns") as error:
        read(written(tmp_path, head, XYZ))
    assert repr(head) in str(error.value)


def test_y_before_x_by_name_in_a_room_of_its_own(tmp_path):
    np.testing.assert_allclose(points(read(written(tmp_path, "Y,X,Z", LOCAL[:, [1, 0, 2]]))), LOCAL, atol=1e-4)


@pytest.mark.parametrize(
    ("head", "columns", "has"),
    [
        ("R,G,B,X [m],Y [m],Z [m]", (RGB, LOCAL), "c"),
        ("X,Y,Z,R,G,B,Intensity", (LOCAL, RGB, I), "ci"),
        ("X,Y,Z,Rot,Grün,Blau,Intensität", (LOCAL, RGB, I), "ci"),
        ("x;y;z;rosso;verde;blu;intensità", (LOCAL, RGB, I), "ci"),
        ("x;y;z;rouge;vert;bleu;intensité", (LOCAL, RGB, I), "ci"),
        ("//X Y Z Rf Gf Bf Scalar_Intensity GpsTime", (LOCAL, RGB / 255, I, 9.5 * I), "ci"),
    ],
)
def test_names_of_other_things(tmp_path, head, columns, has):
    sep = next((mark for mark in (";", ",") if mark in head), " ")
    cloud = read(written(tmp_path, head, *columns, sep=sep))
    np.testing.assert_allclose(points(cloud), LOCAL, atol=1e-4)
    assert ("c" in has, "i" in has) == (cloud.color is not None, cloud.intensity is not None)
    np.testing.assert_allclose(cloud.color, RGB * 257, atol=20)
    if "i" in has:
        np.testing.assert_array_equal(cloud.intensity, I)


@pytest.mark.parametrize(
    ("columns", "pts"),
    [
        ((LOCAL, RGB, I), False),
        ((LOCAL, I, RGB), False),
        ((LOCAL, I - 2048, RGB), True),
        ((LOCAL, RGB, I % 256), False),
    ],
)
def test_colour_and_intensity_that_nothing_names(tmp_path, columns, pts):
    first = " ".join(f"{v:g}" for v in np.column_stack(columns)[0])
    cloud = read(written(tmp_path, first, *columns, sep=" ", name=f"a.{'pts' if pts else 'xyz'}"))
    np.testing.assert_array_equal(cloud.color[1:], RGB * 257)
    assert cloud.intensity is not None


@pytest.mark.parametrize("head", ["", '"X","Y","Z"\n', '"Punkt","Rechtswert","Hochwert","Höhe"\n'])
def test_numbers_in_quotes_with_decimal_commas(tmp_path, head):
    front = '"P1",' if "Punkt" in head else ""
    rows = "\n".join(front + ",".join(f'"{v:.3f}"'.replace(".", ",") for v in row) for row in LOCAL)
    (tmp_path / "a.csv").write_text(head + rows + "\n", encoding="utf-8")
    np.testing.assert_allclose(points(read(tmp_path / "a.csv")), LOCAL, atol=1e-3)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "latin-1"])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_encodings_and_ends_of_lines(tmp_path, encoding, end):
    mark = "\ufeff" if encoding == "utf-16-be" else ""
    path = written(tmp_path, mark + "Punkt;Rechtswert;Hochwert;Höhe", np.arange(5), LOCAL, sep=";", encoding=encoding,
                   end=end, decimal=",")  # fmt: skip
    np.testing.assert_allclose(points(read(path)), LOCAL, atol=1e-4)


@pytest.mark.parametrize("end", ["\n", "\r"])
def test_blocks_of_other_encodings_join(tmp_path, monkeypatch, end):
    monkeypatch.setattr("segmentation.io.table.BLOCK", 37)
    xyz = np.round(np.random.default_rng(0).uniform(0, 5, (300, 3)), 4)
    np.testing.assert_allclose(
        points(read(written(tmp_path, "x,y,z", xyz, encoding="utf-16", end=end))), xyz, atol=1e-4
    )


@pytest.mark.parametrize("columns", ["-,y,x,z", "id N E H", "_;y;x;z"])
def test_the_user_says_the_columns(tmp_path, columns):
    path = written(tmp_path, "foo,bar,baz,qux", np.arange(5), LOCAL[:, [1, 0, 2]])
    cloud = read(path, columns=columns)
    np.testing.assert_allclose(points(cloud), LOCAL, atol=1e-4)
    assert "as asked" in dict(cloud.notes)["columns"]


@pytest.mark.parametrize(
    ("columns", "complaint"),
    [
        ("x,y,z", "names 3 columns where there are 4"),
        ("x,y,-,-", "no column is known to be z"),
        ("x,y,z,foo", "'foo' names no column"),
        ("x,x,y,z", "may be x"),
    ],
)
def test_columns_that_do_not_suit(tmp_path, columns, complaint):
    with pytest.raises(ReadError, match=complaint):
        read(written(tmp_path, "a,b,c,d", np.arange(5), LOCAL), columns=columns)


def test_columns_are_for_texts(tmp_path, clouds):
    with pytest.raises(ValueError, match=r"\.laz files name theirs"):
        read(clouds.sample(tmp_path, ".laz"), columns="x,y,z")


def test_comments_are_no_headers(tmp_path):
    head = "# scanned by Leica\n# on a Monday in May"
    np.testing.assert_allclose(points(read(written(tmp_path, head, LOCAL))), LOCAL, atol=1e-4)


def test_an_underscore_is_no_digit(tmp_path):
    (tmp_path / "a.xyz").write_text("1 2 3\n" * 30 + "1_0 2 3\n")
    with pytest.raises(ReadError, match="line 31 is no row"):
        read(tmp_path / "a.xyz")


def test_what_a_header_may_be():
    header = understood("Nr;Y;X;H", 4, ";")
    assert header is not None
    assert header.order == "- y x z"
    assert understood("# scan of a room", 3, "") is None
    with pytest.raises(NotUnderstoodError, match="degrees"):
        understood("lat,lon,h", 3, ",")
    assert names_of("x y z").order == "x y z"


NORTH = np.array([[450_000.25, 5_400_010.5, 101.0], [450_003.5, 5_400_011.25, 102.5], [450_001.0, 5_400_014.75, 103.1],
                  [450_002.0, 5_400_012.0, 104.0], [450_004.75, 5_400_013.5, 101.5]])  # fmt: skip


@pytest.mark.parametrize("head", ["X,Y,Z", "POINT_Y,POINT_X,POINT_Z", "YCoord,XCoord,ZCoord", "Y,X,H"])
def test_bare_names_over_northing_and_easting_are_refused(tmp_path, head):
    with pytest.raises(ReadError, match="--columns"):
        read(written(tmp_path, head, NORTH[:, [1, 0, 2]]))


@pytest.mark.parametrize("head", ["X(N),Y(E),Z", "X (Nord),Y (Est),Z", "Nord(X),Est(Y),Quota"])
def test_brackets_that_name_another_coordinate_are_refused(tmp_path, head):
    with pytest.raises(ReadError, match="names two coordinates"):
        read(written(tmp_path, head, LOCAL))


@pytest.mark.parametrize("place", [(3_500_000, 5_400_000), (1_500_000, 4_900_000), (2_600_000, 1_200_000)])
def test_grids_whose_northing_comes_first(tmp_path, place):
    xyz = LOCAL + [*place, 0]
    first = ",".join(f"{v:.4f}" for v in xyz[0])
    np.testing.assert_allclose(points(read(written(tmp_path, first, xyz[1:]))), xyz, atol=1e-2)
    with pytest.raises(ReadError, match="look like northing and easting"):
        read(written(tmp_path, ",".join(f"{v:.4f}" for v in xyz[0, [1, 0, 2]]), xyz[1:, [1, 0, 2]]))


@pytest.mark.parametrize("head", ["# N E Z", "# Y X Z", "# Rechtswert Hochwert"])
def test_a_comment_that_names_other_columns_than_there_are(tmp_path, head):
    with pytest.raises(ReadError, match="another number of columns"):
        read(written(tmp_path, head, LOCAL, RGB, sep=" "))


@pytest.mark.parametrize(
    "head",
    ["# long corridor, scan 3", "# Lange Halle", "# Breite der Kirche: 8 m", "# scan of the north east tower",
     "# exported by Nord Est Rilievi", "# X Y Z, then colours"],
)  # fmt: skip
def test_words_of_comments_are_no_names(tmp_path, head):
    np.testing.assert_allclose(points(read(written(tmp_path, head, LOCAL, RGB, sep=" "))), LOCAL, atol=1e-4)


def test_rows_and_columns_of_a_grid_are_no_coordinates(tmp_path):
    grid = np.column_stack([np.arange(5), np.arange(5) % 3])
    with pytest.raises(ReadError, match="rows and columns of a grid"):
        read(written(tmp_path, "7 1 0.5 1.5 2.5", grid, LOCAL, sep=" ", name="a.xyz"))
