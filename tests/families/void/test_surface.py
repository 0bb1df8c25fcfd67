from math import sqrt

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from families import (
    FAMILIES,
    Annular,
    Barrel,
    BasketHandle,
    Cloister,
    Conch,
    Dome,
    Groin,
    Lunette,
    Mirror,
    Pointed,
    Rotunda,
    Sail,
    Segmental,
    Semicircular,
    Stilted,
    Trough,
    Vault,
)
from families.void import body_table, kernel, profile_distance
from families.void.sampling import sample

Array = NDArray[np.float64]

# The height of each family's intrados over its plan, written down anew from the textbook formulas.


def arch(profile, S, H, u):
    """Height at |u| <= S of an arch of half span S and rise H."""
    u = np.minimum(np.abs(u), S)
    if H < S and isinstance(profile, Semicircular | Segmental | Pointed | Stilted):
        R = (S * S + H * H) / (2 * H)
        return np.sqrt(np.maximum(R * R - u * u, 0)) - (R - H)
    if isinstance(profile, Pointed):
        R = (S * S + H * H) / (2 * S)
        return np.sqrt(np.maximum(R * R - (u + R - S) ** 2, 0))
    if isinstance(profile, Stilted):
        return H - S + np.sqrt(np.maximum(S * S - u * u, 0))
    if isinstance(profile, BasketHandle) and H < S:
        r = profile.haunch_ratio * H
        R = (S * S + H * H - 2 * S * r) / (2 * (H - r))
        haunch = np.sqrt(np.maximum(r * r - (u - S + r) ** 2, 0))
        crown = np.sqrt(np.maximum(R * R - u * u, 0)) - (R - H)
        return np.where(u > (S - r) * R / (R - r), haunch, crown)
    return H * np.sqrt(np.maximum(1 - (u / S) ** 2, 0))


def height(vault, x, y):
    """Height (n,) of the void at plan points x, y (n,)."""
    return TOPS[type(vault)](vault, x, y)


def own(profile, S, u):
    return arch(profile, S, profile.rise(S), u)


def sail(v, x, y):
    R = v.radius
    return np.sqrt(R * R - x * x - y * y) - (R - v.rise)


def barrel(v, x, y):
    return own(v.profile, v.span / 2, x)


def lunette(v, x, y):
    top = own(v.profile, v.span / 2, x)
    S = v.lunette_span / 2
    for place in v.positions:
        over = v.lunette_springing + own(v.lunette_profile, S, y - place)
        top = np.where(np.abs(y - place) < S, np.maximum(top, over), top)
    return top


def cove(profile, half, run, H, u):
    """Height of one cove against the wall at u = half; none where it is level."""
    return np.where(u > half - run, arch(profile, run, H, u - (half - run)), np.inf)


def trough(v, x, y):
    half = v.span_y / 2
    south, north = (cove(v.profile, half, run, v.rise, u) for run, u in ((v.south_run, -y), (v.north_run, y)))
    return np.minimum(own(v.profile, v.span_x / 2, x), np.minimum(south, north))


def mirror(v, x, y):
    top = np.full_like(x, v.rise)
    for half, run, u in ((v.span_x / 2, v.run_x, np.abs(x)), (v.span_y / 2, v.run_y, np.abs(y))):
        top = np.minimum(top, cove(Segmental(), half, run, v.cove_rise, u))
    return top


def groin(v, x, y):
    top = np.zeros_like(x)
    half_x, half_y = v.span_x / 2 + v.offset_x, v.span_y / 2 + v.offset_y
    for profile, S, u, way in ((v.profile_x, v.span_x / 2, x, y / half_y), (v.profile_y, v.span_y / 2, y, x / half_x)):
        over = own(profile, S, u) + v.crown_rise * (1 - way**2)
        top = np.where(np.abs(u) < S, np.maximum(top, over), top)
    return top


def dome(v, x, y):
    rho, below = np.hypot(x, y), v.pendentive_ratio * v.radius
    ball = np.sqrt(np.maximum(2 * v.radius**2 + below**2 - rho**2, 0)) - below
    ring = v.radius * (sqrt(1 + v.pendentive_ratio**2) - v.pendentive_ratio)
    inside = rho < v.radius
    return np.where(inside, ring + v.drum_height + own(v.profile, v.radius, rho), ball)


def cloister(v, x, y):
    top = np.full_like(x, np.inf)
    for side in v.polygon.sides:
        u = x * side.normal[0] + y * side.normal[1]
        top = np.minimum(top, cove(v.profile, side.offset, side.offset, v.profile.rise(v.radius), u))
    return v.drum_height + top


def rotunda(v, x, y):
    return v.drum_height + own(v.profile, v.radius, np.hypot(x, y))


def conch(v, x, y):
    return own(v.profile, v.radius, np.hypot(x, y + v.radius / 2))


def annular(v, x, y):
    centre = v.plan.sides[0].centre
    return own(v.profile, v.span / 2, np.hypot(x - centre[0], y - centre[1]) - v.radius)


TOPS = {
    Cloister: cloister,
    Conch: conch,
    Annular: annular,
    Rotunda: rotunda,
    Sail: sail,
    Barrel: barrel,
    Lunette: lunette,
    Trough: trough,
    Mirror: mirror,
    Groin: groin,
    Dome: dome,
}


def plan_points(vault, n, rng):
    xy = vault.plan.half * rng.uniform(-0.999, 0.999, (n, 2))
    return xy[vault.plan.distance(xy) < -1e-3].T


def test_the_surface_is_where_the_textbook_has_it(textbook_vault):
    x, y = plan_points(textbook_vault, 4000, np.random.default_rng(1))
    z = height(textbook_vault, x, y)
    x, y, z = np.array([x, y, z])[:, z > 0]  # wall arches outside both springings leave piers at the corners
    assert (textbook_vault.distance(np.c_[x, y, z - 1e-6]) < 0).all()
    assert (textbook_vault.distance(np.c_[x, y, z + 1e-6]) > 0).mean() > 0.999  # not over an edge of a lunette's wall
    steep = np.abs(textbook_vault.distance(np.c_[x, y, z]))
    assert steep.max() < 1e-6


def test_room_and_stone_are_told_apart(textbook_vault):
    rng = np.random.default_rng(2)
    x, y = plan_points(textbook_vault, 20_000, rng)
    z = rng.uniform(0, 1.3 * height(textbook_vault, x, y).max(), len(x))
    gap = z - height(textbook_vault, x, y)
    clear = np.abs(gap) > 1e-6
    assert (np.sign(textbook_vault.distance(np.c_[x, y, z]))[clear] == np.sign(gap)[clear]).all()


def test_distance_normal_and_component_hold_beside_the_surface(textbook_vault):
    points = sample(textbook_vault, 3000, np.random.default_rng(3))
    # Along a curved axis the normal turns, and the distance is exact only at the surface.
    bent = getattr(textbook_vault, "crown_rise", 0) > 0
    for step in (0.02, -0.02):
        there = textbook_vault.evaluate(points.xyz - step * points.normals)
        # Next to an edge another component may be nearer.
        turned = np.abs(there.normal + points.normals).max(axis=1)
        kept = (there.component == points.component) & (turned < (0.01 if bent else 1e-6))
        assert kept.mean() > 0.85
        exact = np.abs(there.distance[kept] - step) < (1e-4 if bent else 1e-9)
        assert exact.mean() > 0.98  # in the room just under the ring of a dome it is less than it should be


def test_the_distance_never_says_more_than_there_is(textbook_vault):
    rng = np.random.default_rng(4)
    points = sample(textbook_vault, 4000, rng).xyz
    other = (points + rng.normal(0, 0.3, points.shape))[:600]
    other = other[other[:, 2] > 0]
    nearest = cKDTree(points).query(other)[0]
    bent = getattr(textbook_vault, "crown_rise", 0) > 0
    assert (np.abs(textbook_vault.distance(other)) <= nearest * (1.1 if bent else 1) + 1e-3).all()


def test_a_frame_moves_the_vault(default_vault):
    rng = np.random.default_rng(5)
    points = rng.normal(0, 3, (500, 3))
    turn, shift = np.linalg.qr(rng.normal(size=(3, 3)))[0], rng.normal(size=3)
    frame = np.c_[turn, shift]
    here, there = default_vault.evaluate(points, frame=frame), default_vault.evaluate(points @ turn.T + shift)
    assert here.distance == pytest.approx(there.distance, abs=1e-9)
    assert (here.component == there.component).mean() > 0.99
    assert here.normal == pytest.approx(there.normal @ turn, abs=1e-6)
    assert default_vault.distance(points, frame=frame) == pytest.approx(here.distance, abs=1e-12)


def test_the_walls_of_the_room_have_no_component(default_vault):
    plan = default_vault.plan
    middles = np.array([[*side.points(4)[1], -0.5] for side in plan.sides])
    seen = default_vault.evaluate(middles, walls=True)
    assert not seen.component.any()
    assert seen.distance == pytest.approx(0, abs=1e-12)
    inside = default_vault.evaluate(middles - 0.01 * seen.normal, walls=True)
    assert inside.distance == pytest.approx(-0.01)
    straight = [k for k, side in enumerate(plan.sides) if side.centre is None]
    assert seen.normal[straight, :2] == pytest.approx(np.array([plan.sides[k].normal for k in straight]).reshape(-1, 2))
    points = sample(default_vault, 2000, np.random.default_rng(6))
    inside = plan.distance(points.xyz[:, :2]) < -0.01
    assert (default_vault.evaluate(points.xyz[inside], walls=True).component == points.component[inside]).all()


@pytest.mark.parametrize(
    ("vault", "point", "component"),
    [
        (Sail(), (0, 0, 9), "sail"),
        (Barrel(), (1, 3, 2), "barrel"),
        (Lunette(), (-2.4, -3, 1), "lunette_west_1"),
        (Lunette(), (2.4, 3, 1), "lunette_east_3"),
        (Trough(), (0, -3.9, 0.3), "south"),
        (Trough(south_ratio=1.0, north_ratio=1.0), (2.4, 0, 0.3), "east"),
        (Mirror(), (0, 0, 1.0), "plane"),
        (Mirror(), (-2.4, 0, 0.2), "cove_west"),
        (Groin(), (0, -2.4, 2.5), "web_south"),
        (Groin(), (2.4, 0, 2.5), "web_east"),
        (Groin(crown_rise_ratio=0.2), (0.0, 0.3, 3.0), "web_north"),
        (Dome(), (0, 0, 7), "dome"),
        (Dome(), (3, 0, 3.5), "drum"),
        (Dome(), (2.4, -2.4, 2), "pendentive_south_east"),
    ],
)
def test_components_lie_where_their_names_say(vault, point, component):
    seen = vault.evaluate(np.array([point], float))
    assert vault.components[seen.component[0] - 1] == component


def test_points_of_another_shape_are_refused():
    with pytest.raises(ValueError, match=r"\(4, 2\).*\(n, 3\)"):
        Barrel().distance(np.zeros((4, 2)))


def test_float32_and_no_points_at_all_are_fine():
    assert Barrel().distance(np.zeros((0, 3))).shape == (0,)
    assert Barrel().distance(np.array([[0, 0, 2.0]], np.float32)) == pytest.approx([-0.5])


@pytest.mark.parametrize("cls", FAMILIES, ids=lambda c: c.id)
def test_slopes_are_those_of_the_distances(cls: type[Vault]) -> None:
    vault, step = cls(), 1e-6
    frame, table, plan = (
        np.eye(3, 4),
        body_table.pack(vault.pieces(), vault.components),
        body_table.pack_plan(vault.plan),
    )
    points = np.random.default_rng(7).uniform(-1.1, 1.1, (40_000, 3)) * [vault.plan.half_x, vault.plan.half_y, 3.0]
    points = points[np.abs(vault.distance(points)) < 0.02]
    values, names = vault.values(), [p.name for p in vault.parameters() if not p.integer]
    moved = [
        vault.replaced({name: values[name] + step}) for name in names if values[name] + step <= high_of(vault, name)
    ]
    tables = [(body_table.pack(other.pieces(), other.components), body_table.pack_plan(other.plan)) for other in moved]
    same = [pair for pair in tables if pair[0].shape == table.shape and pair[1].shape == plan.shape]
    bodies, outlines = (np.stack([pair[k] for pair in same]) for k in range(2))
    slopes = kernel.slopes(points, frame, table, plan, bodies, outlines, np.full(len(same), step))
    assert np.linalg.norm(slopes[:, :3], axis=1) == pytest.approx(1.0, abs=1e-9)
    here = kernel.distances(points, frame, table, plan)
    shifted = [points - step * axis for axis in np.eye(3)] + [points @ turned(-step).T]
    pose = [kernel.distances(there, frame, table, plan) for there in shifted]
    all_others = np.stack([*pose, *(kernel.distances(points, frame, *pair) for pair in same)], axis=1)
    off = np.abs((all_others - here[:, None]) / step - slopes)
    told = (
        off[:, 4:] if body_table.WEB in table[:, body_table.KIND] else off
    )  # where distances grow as fast as one goes
    assert (told < 0.01).mean(axis=0).min() > 0.98  # but where another body decides after the step


def high_of(vault: Vault, name: str) -> float:
    return next(p.range.high for p in vault.parameters() if p.name == name)


def turned(yaw: float) -> Array:
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def test_the_distance_to_an_ellipse_holds_near_and_far() -> None:
    rng = np.random.default_rng(8)
    angle = np.linspace(0, np.pi / 2, 20_001)
    for a, b in ((2.0, 0.7), (0.8, 2.4), (1.5, 1.5 + 1e-9)):
        on = np.column_stack([a * np.cos(angle), b * np.sin(angle)])
        for u, z in rng.uniform(0, 3, (50, 2)):
            nearest = np.hypot(*(on - [u, z]).T).min()
            assert abs(profile_distance.to_ellipse(u, z, a, b)[0]) == pytest.approx(nearest, abs=1e-4)
