"""STEP, read back by OpenCASCADE's readers and by cadquery."""

import dataclasses
import re
from pathlib import Path

import numpy as np
import pytest

from families import FAMILIES
from vaultcad.export.geometry import masonry
from vaultcad.export.palette import colour
from vaultcad.export.step import write_step

IDS = [cls.id for cls in FAMILIES]


@pytest.fixture(scope="module")
def written(make_model, tmp_path_factory):
    """Path of the STEP file of a family's model, written once."""
    folder, made = tmp_path_factory.mktemp("step"), {}

    def write(name):
        if name not in made:
            made[name] = folder / f"{name}.step"
            write_step(make_model(name), made[name])
        return made[name]

    return write


def read(path):
    from OCP.STEPControl import STEPControl_Reader

    reader = STEPControl_Reader()
    assert reader.ReadFile(str(path))
    reader.TransferRoots()
    return reader.OneShape()


def volume(shape):
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    found = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, found)
    return found.Mass()


@pytest.mark.parametrize("name", IDS)
def test_the_solid_comes_back_whole(name, make_model, written):
    from OCP.BRepCheck import BRepCheck_Analyzer

    (fitted,) = make_model(name).vaults
    shape = read(written(name))
    assert BRepCheck_Analyzer(shape).IsValid()
    assert volume(shape) == pytest.approx(volume(masonry(fitted.vault, 0.15)), rel=1e-5)


@pytest.mark.parametrize("name", IDS)
def test_the_intrados_lies_exactly_where_the_fit_put_it(name, make_model, written):
    """Points of the numeric surface, placed by the pose, are on the file's faces; it is in millimetres."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeVertex
    from OCP.BRepExtrema import BRepExtrema_DistShapeShape
    from OCP.gp import gp_Pnt

    (fitted,) = make_model(name).vaults
    place = fitted.pose.placement()
    points = on_the_surface(fitted.vault, np.random.default_rng(3)) @ place[:3, :3].T + place[:3, 3]
    shape = read(written(name))
    far = [
        BRepExtrema_DistShapeShape(BRepBuilderAPI_MakeVertex(gp_Pnt(*(1000 * p))).Vertex(), shape).Value()
        for p in points
    ]
    assert max(far) < 1e-3  # [mm]


def on_the_surface(vault, rng, count=12):
    """Points (n, 3) [m] that plumb lines at random places in the plan meet the numeric surface in."""
    half = np.array([vault.plan.half_x, vault.plan.half_y])
    places = 0.95 * half * rng.uniform(-1, 1, (10 * count, 2))
    x, y = places[vault.plan.holds(places)][:count].T
    low, high = np.zeros(count), np.full(count, 20.0)
    for _ in range(60):
        middle = (low + high) / 2
        inside = vault.distance(np.column_stack([x, y, middle])) < 0
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    return np.column_stack([x, y, low])


@pytest.mark.parametrize("name", IDS)
def test_faces_carry_the_names_of_the_components(name, make_model, written):
    (fitted,) = make_model(name).vaults
    names = set(re.findall(r"ADVANCED_FACE\('([^']*)'", written(name).read_text()))
    assert names == {*fitted.vault.components, "extrados", "side"}


def test_a_reader_of_assemblies_sees_names_and_colours(make_model, written):
    from OCP.Quantity import Quantity_Color, Quantity_TOC_sRGB
    from OCP.STEPCAFControl import STEPCAFControl_Reader
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDataStd import TDataStd_Name
    from OCP.TDF import TDF_Label, TDF_LabelSequence
    from OCP.TDocStd import TDocStd_Document
    from OCP.TopAbs import TopAbs_FACE
    from OCP.TopExp import TopExp_Explorer
    from OCP.XCAFDoc import XCAFDoc_ColorSurf, XCAFDoc_DocumentTool, XCAFDoc_ShapeTool

    def title(label):
        name = TDataStd_Name()
        assert label.FindAttribute(TDataStd_Name.GetID_s(), name)
        return name.Get().ToExtString()

    reader = STEPCAFControl_Reader()
    reader.SetNameMode(True)
    reader.SetColorMode(True)
    assert reader.ReadFile(str(written("groin")))
    document = TDocStd_Document(TCollection_ExtendedString("XmlOcaf"))
    reader.Transfer(document)
    shapes, roots, parts = XCAFDoc_DocumentTool.ShapeTool_s(document.Main()), TDF_LabelSequence(), TDF_LabelSequence()
    shapes.GetFreeShapes(roots)
    assert [title(roots.Value(k + 1)) for k in range(roots.Length())] == ["scan of a groin"]
    XCAFDoc_ShapeTool.GetComponents_s(roots.Value(1), parts)
    assert [title(parts.Value(k + 1)) for k in range(parts.Length())] == ["groin vault"]

    part = TDF_Label()
    XCAFDoc_ShapeTool.GetReferredShape_s(parts.Value(1), part)
    colours, seen = XCAFDoc_DocumentTool.ColorTool_s(document.Main()), set()
    faces = TopExp_Explorer(XCAFDoc_ShapeTool.GetShape_s(part), TopAbs_FACE)
    while faces.More():
        found = Quantity_Color()
        if colours.GetColor(faces.Current(), XCAFDoc_ColorSurf, found):
            seen.add(tuple(round(255 * v) for v in found.Values(Quantity_TOC_sRGB)))
        faces.Next()
    assert {(c.red, c.green, c.blue) for c in map(colour, (1, 2, 3, 4))} <= seen


def test_cadquery_reads_it_in_millimetres(make_model, written):
    import cadquery

    (fitted,) = make_model("barrel").vaults
    solid = cadquery.importers.importStep(str(written("barrel")))
    assert solid.val().Volume() == pytest.approx(volume(masonry(fitted.vault, 0.15)), rel=1e-5)
    centre = solid.val().BoundingBox().center
    assert (centre.x, centre.y) == pytest.approx((1000 * fitted.pose.x, 1000 * fitted.pose.y), abs=1.0)


def test_the_same_model_gives_the_same_bytes(make_model, written, tmp_path):
    write_step(make_model("trough"), tmp_path / "again.step")
    assert (tmp_path / "again.step").read_bytes() == written("trough").read_bytes()


def test_names_of_any_script_are_escaped(make_model, tmp_path):
    model = make_model("barrel", scan=Path("l'église 拱.laz"))
    write_step(dataclasses.replace(model), tmp_path / "model.step")
    text = (tmp_path / "model.step").read_bytes().decode("ascii")
    assert r"l''\X2\00E9\X0\glise \X2\62F1\X0\'" in text.replace("\n", "")


def test_nothing_is_told_on_standard_output(make_model, tmp_path, capfd):
    write_step(make_model("barrel"), tmp_path / "model.step")
    assert capfd.readouterr().out == ""
