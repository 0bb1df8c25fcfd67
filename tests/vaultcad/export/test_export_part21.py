import dataclasses
from pathlib import Path

import pytest

from vaultcad.export.part21 import encoded, in_order, unbroken
from vaultcad.export.step import write_step
from vaultcad.pose import Pose

NAMES = (
    "ENDSEC;", "a'b", "''", "x\\X2\\y", "back\\slash\\", "new\nline", "ctl\x01\x7f", "Größe €😀", "l" * 250, "é" * 120,
    "'" * 40, "a;ENDSEC;\nDATA;", "&#1=(", "\x85\u2028", "@0@", "'@1@'",
)  # fmt: skip


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("Größe", r"Gr\X2\00F600DF\X0\e"),
        ("it's", "it''s"),
        ("a\\b", r"a\\b"),
        ("\\😀", r"\\\X2\D83DDE00\X0" + "\\"),
        ("ENDSEC;", r"ENDSEC\X2\003B\X0" + "\\"),
    ],
)
def test_strings_are_ascii_and_end_nothing(text, expected):
    assert encoded(text) == expected


def root_name(path: Path) -> str:
    from OCP.STEPCAFControl import STEPCAFControl_Reader
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDataStd import TDataStd_Name
    from OCP.TDF import TDF_LabelSequence
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    reader, document = STEPCAFControl_Reader(), TDocStd_Document(TCollection_ExtendedString("XmlOcaf"))
    reader.SetNameMode(True)
    reader.ReadFile(str(path))
    assert reader.Transfer(document)
    roots, name = TDF_LabelSequence(), TDataStd_Name()
    XCAFDoc_DocumentTool.ShapeTool_s(document.Main()).GetFreeShapes(roots)
    assert roots.Value(1).FindAttribute(TDataStd_Name.GetID_s(), name)
    return name.Get().ToExtString()


@pytest.mark.parametrize("name", NAMES, ids=ascii)
def test_opencascade_reads_any_name_back(name, make_model, tmp_path):
    write_step(make_model("barrel", scan=Path(name + ".laz")), tmp_path / "model.step")
    assert root_name(tmp_path / "model.step") == name


@pytest.mark.parametrize("name", NAMES, ids=ascii)
def test_ifcopenshell_reads_any_name_back(name, make_model, tmp_path):
    import ifcopenshell

    from vaultcad.export.ifc import write_ifc

    write_ifc(make_model("barrel", scan=Path(name + ".laz")), tmp_path / "model.ifc")
    assert ifcopenshell.open(str(tmp_path / "model.ifc")).by_type("IfcProject")[0].Name == name


def test_the_colours_of_several_vaults_come_in_the_order_of_the_vaults(make_model, tmp_path):
    names = ("barrel", "sail", "groin", "trough")
    vaults = tuple(
        dataclasses.replace(make_model(name).vaults[0], pose=Pose(15.0 * k, 0.0, 0.0, 0.0))
        for k, name in enumerate(names)
    )
    model, litter = make_model("groin", vaults=vaults), []
    written = set()
    for k in range(4):
        write_step(model, tmp_path / "model.step")
        written.add((tmp_path / "model.step").read_bytes())
        litter.append([bytes(100 + j % 999) for j in range(5000 * k)][::2])  # so that addresses differ
    assert len(written) == 1


def test_colours_are_sorted_by_the_shape_they_belong_to():
    start = "#1 = CONTEXT();\n#2 = CONTEXT();\n"
    one, other = (start + colours(3, first) + colours(5, second) + "ENDSEC;\n" for first, second in ((2, 1), (1, 2)))
    assert in_order(one) == in_order(other)
    assert unbroken(in_order(one)) == unbroken(other)


def colours(k: int, context: int) -> str:
    kind = "MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION"
    return f"#{k} = {kind}('',(#{k + 1}),#{context});\n#{k + 1} = RGB('of {context}');\n"
