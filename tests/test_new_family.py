"""A family is one file: one that is declared here alone goes all the way, and one that says too little is refused."""

from __future__ import annotations

import inspect
import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Annotated, ClassVar, Self

import numpy as np
import pytest

from families import FAMILIES, Vault, family, register
from families.declaration.constraints import Constraint
from families.declaration.facts import FACTS, check_facts
from families.declaration.footprint import Footprint
from families.declaration.parameters import Range, derived
from families.declaration.pieces import BarrelPart, Ceiling, Piece
from families.declaration.plan import Plan, X
from families.declaration.profiles import Profile, Segmental
from families.declaration.symmetry import Symmetry
from families.declaration.usual_arches import coarse_arches
from families.unrolled.sheet import unrolled
from segmentation import compare, read
from segmentation.io.labels import read_labels
from vaultcad.cli import main
from vaultcad.scanner import draw, read_truth, vault_of
from vaultcad.scanner.turned import turned


@dataclass(frozen=True)
class Corridor(Vault):
    """Barrel across x along y, cut by a level ceiling below its crown."""

    id: ClassVar[str] = "corridor"
    title: ClassVar[str] = "corridor vault"
    aliases: ClassVar[Mapping[str, tuple[str, ...]]] = {"it": ("corridoio",), "de": ("flurgewölbe",)}
    glossary: ClassVar[tuple[tuple[str, str], ...]] = (("ceiling", "the level field of a corridor vault"),)
    roof_type: ClassVar[str] = "RAINBOW_ROOF"
    ratios: ClassVar[Mapping[str, str]] = {"barrel_rise": "rise_ratio", "rise": "plane_ratio"}
    constraints: ClassVar[tuple[Constraint, ...]] = (
        Constraint("two-thirds", "the ceiling is at two thirds of the barrel's rise", {"plane_ratio": 2 / 3}),
    )
    quarter_turn: ClassVar[Symmetry | None] = None

    span: Annotated[float, Range(0.5, 40, "m", "clear width at the springing, across the axis")] = 4.0
    length: Annotated[float, Range(0.5, 100, "m", "extent along the axis")] = 7.0
    profile: Profile = Segmental(0.4)
    plane_ratio: Annotated[float, Range(0.3, 1, "1", "height of the ceiling / rise of the barrel")] = 2 / 3

    @derived("m", "crown of the whole barrel above the springing")
    def barrel_rise(self) -> float:
        return self.profile.rise(self.span / 2)

    @derived("m", "height of the ceiling above the springing")
    def rise(self) -> float:
        return self.plane_ratio * self.barrel_rise

    @property
    def components(self) -> tuple[str, ...]:
        return ("barrel", "ceiling")

    @property
    def plan(self) -> Plan:
        return Plan.rectangle(self.span / 2, self.length / 2, on_wall_x=True)

    def pieces(self) -> tuple[Piece, ...]:
        barrel = BarrelPart(X, self.profile.curve(self.span / 2), ("barrel", "barrel"))
        return (Piece((barrel, Ceiling(self.rise, ("ceiling",)))),)

    @classmethod
    def first_guesses(cls, over: Footprint) -> Iterator[Self]:
        for profile, plane in product(coarse_arches(), (0.5, 0.7, 0.85)):
            yield cls(over.span_x, over.span_y, profile, plane)

    @classmethod
    def drawn(cls, rng: np.random.Generator) -> Self:
        span = rng.uniform(3, 5)
        return cls(span, span * rng.uniform(1.3, 2), Segmental(rng.uniform(0.35, 0.45)), rng.uniform(0.6, 0.8))

    @property
    def itself(self) -> bool:
        return self.plane_ratio < 0.95  # else it is a barrel


SAID = {name: value for name, value in vars(Corridor).items() if name not in {"__dict__", "__weakref__"}}
Run = Callable[..., str]


@pytest.fixture
def known() -> Iterator[None]:
    register(Corridor)
    yield
    FAMILIES.remove(Corridor)


@pytest.fixture
def run(known: None, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Run:
    """What the program says on standard output, or where it refuses on standard error."""
    monkeypatch.setenv("COLUMNS", "200")

    def run(*arguments: object, code: int = 0) -> str:
        capsys.readouterr()
        assert main([str(a) for a in arguments]) == code
        said = capsys.readouterr()
        return said.err if code else said.out

    return run


def test_it_is_no_more_than_a_page() -> None:
    assert len(inspect.getsource(Corridor).splitlines()) <= 80


def test_the_command_line_lists_it_and_samples_it(run: Run, tmp_path: Path) -> None:
    assert "corridoio" in run("families")
    told = run("families", "flurgewölbe")
    for word in ("Italian: corridoio", "barrel, ceiling", "plane_ratio", "barrel_rise", "two-thirds"):
        assert word in told
    assert "--plane-ratio" in run("ideal", "corridor", "--help")
    cloud = tmp_path / "corridor.ply"
    run("ideal", "corridoio", "--span", 5, "--rise", 1.2, "--points", 50_000, "-o", cloud)
    vault = Corridor(span=5.0, plane_ratio=0.6)
    assert np.abs(vault.distance(read(cloud).xyz)).max() < 1e-5
    assert set(np.unique(read_labels(cloud))) == {1, 2}


def test_a_virtual_scan_of_it_is_recognised_and_written_in_all_formats(run: Run, tmp_path: Path) -> None:
    import ifcopenshell
    from build123d import import_step

    scan, out = tmp_path / "room.laz", tmp_path / "out"
    run("scan", "corridor", "--points", 120_000, "--settlement", 0.01, "--seed", 3, "-o", scan)
    component, truth = read_truth(scan)
    assert vault_of(truth) == Corridor()
    run("fit", scan, "-o", out)
    report = json.loads((out / "report.json").read_text())
    (vault,) = report["vaults"]
    assert vault["family"] == "corridor"
    assert vault["parameters"]["rise"]["value"] == pytest.approx(Corridor().rise, abs=0.03)
    labels = read_labels(out / "segments.laz")
    assert compare(labels, component).mean_iou > 0.9
    page = (out / "report.html").read_text()
    assert "Corridor vault" in page
    assert "the level field of a corridor vault" in page
    assert import_step(out / "model.step").volume > 0
    (roof,) = ifcopenshell.open(str(out / "model.ifc")).by_type("IfcRoof")
    assert (roof.Tag, roof.PredefinedType) == ("corridor", "RAINBOW_ROOF")
    for name in ("again.step", "again.ifc", "again.glb", "again.json"):
        run("export", out / "model.json", "-o", tmp_path / name)
    assert (tmp_path / "again.json").read_bytes() == (out / "report.json").read_bytes()


def test_its_sizes_are_fixed_and_its_constraints_let_go(run: Run, tmp_path: Path) -> None:
    cloud, out = tmp_path / "corridor.ply", tmp_path / "out"
    run("ideal", "corridor", "--plane-ratio", 0.7, "--points", 60_000, "-o", cloud)
    asked = ("fit", cloud, "-o", out, "--family", "corridor")
    run(*asked, "--fix", "rise=1.12", "--fix", "profile=segmental", "--free", "two-thirds")
    (vault,) = json.loads((out / "model.json").read_text())["vaults"]
    assert Vault.from_plain(vault).plain()["family"] == "corridor"
    assert vault["estimates"]["rise"]["value"] == pytest.approx(1.12, abs=1e-6)
    assert "barrel_rise" in run(*asked, "--fix", "ris=1", code=2)


@pytest.mark.usefixtures("known")
def test_freecad_is_told_of_it_and_gets_its_body_and_its_file(tmp_path: Path) -> None:
    from vaultcad.workbench.declarations import families
    from vaultcad.workbench.files import export
    from vaultcad.workbench.protocol import Request
    from vaultcad.workbench.shapes import build

    def ask(**asked: object) -> Request:
        return Request({"id": 1, **asked}, lambda stage, share: None)

    (told,) = (one for one in families(ask())["families"] if one["id"] == "corridor")
    assert [size["name"] for size in told["sizes"] if size["decides"]] == ["barrel_rise", "rise"]
    shape = build(ask(family="corridor", thickness=0.2, lengths={"rise": 1.0}, path=str(tmp_path / "corridor.brep")))
    assert shape["sizes"]["rise"] == pytest.approx(1.0)
    assert {"barrel", "ceiling"} <= set(shape["faces"])
    vault = {**Corridor().plain(), "pose": {"x": 0.0, "y": 0.0, "z": 0.0, "yaw": 0.0}}
    for name in ("corridor.step", "corridor.ifc", "corridor.glb"):
        export(ask(path=str(tmp_path / name), vaults=[vault]))
        assert (tmp_path / name).stat().st_size > 0


@pytest.mark.usefixtures("known")
def test_it_is_drawn_and_turned() -> None:
    vault, _ = draw("corridor", np.random.default_rng(1))
    assert isinstance(vault, Corridor)
    assert turned(vault, 1) is None
    assert turned(vault, 2) == ({**vault.values(), **vault.derived_values()}, vault.kinds)


def test_it_is_laid_flat_in_true_lengths_and_lifted_again() -> None:
    vault = Corridor()
    sheet = unrolled(vault)
    assert [leaf.name for leaf in sheet.leaves] == ["barrel", "barrel", "ceiling"]
    assert sheet.distortion < 1e-4
    sample = vault.sample(2000, np.random.default_rng(1))
    place, _ = sheet.lay(sample.xyz, sample.component)
    assert np.abs(sheet.lift(place)[0] - sample.xyz).max() < 1e-6


def test_once_it_is_taken_out_nobody_knows_it() -> None:
    with pytest.raises(ValueError, match="no vault family is called 'corridor'"):
        family("corridor")


@pytest.mark.parametrize("fact", FACTS)
def test_a_family_without_a_fact_is_refused_by_a_sentence(fact: str) -> None:
    with pytest.raises(TypeError, match=f"family Torn lacks `{fact}`: "):
        type("Torn", (Vault,), {name: value for name, value in SAID.items() if name != fact})


@pytest.mark.parametrize(
    ("facts", "said"),
    [
        ({"aliases": {"la": ("ambulacrum",)}}, "`aliases` names 'la'; there are it, fr, de, es"),
        ({"roof_type": "VAULT_ROOF"}, "`roof_type` names 'VAULT_ROOF'; there are FLAT_ROOF"),
        ({"ratios": {"rise": "height_ratio"}}, "`ratios` names 'height_ratio'; there are span, length"),
        ({"held": {"crown": "plane_ratio"}}, "`held` names 'crown'; there are barrel_rise, rise"),
        ({"stands_for": {"rise": lambda rise: {"rise_x": rise}}}, "`stands_for` names 'rise_x'"),
        ({"usual": {"offset_ratio": (0.1, 0.1)}}, "`usual` names 'offset_ratio'"),
        ({"alike": ("profile_x", "profile_y")}, "`alike` names 'profile_x'; there are profile"),
        ({"raised": ("arch",)}, "`raised` names 'arch'; there are profile"),
        ({"half_turn": Symmetry(negated=("shift",))}, "`half_turn` names 'shift'"),
        ({"constraints": (Constraint("low", "", {"level": 0.0}),)}, "`constraints: low` names 'level'"),
        ({"components": ("ceiling",)}, "`pieces` names 'barrel'; there are ceiling"),
        ({"components": ("barrel", "ceiling", "barrel")}, "two of its `components` have one name"),
        ({"rise": 1.0}, "`rise` names 'rise'; there are barrel_rise"),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
def test_a_fact_that_names_what_there_is_not_is_refused(facts: Mapping[str, object], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        check_facts(type("Wrong", (Vault,), {**SAID, **facts}))


def test_no_two_families_have_one_name() -> None:
    before = list(FAMILIES)
    with pytest.raises(ValueError, match="family Botte: 'botte' is a name of Barrel already"):
        register(type("Botte", (Vault,), {**SAID, "aliases": {"it": ("botte",)}}))
    assert before == FAMILIES
