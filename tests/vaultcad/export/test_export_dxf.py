"""plan.dxf, read back by ezdxf."""

from collections import Counter

import ezdxf
import pytest

from families import FAMILIES
from vaultcad.export.dxf import LAYERS, write_dxf
from vaultcad.export.plan_shape import plan_shape

IDS = [cls.id for cls in FAMILIES]


def read(model, path):
    write_dxf(model, path)
    document = ezdxf.readfile(path)
    audit = document.audit()
    assert not audit.errors
    assert not audit.fixes
    return document


@pytest.mark.parametrize("name", IDS)
def test_every_family_has_a_plan_that_cad_reads(make_model, tmp_path, name):
    model = make_model(name)
    document = read(model, tmp_path / "plan.dxf")
    (vault,) = model.vaults
    outlines = document.modelspace().query('LWPOLYLINE[layer=="VAULTS"]')
    assert len(outlines) == len(vault.vault.plan.loops)
    shape = plan_shape(model, vault)
    reach = [point[:2] for line in outlines for point in line.get_points()]
    for at, expected in zip(reach, (c for outline in shape.outlines for c in outline.corners), strict=True):
        assert at == pytest.approx(expected, abs=1e-9)


def test_groins_cross_in_the_middle(make_model, tmp_path):
    document = read(make_model("groin"), tmp_path / "plan.dxf")
    groins = document.modelspace().query('LWPOLYLINE[layer=="GROINS"]')
    assert len(groins) == 4
    vault = make_model("groin").vaults[0]
    for groin in groins:
        assert len(groin) == 2  # straight
        ends = [tuple(point[:2]) for point in groin.get_points()]
        assert pytest.approx((vault.pose.x, vault.pose.y), abs=2e-3) in ends
    assert document.layers.get("GROINS").dxf.linetype == "DASHED"


def test_round_plans_are_arcs(make_model, tmp_path):
    document = read(make_model("conch"), tmp_path / "plan.dxf")
    (outline,) = document.modelspace().query('LWPOLYLINE[layer=="VAULTS"]')
    bulges = [point[4] for point in outline.get_points()]
    assert bulges == pytest.approx([0.0, 0.41421356, 0.41421356])  # a straight side, and two quarters of a circle


def test_a_building_has_arches_numbers_heights_and_layers_for_its_upper_storey(building, tmp_path):
    document = read(building, tmp_path / "plan.dxf")
    layers = {layer.dxf.name for layer in document.layers}
    assert {*LAYERS, *(f"{name}-2" for name in LAYERS)} <= layers
    space = document.modelspace()
    told = Counter((entity.dxf.layer, entity.dxftype()) for entity in space)
    assert told["VAULTS", "LWPOLYLINE"] == 2
    assert told["VAULTS-2", "LWPOLYLINE"] == told["ARCHES", "LWPOLYLINE"] == 1
    texts = {text.dxf.layer: text.dxf.text for text in space.query("TEXT")}
    assert {text.dxf.text for text in space.query('TEXT[layer=="NUMBERS"]')} == {"1  A2", "2  A1", "a1"}
    assert texts["NUMBERS-2"] == "3  B1"
    assert texts["HEIGHTS"] == "+213.000 +215.500"
    assert document.units == 6  # metres
    assert dict(document.header.custom_vars.properties)["place"] == building.place


def test_the_same_model_gives_the_same_bytes_stamped_with_the_told_time(building, tmp_path, monkeypatch):
    for name in "ab":
        write_dxf(building, tmp_path / name)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    write_dxf(building, tmp_path / "b")
    assert (tmp_path / "a").read_bytes() != (tmp_path / "b").read_bytes()


def test_classes_in_use_stand_in_an_order_that_hangs_on_no_hash(building, tmp_path):
    write_dxf(building, tmp_path / "a.dxf")
    document = ezdxf.readfile(tmp_path / "a.dxf")
    used = [one.dxf.name for one in document.classes if one.dxf.name in document.entitydb.dxf_types_in_use()]
    assert len(used) > 3
    assert used == sorted(used)
