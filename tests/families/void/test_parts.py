"""Free-standing parts in any direction, sloped, splayed and turned: distances, samples and areas."""

from math import cos, pi, sin

import numpy as np
import pytest

from families.declaration.pieces import Ball, BarrelPart, Part, Piece, Turned
from families.declaration.plan import Plan
from families.declaration.profiles import PROFILES, Elliptical, Pointed, Semicircular
from families.declaration.vault import IDENTITY
from families.void import body_table, kernel
from families.void.sampling_strips import strips

PLAN = Plan.polygon(((-3.0, -2.0), (3.5, -2.5), (2.5, 3.0), (-2.0, 2.0)))
ROUND = Plan.sector(2.0, 5.0, 2.5)
NAMES = ("a", "b", "wall")


def direction(angle: float) -> tuple[float, float]:
    return cos(angle), sin(angle)


def barrel(**given: object) -> BarrelPart:
    return BarrelPart(direction(0.7), Semicircular().curve(1.5), ("a", "b"), origin=(0.3, -0.2), **given)  # type: ignore[arg-type]


PARTS: dict[str, tuple[Part, Plan]] = {
    "barrel": (barrel(), PLAN),
    "one side": (barrel(side=-1, below="wall", base=0.4), PLAN),
    "sloped": (barrel(slope=0.3), PLAN),
    "raised": (barrel(crown_rise=0.4, half_length=3.0, slope=-0.1), PLAN),
    "splayed": (barrel(splay=0.15), PLAN),
    "cone": (barrel(splay=-0.2, flare=-0.2, slope=0.1, base=0.3), PLAN),
    "flared": (barrel(flare=0.1, splay=-0.05), PLAN),
    "apex within": (barrel(splay=0.6, flare=0.6), PLAN),
    **{
        f"{profile.id} cone": (BarrelPart(direction(4.0), profile().curve(1.2), ("a", "b"), splay=0.1, flare=0.1), PLAN)
        for profile in PROFILES
    },
    "pointed one side": (BarrelPart(direction(2.0), Pointed().curve(1.2), ("a", "b"), side=1, splay=0.2), PLAN),
    "ball": (Ball(0.5, 2.0, ("a",), (0.4, -0.3)), PLAN),
    "dome": (Turned(Elliptical(0.7).curve(1.5), 0.8, ("wall", "a"), (0.2, 0.1)), PLAN),
    "annular": (Turned(Pointed().curve(1.5), 0.5, ("wall", "a"), radius=3.5), ROUND),
}


@pytest.fixture(params=PARTS.values(), ids=PARTS)
def alone(request: pytest.FixtureRequest) -> tuple[Part, Plan]:
    part, plan = request.param
    return part, plan


def laid(part: Part, plan: Plan, count: int = 2000) -> tuple[np.ndarray, np.ndarray]:
    a = (np.arange(count) + 0.5) / count
    b = np.arange(count) * 0.6180339887 % 1
    found = [strip.lay(a, b) for strip in strips(part, plan) if strip.area > 1e-9]
    return np.concatenate([xyz for xyz, _ in found]), np.concatenate([normal for _, normal in found])


def distances(part: Part, xyz: np.ndarray) -> np.ndarray:
    return kernel.distances(xyz, IDENTITY, body_table.pack((Piece((part,)),), NAMES), body_table.pack_plan(None))


def test_samples_lie_on_a_part_and_have_its_normals(alone: tuple[Part, Plan]) -> None:
    xyz, normal = laid(*alone)
    table = body_table.pack((Piece((alone[0],)),), NAMES)
    distance, component, seen = kernel.surface(xyz, IDENTITY, table, body_table.pack_plan(None))
    assert np.abs(distance).max() < 1e-9
    assert component[xyz[:, 2] > 0].all()
    # On the axis of one side, and where two arcs meet, either normal will do.
    assert (np.abs(seen - normal).max(axis=1) < 1e-6).mean() > 0.99


def test_the_distance_grows_by_a_step_along_the_normal(alone: tuple[Part, Plan]) -> None:
    xyz, normal = laid(*alone)
    step = 1e-6
    clear = (distances(alone[0], xyz - step * normal) < 0) & np.isfinite(distances(alone[0], xyz - step * normal))
    grown = (distances(alone[0], xyz + step * normal) - distances(alone[0], xyz - step * normal)) / (2 * step)
    assert clear.mean() > 0.99
    assert np.quantile(np.abs(grown[clear] - 1), 0.99) < 1e-4


def test_the_distance_is_no_less_than_a_third_and_no_more_than_there_is(alone: tuple[Part, Plan]) -> None:
    part, plan = alone
    xyz, normal = laid(part, plan)
    for step in (0.1, 0.3):
        beyond = distances(part, xyz + step * normal)
        assert (beyond > step / 3).mean() > 0.99
        assert (beyond < 1.1 * step).mean() > 0.99


def test_the_area_of_strips_is_that_of_a_mesh(alone: tuple[Part, Plan]) -> None:
    for strip in strips(*alone):
        # A sum over triangles laid on a fine net of the strip's own square.
        n = 240
        share = np.linspace(0, 1, n + 1)
        a, b = (column.ravel() for column in np.meshgrid(share, share, indexing="ij"))
        grid = strip.lay(a, b)[0].reshape(n + 1, n + 1, 3)
        p, q, r, s = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
        cells = (np.linalg.norm(np.cross(q - p, r - p), axis=2) + np.linalg.norm(np.cross(r - p, s - p), axis=2)) / 2
        assert cells.sum() == pytest.approx(strip.area, rel=3e-4)
        even = cells[1:-1, 1:-1] / (strip.area / n**2)
        assert np.quantile(np.abs(even - 1), 0.95) < 0.03


@pytest.mark.parametrize(
    "plan",
    [
        Plan.rectangle(2.0, 3.0),
        PLAN,
        Plan.disc(2.0),
        Plan.half_disc(3.0),
        Plan.sector(1.0, 3.0, 1.2),
        Plan.sector(1.0, 3.0, 4.5),
        Plan.sector(1.0, 3.0, 2 * pi),
    ],
    ids=["rectangle", "quadrilateral", "disc", "half disc", "sector", "notched sector", "ring"],
)
def test_walls_stand_on_the_sides_of_the_plan(plan: Plan) -> None:
    xyz = np.random.default_rng(1).uniform(-4, 4, (5000, 3))
    table = body_table.pack((Piece((Ball(50.0, 100.0, ("a",)),)),), NAMES)  # as good as no vault
    walls, frame = body_table.pack_plan(plan), IDENTITY
    distance, component, normal = kernel.surface(xyz, frame, table, walls)
    assert distance == pytest.approx(plan.distance(xyz[:, :2]), abs=1e-12)
    assert not component.any()
    assert np.linalg.norm(normal, axis=1) == pytest.approx(1.0, abs=1e-12)
    none = np.empty((0, *table.shape)), np.empty((0, *walls.shape)), np.empty(0)
    assert kernel.slopes(xyz, frame, table, walls, *none)[:, :3] == pytest.approx(-normal, abs=1e-12)
    moved = plan.distance(xyz[:, :2] + 1e-6 * normal[:, :2])
    assert np.quantile(np.abs((moved - distance) / 1e-6 - 1), 0.99) < 1e-4


def test_the_walls_below_one_side_of_a_barrel_may_have_a_name() -> None:
    part, _ = PARTS["one side"]
    xyz, _ = laid(part, PLAN)
    table = body_table.pack((Piece((part,)),), NAMES)
    component = kernel.surface(xyz, IDENTITY, table, body_table.pack_plan(None))[1]
    assert ((component == 3) == (xyz[:, 2] <= 0.4)).all()
    assert set(component) == {1, 2, 3}
