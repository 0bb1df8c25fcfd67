"""A model as plain values: whole, read back the same, refused where an edit cannot be."""

import json
from dataclasses import replace

import numpy as np
import pytest

from families import FAMILIES, Groin, Pointed, Vault, family
from families.declaration.corners import Skew
from vaultcad.displacement import Displacement
from vaultcad.errors import ModelFileError
from vaultcad.export.report_json import report
from vaultcad.model import FittedPier, PlacedVault, Rival
from vaultcad.model_file import placed_vault, plain_model, plain_vault, read_model, write_model
from vaultcad.pose import Pose
from vaultcad.uncertain import Covariance, Estimate

VAULTS = {cls.id: cls() for cls in FAMILIES} | {
    "skewed groin": replace(family("groin")(), skew=Skew(shear=0.1, taper_x=-0.05)),
    "pointed groin": family("groin")().with_arches({"profile_x": Pointed()}),
}


@pytest.mark.parametrize("vault", VAULTS.values(), ids=VAULTS)
def test_a_vault_as_plain_values_is_the_same_again(vault):
    assert Vault.from_plain(json.loads(json.dumps(vault.plain()))) == vault
    assert type(vault).from_plain(vault.plain()) == vault


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        ({"family": "igloo"}, "no vault family is called 'igloo'"),
        ({"family": 7}, "family = 7 is no name"),
        ({"schema": 9}, "schema = 9 of a vault is not known"),
        ({"profiles": {"profile_z": "pointed"}}, "a groin vault has no profile 'profile_z'"),
        ({"profiles": {"profile_x": "gothic"}}, "no profile is called 'gothic'"),
        ({"profiles": {"profile_x": 3}}, "profile_x = 3 is no profile"),
        ({"profiles": ["pointed"]}, "profiles = .* is no table"),
        ({"parameters": {"span": 4.0}}, "no parameter 'span' here"),
        ({"parameters": {"span_x": 4000.0}}, r"span_x = 4000 lies outside \[0\.5, 40\] m"),
        ({"parameters": {"span_x": "4"}}, "span_x = '4' is no number"),
        ({"parameters": {"span_x": float("nan")}}, "span_x = nan lies outside"),
        ({"parameters": {"span_x": True}}, "span_x = True is no number"),
    ],
)
def test_a_vault_that_cannot_be_is_refused_by_its_name(edit, said):
    with pytest.raises(ValueError, match=said):
        Vault.from_plain({**Groin().plain(), **edit})


def test_a_vault_of_another_family_is_refused():
    with pytest.raises(ValueError, match="family = 'sail' is no groin vault"):
        Groin.from_plain(VAULTS["sail"].plain())


@pytest.fixture
def model(make_model):
    whole = make_model("groin")
    covariance = Covariance(("x", "yaw"), np.array([[4e-6, 1e-7], [1e-7, 1e-8]]))
    rival = Rival(0.4, {"profile_x": "pointed"}, ("level",), {"span_x": 4.0}, -0.01)
    sunk = Displacement(np.array([-3.0, -3.1, -0.7]), np.array([0.9, 0.8, 0.7]), np.full((3, 2, 4, 3), 0.012_345))
    found = {"covariance": covariance, "rivals": (rival,), "odds": {"profile_x": {"pointed": 0.7}}, "surface": sunk}
    fitted = replace(whole.vaults[0], **found)
    return replace(whole, vaults=(fitted,), origin=np.array([5e5, 4.7e6, 0.0]))


def edited(model, path, **changes):
    told = json.loads(json.dumps(plain_model(model)))
    for place, value in changes.items():
        *heads, last = place.split("__")
        node = told["vaults"][0] if heads[:1] == ["vault"] else told
        for head in heads[1:] if heads[:1] == ["vault"] else heads:
            node = node[head]
        node[last] = value
    path.write_text(json.dumps(told))
    return path


@pytest.mark.parametrize("name", [cls.id for cls in FAMILIES])
def test_a_model_is_read_back_as_it_was_written(make_model, name, tmp_path):
    model = make_model(name)
    write_model(model, tmp_path / "model.json")
    again = read_model(tmp_path / "model.json")
    assert report(replace(again, scan=model.scan), correlations=True) == report(model, correlations=True)
    write_model(again, tmp_path / "again.json")
    assert (tmp_path / "again.json").read_bytes() == (tmp_path / "model.json").read_bytes()


def test_what_was_found_is_whole(model, tmp_path):
    write_model(model, tmp_path / "model.json")
    (again,) = read_model(tmp_path / "model.json").vaults
    (fitted,) = model.vaults
    assert replace(again, covariance=None) == replace(fitted, covariance=None)
    assert again.covariance.names == fitted.covariance.names
    np.testing.assert_array_equal(again.covariance.matrix, fitted.covariance.matrix)


def test_piers_and_the_account_of_the_ceiling_come_back(make_model, tmp_path):
    (vault,) = make_model("barrel").vaults
    sizes = {"diameter": Estimate(0.5, "m", 0.004, "of the shaft"), "height": Estimate(3.0, "m", 0.01)}
    covariance = Covariance(("x", "y", "z", "yaw", *sizes), np.diag([4e-6, 4e-6, 1e-6, 0.0, 1.6e-5, 1e-4]))
    pier = FittedPier("round", Pose(1.0, 2.0, 0.5, 0.0), sizes, 800, vault.deviation, covariance)
    write_model(make_model("barrel", piers=(pier,), ceiling={"area": 9.0, "vault": 9.0}), tmp_path / "model.json")
    read = read_model(tmp_path / "model.json")
    (again,) = read.piers
    assert replace(again, covariance=covariance) == pier
    assert again.covariance.names == covariance.names
    assert np.array_equal(again.covariance.matrix, covariance.matrix)
    assert read.ceiling == {"area": 9.0, "vault": 9.0}


def test_an_edit_is_in_all_numbers_and_said(model, tmp_path):
    path = edited(model, tmp_path / "model.json", vault__parameters__span_x=5.5, vault__pose__z=3.25)
    again = read_model(path)
    (fitted,) = again.vaults
    assert fitted.vault.values()["span_x"] == 5.5
    assert fitted.pose.z == 3.25
    assert (fitted.parameters["span_x"].value, fitted.parameters["span_x"].std) == (5.5, None)
    assert fitted.parameters["rise"].value == fitted.vault.derived_values()["rise"]
    assert fitted.parameters["span_y"] == model.vaults[0].parameters["span_y"]
    assert "vault 1 was edited after the fit" in again.notes[-1].text


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"vault__parameters__span_x": 99}, r"model\.json: span_x = 99 lies outside \[0\.5, 40\] m"),
        ({"vault__pose__yaw": "north"}, r"pose\.yaw = 'north' is no number"),
        ({"vault__family": "igloo"}, "igloo"),
        ({"thickness": -1}, r"thickness = -1 lies outside \(0, 5\] m"),
        ({"thickness": None}, "thickness = None is no number"),
        ({"origin": [0, 0]}, r"origin = \[0, 0\] is no place; give three numbers"),
        ({"origin": ["a", 0, 0]}, "origin = 'a' is no number"),
        ({"schema": 2}, "schema = 2 is not known; this version reads 1"),
        ({"vault__pose": {"x": 0}}, "y is missing"),
        ({"vault__estimates__span_x": 4}, "mend the file"),
        ({"vault__deviation": None}, "deviation = None is no measure"),
        ({"vault__surface__step": [1, 0, 1]}, r"surface\.step = \[1, 0, 1\] is no spacing of a grid"),
        ({"vault__surface__low": [1, None, 1]}, r"surface\.low = \[1, None, 1\] is no triple of numbers"),
        ({"vault__surface__shape": [3, 2, 0]}, r"surface\.shape = \[3, 2, 0\] is no grid"),
        ({"vault__surface__shape": [3, 3, 4]}, "has not the 9 rows"),
        ({"vault__surface__shape": [3, 2, 5]}, "has a row of 12 numbers; surface.shape asks for 15"),
        ({"vault__surface__micrometres": ["x"] * 6}, "has 'x', which is no row of whole numbers"),
        ({"vault__surface__micrometres": [" ".join(["99000000"] * 12)] * 6}, "go beyond 10 m"),
    ],
)
def test_a_wrong_edit_is_refused_with_field_value_and_range(model, tmp_path, changes, said):
    with pytest.raises(ModelFileError, match=said):
        read_model(edited(model, tmp_path / "model.json", **changes))


@pytest.mark.parametrize("text", ["", "{", "[]", "{}", '{"vaults": []}', "\ud800".encode("utf-8", "surrogatepass")])
def test_what_is_no_model_is_refused(tmp_path, text):
    path = tmp_path / "model.json"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(ModelFileError, match=r"model\.json: is no"):
        read_model(path)


def test_a_vault_that_was_never_fitted_needs_a_pose_alone(model):
    told = {**Groin().plain(), "pose": plain_vault(model.vaults[0])["pose"]}
    assert placed_vault(told) == PlacedVault(Groin(), model.vaults[0].pose)
    assert placed_vault({**told, "thickness": 0.2, "label": "Nave"}).label == "Nave"
    with pytest.raises(KeyError, match="pose"):
        placed_vault(Groin().plain())
