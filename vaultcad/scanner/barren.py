"""Scenes without a vault, as people scan them: what a fit has to refuse."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import cos, pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from vaultcad.scanner.settings import ScannerSettings
from vaultcad.scanner.shoot import aim, sweep
from vaultcad.scanner.triangles import Triangles, box, join, plain, rectangle, tube
from vaultcad.scanner.waves import draw_waves

Array = NDArray[np.float64]
Random = np.random.Generator

PILOT = 2 * pi / 180  # step [rad] of the sweep that tells how many beams yield points
FARTHEST = 40.0  # m; what a scanner outdoors still keeps
STONE, PAINT, EARTH, LEAVES = 0.4, 0.7, 0.3, 0.35  # reflectance


@dataclass(frozen=True, eq=False)
class BarrenScene:
    """What stands there, z up [m], and where the scanner stands (k, 3) [m]."""

    mesh: Triangles
    stations: Array


def draw_barren(kind: str, rng: Random, points: int = 80_000) -> Array:
    """Points (n, 3) [m] of a scan of a scene of a kind in SCENES, turned about the vertical.

    Raises:
        KeyError: no such kind.
        MissingLibraryError: open3d is missing, see `vaultcad.scanner.shoot.aim`.
    """
    scene = SCENES[kind](rng)
    settings = ScannerSettings(noise=rng.uniform(0.001, 0.004), points=points)
    target = aim(scene.mesh, rng)
    bounds = np.array([[-FARTHEST] * 3, [FARTHEST] * 3])
    pilot = sum(len(s.xyz) for at in scene.stations for s in sweep(target, at, PILOT, settings, bounds, rng))
    step = PILOT * sqrt(max(pilot, 1) / points)
    shots = [s.xyz for at in scene.stations for s in sweep(target, at, step, settings, bounds, rng)]
    return np.concatenate(shots) @ _turn(rng.uniform(-pi, pi)).T


def _turn(yaw: float) -> Array:
    return np.array([[cos(yaw), -sin(yaw), 0], [sin(yaw), cos(yaw), 0], [0, 0, 1]])


def _room(a: float, b: float, height: float) -> list[Triangles]:
    """Floor, walls and level ceiling of a room about the origin."""
    x, y = a / 2, b / 2
    return [
        rectangle([-x, -y, 0], [a, 0, 0], [0, b, 0], EARTH),
        rectangle([-x, -y, height], [a, 0, 0], [0, b, 0], PAINT),
        *_walls(a, b, height),
    ]


def _walls(a: float, b: float, height: float) -> list[Triangles]:
    x, y, up = a / 2, b / 2, [0, 0, height]
    return [
        rectangle([-x, -y, 0], [a, 0, 0], up, PAINT),
        rectangle([-x, y, 0], [a, 0, 0], up, PAINT),
        rectangle([-x, -y, 0], [0, b, 0], up, PAINT),
        rectangle([x, -y, 0], [0, b, 0], up, PAINT),
    ]


def _furniture(a: float, b: float, rng: Random) -> Iterator[Triangles]:
    for _ in range(int(rng.integers(0, 8))):
        w, d, h = rng.uniform([0.4, 0.4, 0.4], [1.6, 1.0, 1.9])
        x, y = rng.uniform(-0.5, 0.5, 2) * (a - w, b - d)
        if abs(x) > 0.8 or abs(y) > 0.8:
            yield box([x - w / 2, y - d / 2, 0], [x + w / 2, y + d / 2, h], STONE)


def _inside(a: float, b: float, rng: Random, height: float = 1.5) -> Array:
    """One to three stations about the middle."""
    places = rng.uniform(-0.3, 0.3, (int(rng.integers(1, 4)), 2)) * (a, b)
    places[0] *= 0.2
    return np.column_stack([places, np.full(len(places), height)])


def _office(rng: Random) -> BarrenScene:
    a, b, height = rng.uniform([4, 5, 2.5], [9, 14, 4])
    parts = [*_room(a, b, height), *_furniture(a, b, rng)]
    parts += CEILINGS[str(rng.choice(list(CEILINGS)))](a, b, height, rng)
    return BarrenScene(join(parts), _inside(a, b, rng))


def _beams(a: float, b: float, height: float, rng: Random) -> Iterator[Triangles]:
    depth, width, every = rng.uniform([0.12, 0.12, 0.8], [0.6, 0.4, 2.5])
    for y in np.arange(-b / 2 + every / 2, b / 2, every):
        yield box([-a / 2, y - width / 2, height - depth], [a / 2, y + width / 2, height], STONE)


def _coffers(a: float, b: float, height: float, rng: Random) -> Iterator[Triangles]:
    depth, width, every = rng.uniform([0.12, 0.15, 1.0], [0.5, 0.4, 2.2])
    for y in np.arange(-b / 2 + every / 2, b / 2, every):
        yield box([-a / 2, y - width / 2, height - depth], [a / 2, y + width / 2, height], STONE)
    for x in np.arange(-a / 2 + every / 2, a / 2, every):
        yield box([x - width / 2, -b / 2, height - depth], [x + width / 2, b / 2, height], STONE)


def _ducts(a: float, b: float, height: float, rng: Random) -> Iterator[Triangles]:
    for _ in range(int(rng.integers(1, 5))):
        radius, x = rng.uniform(0.1, 0.4), rng.uniform(-0.4, 0.4) * a
        z = height - radius - rng.uniform(0.05, 0.3)
        yield tube([x, -b / 2, z], [x, b / 2, z], (radius, radius), STONE)
    for _ in range(int(rng.integers(0, 3))):
        w, h, y = rng.uniform([0.3, 0.2, -0.4], [0.9, 0.5, 0.4])
        yield box([-a / 2, y * b - w / 2, height - h - 0.1], [a / 2, y * b + w / 2, height - 0.1], STONE)


def _panels(a: float, b: float, height: float, rng: Random) -> Iterator[Triangles]:
    drop, margin = rng.uniform([0.1, 0.2], [0.6, 1.2])
    yield box(
        [-a / 2 + margin, -b / 2 + margin, height - drop], [a / 2 - margin, b / 2 - margin, height - drop + 0.05], PAINT
    )
    for _ in range(int(rng.integers(0, 6))):
        x, y = rng.uniform(-0.4, 0.4, 2) * (a, b)
        z = height - drop - rng.uniform(0.2, 0.6)
        yield box([x - 0.6, y - 0.15, z], [x + 0.6, y + 0.15, z + 0.08], PAINT)


def _nothing(a: float, b: float, height: float, rng: Random) -> Iterator[Triangles]:
    yield from ()


CEILINGS: dict[str, Callable[[float, float, float, Random], Iterator[Triangles]]] = {
    "plain": _nothing,
    "beams": _beams,
    "coffers": _coffers,
    "ducts": _ducts,
    "panels": _panels,
}


def _corridor(rng: Random) -> BarrenScene:
    a, b, height = rng.uniform([1.4, 8, 2.3], [3, 25, 3.5])
    parts = _room(a, b, height)
    for y in np.arange(-b / 2 + 1, b / 2 - 1, rng.uniform(2, 5)):
        parts.append(box([a / 2 - 0.05, y, 0], [a / 2 + 0.1, y + 0.9, 2.1], STONE))
    if rng.random() < 0.5:
        parts += _ducts(a, b, height, rng)
    stations = np.column_stack([np.zeros(3), np.linspace(-0.35, 0.35, 3) * b, np.full(3, 1.5)])
    return BarrenScene(join(parts), stations)


def _sloped(rng: Random) -> BarrenScene:
    """A room under one pitch, or under a gable or hipped roof with its rafters."""
    a, b, eaves = rng.uniform([4, 5, 0.6], [9, 12, 3])
    ridge = eaves + a / 2 * np.tan(rng.uniform(0.2, 0.9))
    hip = rng.choice([0.0, rng.uniform(0.3, 1.0)]) * min(a, b) / 2
    corners = np.array([[-a / 2, -b / 2, eaves], [a / 2, -b / 2, eaves], [a / 2, b / 2, eaves], [-a / 2, b / 2, eaves],
                        [0, -b / 2 + hip, ridge], [0, b / 2 - hip, ridge]])  # fmt: skip
    faces = np.array([[0, 4, 5], [0, 5, 3], [1, 2, 5], [1, 5, 4], [0, 1, 4], [2, 3, 5]])
    if rng.random() < 0.3:  # one pitch
        corners[4:, 0], corners[[1, 2], 2] = a / 2, ridge
        corners[4:, 1] = -b / 2, b / 2
    parts = [
        rectangle([-a / 2, -b / 2, 0], [a, 0, 0], [0, b, 0], EARTH),
        *_walls(a, b, eaves),
        plain(corners, faces, STONE),
    ]
    parts += _furniture(a, b, rng)
    return BarrenScene(join(parts), _inside(a, b, rng, min(1.5, 0.7 * ridge)))


def _grid(rows: int, columns: int) -> NDArray[np.int64]:
    """Triangles (t, 3) of a grid of points, row by row."""
    k = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = k[:-1, :-1].ravel(), k[1:, :-1].ravel(), k[1:, 1:].ravel(), k[:-1, 1:].ravel()
    return np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])


def _rough(xyz: Array, away: Array, size: float, rng: Random) -> Array:
    """Points moved along `away` (n, 3) by a few waves of some `size` [m]."""
    moved = sum(size / k * draw_waves(12, 0.5 * k, 2.0 * k, rng)(xyz).astype(np.float64) for k in (1, 2, 3))
    return xyz + np.asarray(moved)[:, None] / 1.5 * away


def _tunnel(rng: Random) -> BarrenScene:
    """A gallery hewn along a bend, its section a horseshoe."""
    radius, length, size = rng.uniform([1.2, 15, 0.08], [3.5, 35, 0.25])
    bend = rng.uniform(-1, 1) / 15
    s, t = np.linspace(-length / 2, length / 2, 160), np.linspace(-0.35 * pi, 1.35 * pi, 60)
    heading = bend * s
    path = np.cumsum(np.column_stack([np.sin(heading), np.cos(heading)]) * (s[1] - s[0]), axis=0)
    path -= path[len(s) // 2]
    side = np.column_stack([np.cos(heading), -np.sin(heading)])
    out = np.cos(t)[None, :, None] * np.concatenate([side, np.zeros((len(s), 1))], 1)[:, None, :]
    out = out + np.sin(t)[None, :, None] * np.array([0, 0, 1.0])
    xyz = np.concatenate([path, np.full((len(s), 1), radius)], 1)[:, None, :] + radius * out
    mesh = plain(_rough(xyz.reshape(-1, 3), out.reshape(-1, 3), size, rng), _grid(len(s), len(t)), STONE)
    floor = rectangle([-length, -length, 0.3], [2 * length, 0, 0], [0, 2 * length, 0], EARTH)
    places = path[[40, 80, 120]]
    return BarrenScene(join([mesh, floor]), np.column_stack([places, np.full(3, min(1.5, radius))]))


def _ball(scale: Array, centre: Array, size: float, rng: Random, bright: float = STONE) -> Triangles:
    u, v = np.linspace(0, 2 * pi, 90), np.linspace(0, pi, 45)
    away = np.stack(
        [np.outer(np.sin(v), np.cos(u)), np.outer(np.sin(v), np.sin(u)), np.outer(np.cos(v), np.ones(90))], 2
    )
    xyz = (away * scale).reshape(-1, 3)
    return plain(_rough(xyz, away.reshape(-1, 3), size, rng) + centre, _grid(45, 90), bright)


def _cave(rng: Random) -> BarrenScene:
    scale = rng.uniform([3, 3, 1.8], [8, 8, 4])
    parts = [_ball(scale, np.array([0, 0, 0.3 * scale[2]]), rng.uniform(0.2, 0.6), rng)]
    parts.append(rectangle([-10, -10, 0], [20, 0, 0], [0, 20, 0], EARTH))
    return BarrenScene(join(parts), _inside(float(scale[0]), float(scale[1]), rng, 1.3))


def _ground(rng: Random, tilt: float, size: float) -> Triangles:
    """Ground 60 m wide that rises along x."""
    n = 120
    x, y = np.meshgrid(np.linspace(-30, 30, n), np.linspace(-30, 30, n), indexing="ij")
    xyz = np.stack([x, y, x * np.tan(tilt)], 2).reshape(-1, 3)
    return plain(_rough(xyz, np.tile([0, 0, 1.0], (n * n, 1)), size, rng), _grid(n, n), EARTH)


def _outdoors(rng: Random, tilt: float) -> Array:
    places = rng.uniform(-6, 6, (2, 2))
    return np.column_stack([places, places[:, 0] * np.tan(tilt) + 2.0])


def _slope(rng: Random) -> BarrenScene:
    tilt = rng.uniform(0.1, 0.6)
    return BarrenScene(_ground(rng, tilt, rng.uniform(0, 0.15)), _outdoors(rng, tilt))


def _rock(rng: Random) -> BarrenScene:
    scale = rng.uniform([1.5, 1.5, 1], [5, 5, 3])
    parts = [_ground(rng, 0.0, 0.05), _ball(scale, np.array([0, 0, 0.2]), rng.uniform(0.1, 0.3), rng)]
    angle = rng.uniform(0, 2 * pi) + np.arange(3) * 2 * pi / 3
    far = scale.max() + 3
    return BarrenScene(join(parts), np.column_stack([far * np.cos(angle), far * np.sin(angle), np.full(3, 1.8)]))


def _trees(rng: Random) -> BarrenScene:
    tilt = rng.uniform(0, 0.2)
    parts = [_ground(rng, tilt, 0.1)]
    for x, y in rng.uniform(-14, 14, (int(rng.integers(4, 14)), 2)):
        z, trunk, crown = x * np.tan(tilt), rng.uniform(1.5, 5), rng.uniform(0.8, 3)
        parts.append(tube([x, y, z], [x, y, z + trunk + crown], (0.25, 0.12), EARTH))
        parts.append(_ball(crown * rng.uniform(0.7, 1.2, 3), np.array([x, y, z + trunk + crown]), 0.2, rng, LEAVES))
    return BarrenScene(join(parts), _outdoors(rng, tilt))


def _facade(rng: Random) -> BarrenScene:
    """A house front with its windows, a cornice, and the street."""
    width, height = rng.uniform([10, 6], [25, 16])
    parts = [
        rectangle([-width / 2, 0, 0], [width, 0, 0], [0, 0, height], PAINT),
        rectangle([-width / 2, -15, 0], [width, 0, 0], [0, 15, 0], EARTH),
        box([-width / 2, -rng.uniform(0.2, 0.8), height - 0.3], [width / 2, 0, height], STONE),
    ]
    columns = np.arange(-width / 2 + 1, width / 2 - 1.5, rng.uniform(2, 3.5))
    rows = np.arange(1, height - 2.2, rng.uniform(2.8, 3.6))
    parts += [box([x, -0.12, z], [x + 1.1, 0.0, z + 1.6], STONE) for x in columns for z in rows]
    if rng.random() < 0.5:  # a balcony, or an arcade's level ceiling
        z = rng.uniform(3, 4)
        parts.append(box([-width / 2, -rng.uniform(1, 3), z], [width / 2, 0, z + 0.3], STONE))
    places = np.column_stack([np.array([-0.25, 0.25]) * width, rng.uniform(-12, -6, 2), np.full(2, 1.6)])
    return BarrenScene(join(parts), places)


SCENES: dict[str, Callable[[Random], BarrenScene]] = {
    "office": _office,
    "corridor": _corridor,
    "roof": _sloped,
    "tunnel": _tunnel,
    "cave": _cave,
    "slope": _slope,
    "rock": _rock,
    "trees": _trees,
    "facade": _facade,
}
"""Scenes by their kind."""
