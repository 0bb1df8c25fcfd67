"""What a fit may move: fixed sizes, constraints by name, and the words in which they are asked for."""

from __future__ import annotations

import numpy as np
import pytest

from families import (
    FAMILIES,
    Barrel,
    Cloister,
    Dome,
    Groin,
    Mirror,
    Pointed,
    Rib,
    Rotunda,
    Sail,
    Segmental,
    Semicircular,
    Trough,
    Vault,
    profile,
)
from families.declaration.constraints import Constraint
from segmentation.cloud import Cloud
from vaultcad.errors import NoVaultError
from vaultcad.fit.demands import constraints_of, demand, sizes_of
from vaultcad.fit.freedom import SPRINGING, Demands, decides
from vaultcad.model import FittedVault
from vaultcad.pipeline import FitSettings, fit_scan
from vaultcad.pose import Pose

EACH = pytest.mark.parametrize("cls", FAMILIES, ids=lambda c: c.id)
CONSTRAINED = [(cls, c) for cls in FAMILIES for c in cls.constraints]


def cloud(vault: Vault, origin: tuple[float, ...] = (0.0, 0.0, 0.0)) -> Cloud:
    turn = Pose(0.3, -0.2, 2.9, 0.2).placement()
    xyz = vault.sample(60_000, np.random.default_rng(1)).xyz @ turn[:3, :3].T + turn[:3, 3]
    return Cloud(xyz.astype(np.float32), np.array(origin))


def fitted(vault: Vault, origin: tuple[float, ...] = (0.0, 0.0, 0.0), **settings: object) -> FittedVault:
    chosen = FitSettings(families=(type(vault),), **settings)  # type: ignore[arg-type]
    return fit_scan(cloud(vault, origin=origin), chosen).model.vaults[0]


@EACH
def test_constraints_are_named_once_and_hold_parameters_of_their_family(cls: type[Vault]) -> None:
    names = [c.name for c in constraints_of(cls)]
    assert len(set(names)) == len(names)
    for kind in (Segmental, Pointed):
        vault = cls(**{name: kind() for name, value in vars(cls()).items() if name.startswith("profile")})
        for constraint in cls.constraints:
            kept = vault.replaced(constraint.holds(vault))
            assert kept.values() == pytest.approx({**kept.values(), **constraint.holds(kept)}), constraint.name


@pytest.mark.parametrize(("cls", "constraint"), CONSTRAINED, ids=lambda value: getattr(value, "name", value))
def test_what_a_constraint_holds_does_not_move_and_what_is_let_go_does(
    cls: type[Vault], constraint: Constraint
) -> None:
    vault = cls(profile_x=Segmental(), profile_y=Segmental()) if cls is Groin else cls()
    held = set(constraint.holds(vault))
    assert held
    assert not held & set(Demands().freedom(vault, [constraint]).names)
    freed = Demands(freed=frozenset([constraint.name]))
    assert constraint not in freed.keepable(vault)
    assert held <= set(freed.freedom(vault, freed.begun_with(vault)).names)


@EACH
def test_every_size_can_be_fixed_and_is_then_met(cls: type[Vault]) -> None:
    for name in sizes_of(cls):
        demands = Demands({name: made(cls, name)})
        vault = demands.suited(cls())
        assert vault is not None
        assert demands.met(demands.begun(vault)), name


def made(cls: type[Vault], name: str) -> float:
    """A value that a size has in some vault of a family."""
    for kind in (Segmental, Pointed, Semicircular):
        profiles = {n: kind() for n, v in vars(cls()).items() if hasattr(v, "curve")}
        vault = cls(**profiles)
        values = {**vault.derived_values(), **vault.values()}
        if name in values:
            return values[name]
    return 0.7  # the haunches of a basket-handle


def test_names_that_are_none_are_refused_with_those_that_are() -> None:
    ris = r"no size 'ris' to fix; there are span_x, .*yaw, profile_x, profile_y; did you mean rise"
    with pytest.raises(ValueError, match=ris):
        demand((Groin,), {"ris": 2.0}, ())
    with pytest.raises(ValueError, match=r"no size 'rize' to fix; did you mean rise.* lists those"):
        demand(FAMILIES, {"rize": 2.0}, ())
    with pytest.raises(
        ValueError, match=r"no constraint .level. to let go; there are springing, bays, rectangle, level"
    ):
        demand((Groin,), {}, ["level"])
    with pytest.raises(ValueError, match=r"rise_ratio = 3 cannot be; it is 0.1 to 1 1"):
        demand((Sail,), {"rise_ratio": 3.0}, ())
    with pytest.raises(ValueError, match="no family has all of drum_height, crown_rise"):
        demand(FAMILIES, {"drum_height": 1.0, "crown_rise": 0.1}, ())


def test_only_families_that_have_the_size_are_tried() -> None:
    families, demands = demand(FAMILIES, {"drum_height": 1.0, "x": 512_001.0}, ["no drum"], (512_000.0, 0.0, 0.0))
    assert families == (Dome, Cloister, Rotunda)
    assert (demands.sizes, demands.pose, demands.freed) == ({"drum_height": 1.0}, {"x": 1.0}, {"no-drum"})


def test_arches_are_fixed_by_any_of_their_names() -> None:
    families, demands = demand(FAMILIES, {"profile_x": "tutto sesto", "rise": 2.0}, ())
    assert families == (Groin, Rib)
    assert (demands.arches, demands.sizes) == ({"profile_x": Semicircular}, {"rise": 2.0})
    with pytest.raises(ValueError, match="no arch 'profile_z' to fix; there are profile, lunette_profile, profile_x"):
        demand(FAMILIES, {"profile_z": "pointed"}, ())
    with pytest.raises(ValueError, match="no profile is called 'round'"):
        demand(FAMILIES, {"profile": "round"}, ())
    with pytest.raises(ValueError, match="no family has all of span_y, lunette_profile"):
        demand(FAMILIES, {"span_y": 3.0, "lunette_profile": "pointed"}, ())


@pytest.mark.parametrize(
    ("vault", "fix"),
    [
        (Barrel(4.0, 6.0, Segmental(0.46)), {"profile": "semicircular"}),
        (Barrel(4.0, 6.0, Segmental(0.46)), {"profile": "ellittico", "rise": 1.9}),
        (Groin(4.6, 5.0, Segmental(0.42), Segmental(0.4)), {"profile_x": "elliptical"}),
    ],
    ids=lambda value: getattr(value, "id", None),
)
def test_a_fixed_arch_is_the_only_one(vault: Vault, fix: dict[str, float | str]) -> None:
    found = fitted(vault, fix=fix)
    for name, kind in fix.items():
        if isinstance(kind, str):
            assert found.odds[name] == {profile(kind).id: pytest.approx(1.0)}
            assert found.arches[name] == found.vault.profiles[name].id == profile(kind).id


@pytest.mark.parametrize(
    ("vault", "fix"),
    [
        (Groin(4.6, 5.0, Segmental(0.42), Segmental(0.4)), {"rise": 1.9}),
        (Trough(4.4, 7.0, Segmental(0.4), 0.6, 0.6), {"rise": 1.8, "south_run": 2.0}),
        (Dome(2.4, Semicircular(), 0.5), {"rise": 5.9}),
        (Barrel(4.0, 6.0, Pointed(0.7)), {"rise_ratio": 0.71}),
        (Mirror(4.0, 6.0), {"cove_rise": 0.75}),
    ],
    ids=lambda value: getattr(value, "id", None),
)
def test_a_fixed_size_comes_out_as_it_was_fixed_and_the_rest_gives_way(vault: Vault, fix: dict[str, float]) -> None:
    found = fitted(vault, fix=fix)
    for name, value in fix.items():
        assert found.parameters[name].value == pytest.approx(value, abs=1e-6)
        assert found.parameters[name].std is None
    assert found.deviation.p95 < 0.08


def test_parts_of_the_pose_are_fixed_in_the_coordinates_of_the_scan() -> None:
    origin = (512_000.0, 4_712_000.0, 80.0)
    fix = {"x": 512_000.31, "y": 4_711_999.81, "springing": 82.88, "yaw": 0.21}
    pose = fitted(Groin(4.6, 5.0), origin, fix=fix).pose
    assert (pose.x, pose.y, pose.z, pose.yaw) == pytest.approx((0.31, -0.19, 2.88, 0.21), abs=1e-6)


def test_a_size_that_no_vault_there_can_have_is_refused() -> None:
    with pytest.raises(NoVaultError, match="fix other sizes"):
        fitted(Barrel(4.0, 6.0, Segmental(0.3)), fix={"rise": 40.0})


def test_a_constraint_is_kept_where_it_holds_and_let_go_on_demand() -> None:
    vault = Trough(4.4, 7.0, Segmental(0.4), 0.6, 0.6)
    kept, freed = fitted(vault), fitted(vault, free=("equal-heads",))
    assert kept.parameters["north_ratio"].value == kept.parameters["south_ratio"].value
    assert freed.parameters["north_ratio"].value != freed.parameters["south_ratio"].value
    assert freed.parameters["north_ratio"].value == pytest.approx(0.6, abs=2e-3)


def test_a_constraint_that_the_scan_refutes_is_let_go() -> None:
    found = fitted(Trough(4.4, 7.0, Segmental(0.4), 0.5, 0.7))
    assert sorted(found.parameters[n].value for n in ("south_ratio", "north_ratio")) == pytest.approx(
        [0.5, 0.7], abs=2e-3
    )


def test_all_families_share_the_springing_and_know_what_decides_a_rise() -> None:
    assert all(constraints_of(cls)[0] is SPRINGING for cls in FAMILIES)
    assert all("rise" in decides(cls) or cls is Groin for cls in FAMILIES)


@pytest.mark.parametrize(("cls", "constraint"), CONSTRAINED, ids=lambda value: getattr(value, "name", value))
def test_a_constraint_that_is_let_go_leaves_a_vault_within_its_ranges(cls: type[Vault], constraint: Constraint) -> None:
    small = {p.name: p.range.low for p in cls().parameters() if p.name.startswith("span") or p.name == "length"}
    for vault in (cls(), cls().replaced(small)):
        vault.replaced(constraint.let_go(vault))


def test_springings_are_looked_for_inside_the_wall_arches() -> None:
    vault = Groin(4.0, 5.0)
    flush = next(c for c in Groin.constraints if c.name == "flush-y")
    begun = vault.replaced(flush.let_go(vault))
    assert begun.plan.half_y == pytest.approx(vault.plan.half_y)
    assert begun.span_y < vault.span_y
