"""Sheets to scale, read back by ezdxf, and by what reads SVG and PDF."""

import re
from xml.etree import ElementTree

import ezdxf
import pytest

from families import FAMILIES
from vaultcad.drawings.bundle import CAD, PAGES, sheets, svg_name, write_drawings
from vaultcad.drawings.layers import INKS
from vaultcad.drawings.sheet import PAPERS, SCALES, Wish
from vaultcad.errors import DrawingError, NoSuchVaultError

IDS = [cls.id for cls in FAMILIES]
MOST_ENTITIES = 5_000


def drawn(model, folder, wish=None):
    folder.mkdir(exist_ok=True)
    made = sheets(model, wish)
    write_drawings(made, model.place, folder)
    return made


def audited(path):
    document = ezdxf.readfile(path)
    audit = document.audit()
    assert not audit.errors
    assert not audit.fixes
    return document


@pytest.fixture(scope="module")
def sheets_of_building(building, tmp_path_factory):
    """The sheets of the building, and the folder in which they are."""
    folder = tmp_path_factory.mktemp("drawings") / "out"
    return drawn(building, folder), folder


@pytest.mark.parametrize("name", IDS)
def test_every_family_has_a_sheet_whose_sizes_are_the_models(make_model, tmp_path, name):
    model = make_model(name)
    (sheet,) = drawn(model, tmp_path / "out")
    document = audited(tmp_path / "out" / CAD)
    space = document.modelspace()
    assert 0 < len(space) < MOST_ENTITIES
    assert {entity.dxf.layer for entity in space} <= {*INKS}
    assert set(INKS) <= {layer.dxf.name for layer in document.layers}
    vault = model.vaults[0].vault
    low, high = vault.plan.box
    told = [d.get_measurement() for d in space.query("DIMENSION")]
    for size in (*(high - low).tolist(), vault.derived_values()["rise"]):
        assert min(abs(size - one) for one in told) < 2e-3, (size, told)
    assert document.layout_names() == ["Model", sheet.name]
    (viewport,) = (v for v in document.layout(sheet.name).query("VIEWPORT") if v.dxf.id != 1)
    assert viewport.dxf.view_height / viewport.dxf.height == pytest.approx(sheet.scale / 1000)


def test_paper_and_scale_are_true(make_model, tmp_path):
    (sheet,) = drawn(make_model("groin"), tmp_path / "out")
    assert sheet.paper in PAPERS.values()
    assert sheet.scale in SCALES
    assert sheet.scale <= 50  # before which the paper grows
    root = ElementTree.parse(tmp_path / "out" / svg_name(sheet)).getroot()
    width, height = (float(root.attrib[side].removesuffix("pt")) * 25.4 / 72 for side in ("width", "height"))
    assert (width, height) == pytest.approx(sheet.paper, abs=0.01)
    pages = (tmp_path / "out" / PAGES).read_bytes()
    (box,) = re.findall(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]", pages)
    assert [float(v) * 25.4 / 72 for v in box] == pytest.approx(list(sheet.paper), abs=0.01)
    for placed in sheet.views:
        corner = placed.on_paper(placed.view.high[None], sheet.scale)[0]
        assert (corner > 0).all()
        assert (corner < sheet.paper).all()


def test_a_building_has_a_plan_a_storey_and_a_sheet_a_vault(sheets_of_building):
    made, folder = sheets_of_building
    assert [sheet.name for sheet in made] == ["plan-1", "plan-2", "vault-1", "vault-2", "vault-3"]
    document = audited(folder / CAD)
    assert document.layout_names() == ["Model", *(sheet.name for sheet in made)]
    texts = {text.dxf.text for text in document.modelspace().query("TEXT")}
    assert {"1  A2", "2  A1", "3  B1", "a1", "+213.000 +215.500"} <= texts


def test_what_does_not_fit_is_refused_with_a_way_out(make_model):
    with pytest.raises(DrawingError, match="does not fit on A4 at 1:10; ask for a smaller scale, or a larger paper"):
        sheets(make_model("groin"), Wish(10, "A4"))
    with pytest.raises(NoSuchVaultError, match="vault 2: there is none; give 1 to 1"):
        sheets(make_model("groin"), vaults=(2,))
    assert sheets(make_model("groin"), Wish(20))[0].paper != PAPERS["A3"]  # a larger one is taken


def test_the_same_model_gives_the_same_bytes(building, sheets_of_building, tmp_path):
    _, folder = sheets_of_building
    drawn(building, tmp_path / "again")
    files = sorted(path.name for path in folder.iterdir())
    assert len(files) == 7
    for name in files:
        assert (folder / name).read_bytes() == (tmp_path / "again" / name).read_bytes(), name
