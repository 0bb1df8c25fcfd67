"""Rays from one station into a scene, and what the scanner makes of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vaultcad.errors import MissingLibraryError
from vaultcad.scanner import beams
from vaultcad.scanner.settings import ScannerSettings
from vaultcad.scanner.triangles import Triangles
from vaultcad.scanner.waves import Waves, draw_waves

Array = NDArray[np.float64]

CHUNK = 500_000  # rays cast at once
FLYING = 0.03  # a mixed point farther than this from the surface it was shot at shows no component [m]
STEEPEST = 0.3  # least cosine by which relief is turned into range


@dataclass(frozen=True, eq=False)
class Shots:
    """Points (n, 3) as measured [m], with component (n,) and intensity (n,)."""

    xyz: Array
    component: NDArray[np.uint16]
    intensity: NDArray[np.uint16]


@dataclass(frozen=True, eq=False)
class Target:
    """A scene made ready for rays, with the relief of its surfaces and the stains on them."""

    caster: Any  # open3d.t.geometry.RaycastingScene
    mesh: Triangles
    relief: Waves
    stain: Waves


def aim(mesh: Triangles, rng: np.random.Generator) -> Target:
    """Make a scene ready.

    Raises:
        MissingLibraryError: as `caster_of` does.
    """
    caster = caster_of(mesh)
    relief = draw_waves(count=16, shortest=0.12, longest=0.8, rng=rng)
    stain = draw_waves(count=8, shortest=0.5, longest=3.0, rng=rng)
    return Target(caster, mesh, relief, stain)


def caster_of(mesh: Triangles) -> Any:
    """An open3d.t.geometry.RaycastingScene of a mesh.

    Raises:
        MissingLibraryError: open3d, or a system library under it, is missing; says how to install it.
    """
    try:
        import open3d as o3d
    except ModuleNotFoundError as error:
        raise MissingLibraryError(f'vaultcad scan needs {error.name}: pip install "vaultcad[scanner]"') from error
    except (ImportError, OSError) as error:
        raise MissingLibraryError(
            f"the virtual scanner needs open3d, which does not load here ({error}); "
            "install its system library: apt-get install libusb-1.0-0, and see `vaultcad doctor`"
        ) from error
    caster = o3d.t.geometry.RaycastingScene()
    caster.add_triangles(
        o3d.core.Tensor.from_numpy(np.ascontiguousarray(mesh.vertices, np.float32)),
        o3d.core.Tensor.from_numpy(np.ascontiguousarray(mesh.triangles, np.uint32)),
    )
    return caster


def sweep(
    target: Target,
    station: Array,
    step: float,
    settings: ScannerSettings,
    bounds: Array,
    rng: np.random.Generator,
) -> Iterator[Shots]:
    """Points that one station (3,) measures within `bounds` (2, 3), in chunks of rows from below upwards.

    All in the scene's frame; step: between beams [rad].
    """
    grid = beams.grid(step)
    scale = 1 + rng.uniform(-1, 1) * settings.ranging_error / 25
    rows = max(1, CHUNK // grid.columns)
    before = None
    for first in range(0, grid.rows, rows):
        elevation, azimuth = grid.angles(first, min(grid.rows, first + rows))
        along = beams.directions(elevation, azimuth)
        distance, triangle, cosine = _cast(target, station, along)
        measured = beams.mixed(distance, cosine, step, before, settings.mixed, rng)
        before = distance[-1]

        hit = np.isfinite(distance)
        distance, measured, cosine = distance[hit], measured[hit], cosine[hit]
        elevation, azimuth, triangle = elevation[hit], azimuth[hit], triangle[hit]
        place = station + distance[:, None] * along[hit]
        signal = target.mesh.reflectance[triangle] * cosine * (1 + 0.15 * target.stain(place))
        component = np.where(np.abs(measured - distance) > FLYING, 0, target.mesh.component[triangle])

        sigma = beams.range_sigma(distance, cosine, settings.noise)
        measured = measured - settings.relief * target.relief(place) / np.maximum(cosine, STEEPEST)
        measured = (measured + sigma * rng.standard_normal(len(sigma))) * scale
        elevation = elevation + settings.angle_noise * rng.standard_normal(len(sigma))
        azimuth = azimuth + settings.angle_noise * rng.standard_normal(len(sigma))
        xyz = station + measured[:, None] * beams.directions(elevation, azimuth)

        keep = ~beams.lost(signal, settings.dropout, rng) & (xyz >= bounds[0]).all(1) & (xyz <= bounds[1]).all(1)
        bright = beams.intensity(signal, distance, rng)
        yield Shots(xyz[keep], component[keep].astype(np.uint16), bright[keep])


def _cast(target: Target, station: Array, along: Array) -> tuple[Array, NDArray[np.int64], Array]:
    """Range (inf: nothing hit), triangle and cosine of incidence of beams (rows, columns, 3), each (rows, columns)."""
    import open3d as o3d

    rays = np.empty((*along.shape[:2], 6), np.float32)
    rays[..., :3], rays[..., 3:] = station, along
    answer = target.caster.cast_rays(o3d.core.Tensor.from_numpy(rays))
    distance = answer["t_hit"].numpy().astype(np.float64)
    cosine = np.abs((answer["primitive_normals"].numpy() * along).sum(-1))
    return distance, answer["primitive_ids"].numpy().astype(np.int64), cosine
