"""Ideal vaults to order, and the options that declarations become."""

from math import pi

import numpy as np
import pytest

from families import FAMILIES, PROFILES, Pointed, family
from families.declaration.lengths import with_lengths
from families.declaration.parameters import Range
from segmentation import read
from segmentation.io.labels import read_labels
from vaultcad.cli.errors import InputError
from vaultcad.cli.family import vault_of
from vaultcad.cli.options import read as read_number


@pytest.mark.parametrize("cls", FAMILIES, ids=lambda c: c.id)
def test_the_points_lie_on_the_vault_with_its_labels_and_normals(run, tmp_path, cls):
    out = tmp_path / "vault.ply"
    assert run("ideal", cls.id, "--points", 2000, "-o", out).code == 0
    cloud, vault = read(out), cls()
    here = vault.evaluate(cloud.xyz)
    assert len(cloud) == 2000
    assert np.abs(here.distance).max() < 1e-5
    assert np.mean(read_labels(out) == here.component) > 0.999
    assert np.einsum("nc,nc->n", cloud.normals, here.normal).max() < -0.99


@pytest.mark.parametrize("suffix", ["ply", "las", "laz"])
def test_labels_come_back_from_every_format_that_holds_them(run, tmp_path, suffix):
    out = tmp_path / f"vault.{suffix}"
    run("ideal", "groin", "--points", 500, "-o", out)
    assert sorted(np.unique(read_labels(out))) == [1, 2, 3, 4]


@pytest.mark.parametrize("suffix", ["e57", "xyz"])
def test_other_formats_hold_the_points(run, tmp_path, suffix):
    out = tmp_path / f"vault.{suffix}"
    run("ideal", "sail", "--points", 500, "-o", out)
    assert len(read(out)) == 500


def test_the_same_seed_gives_the_same_bytes_and_another_seed_others(run, tmp_path):
    for name, seed in (("a", 1), ("b", 1), ("c", 2)):
        run("ideal", "dome", "--points", 1e3, "--seed", seed, "-o", tmp_path / f"{name}.ply")
    a, b, c = ((tmp_path / f"{name}.ply").read_bytes() for name in "abc")
    assert a == b != c


def test_spacing_decides_on_the_number(run, tmp_path):
    run("ideal", "barrel", "--spacing", 0.1, "-o", tmp_path / "a.ply")
    assert len(read(tmp_path / "a.ply")) == pytest.approx(pi * 2.5 * 8 / 0.01, rel=0.01)


@pytest.mark.parametrize("alias", ["crociera", "Voûte d'arêtes", "KREUZGEWÖLBE", "arista"])
def test_a_family_goes_by_its_names_in_other_languages(run, tmp_path, alias):
    out = tmp_path / "a.ply"
    assert (
        run(
            "ideal", alias, "--span-x", 6, "--profile-x", "ogivale", "--rise-ratio-x", 0.8, "--points", 900, "-o", out
        ).code
        == 0
    )
    vault = family("groin")(span_x=6, profile_x=Pointed(0.8))
    assert np.abs(vault.distance(read(out).xyz)).max() < 1e-5


@pytest.mark.parametrize(
    ("cls", "name"), [(cls, name) for cls in FAMILIES for name in cls.ratios], ids=lambda v: getattr(v, "id", v)
)
@pytest.mark.parametrize("share", [0.15, 0.8])
def test_a_length_finds_the_ratio_that_makes_it(cls, name, share):
    profiles = [field for field in vars(cls()) if "profile" in field]
    vault = vault_of(cls, dict.fromkeys(profiles, "elliptical"))
    if name == "shift":
        vault = vault.replaced({"pitch_ratio": 0.7})  # a row without slack cannot be shifted
    limits = {p.name: p.range for p in vault.parameters()}[cls.ratios[name]]
    there = vault.replaced({cls.ratios[name]: limits.low + share * (limits.high - limits.low)})
    wanted = there.derived_values()[name]
    assert with_lengths(vault, {name: wanted}).derived_values()[name] == pytest.approx(wanted, abs=1e-9)


def test_lengths_hold_together():
    vault = vault_of(family("mirror"), {"span_x": 6.0, "run_x": 1.2, "run_y": 1.5, "cove_rise": 1.1, "rise": 0.9})
    sizes = vault.derived_values()
    assert [sizes[n] for n in ("run_x", "run_y", "cove_rise", "rise")] == pytest.approx([1.2, 1.5, 1.1, 0.9], abs=1e-9)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["groin", "--span-x", "99"], "--span-x 99: lies outside what can be; give 0.5 to 40 m"),
        (["groin", "--span-x", "wide"], "--span-x wide: is no number; give 0.5 to 40 m"),
        (["groin", "--span-x", "nan"], "--span-x nan: lies outside"),
        (["groin", "--span-x", "inf"], "--span-x inf: lies outside"),
        (["lunette", "--count", "2.5"], "--count 2.5: is no whole number; give 1 to 12"),
        (
            ["groin", "--rise-ratio-x", "0.3"],
            "--rise-ratio-x 0.3: a semicircular profile has no such parameter; add --profile-x",
        ),
        (
            ["groin", "--profile-x", "pointed", "--rise-ratio-x", "0.3"],
            "--rise-ratio-x 0.3: lies outside what can be; give 0.5 to 1.5",
        ),
        (["groin", "--profile-x", "gothic"], "no profile is called 'gothic'; there are semicircular"),
        (["barrel", "--rise", "2"], "--rise 2: its profile makes it 2.5 m"),
        (["barrel", "--profile", "segmental", "--rise", "3"], "--rise 3: with the other sizes it can be 0.25 to 2.5 m"),
        (["sail", "--rise", "2", "--rise-ratio", "0.5"], "--rise and --rise-ratio say the same; leave one out"),
        (["sail", "--points", "0"], "--points 0: lies outside what can be; give 1 to"),
        (["sail", "--points", "-5"], "--points -5: lies outside"),
        (["sail", "--points", "many"], "--points many: is no number"),
        (["sail", "--spacing", "0"], "--spacing 0: lies outside"),
        (
            ["sail", "--points", "10", "--spacing", "0.1"],
            "--points 10 and --spacing 0.1 exclude each other; leave one out",
        ),
        (["sail", "--seed", "-1"], "--seed -1: lies outside what can be; give 0 or more"),
        (["sail", "--seed", "inf"], "--seed inf: lies outside what can be; give 0 or more"),
        (["sail", "--depth", "1"], "--depth"),
        (["igloo"], "no vault family is called 'igloo'; there are sail, barrel"),
        (["sail", "extra"], "extra"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(run, tmp_path, untouched, arguments, said):
    assert untouched()
    assert said in run("ideal", *arguments, "-o", tmp_path / "a.ply").complaint
    assert untouched()


@pytest.mark.parametrize(
    ("out", "said"),
    [
        ("a.stl", "unknown suffix '.stl'; name a file that ends in one of .e57, .las, .laz, .ply"),
        ("a", "unknown suffix ''"),
        ("none/a.ply", "there is no folder"),
        ("folder.ply", "is a folder; name a file in it"),
        ("file.ply/a.ply", "is no folder"),
    ],
)
def test_a_place_that_cannot_be_written_to_is_told_at_once(run, tmp_path, untouched, out, said):
    (tmp_path / "folder.ply").mkdir()
    (tmp_path / "file.ply").write_text("mine")
    assert untouched()
    told = run("ideal", "sail", "-o", tmp_path / out).complaint
    assert said in told
    assert str(tmp_path / out) in told
    assert untouched()


def test_an_option_that_is_needed_is_named(run):
    assert "--out" in run("ideal", "sail").complaint


def test_angles_are_given_in_degrees():
    limits = Range(-pi, pi, "rad", "turn")
    assert read_number("90", "yaw", limits) == pytest.approx(pi / 2)
    with pytest.raises(InputError, match=r"--yaw 200: lies outside what can be; give -180 to 180°"):
        read_number("200", "yaw", limits)


def test_every_profile_goes_by_its_aliases():
    for cls in PROFILES:
        for alias in (cls.id, *cls.aliases):
            assert type(vault_of(family("barrel"), {"profile": alias}).profile) is cls
