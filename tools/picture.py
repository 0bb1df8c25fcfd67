"""The picture at the head of README.md: a scan, its components and the fitted solid, drawn by VTK without a window.

Usage: python tools/picture.py [SCAN [PICTURE]]
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np
import vtkmodules.vtkRenderingFreeType
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  # importing them makes VTK able to draw
from numpy.typing import NDArray
from vtkmodules.util import numpy_support
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkFeatureEdges, vtkPolyDataNormals
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkRenderingCore import (
    vtkActor,
    vtkPolyDataMapper,
    vtkRenderer,
    vtkRenderWindow,
    vtkTextActor,
    vtkWindowToImageFilter,
)

from segmentation import read
from segmentation.normals import estimate
from segmentation.voxel import thin
from vaultcad.export.component_bodies import Body
from vaultcad.export.geometry import bodies
from vaultcad.export.palette import colour
from vaultcad.pipeline import fit_scan

ROOT = Path(__file__).parents[1]
SIZE = 1380, 520
EYE = np.array([1.9, -10.2, 1.3])  # m, from the middle of the floor
LOOK = np.array([-0.25, 0.0, 2.55])
NEAR = 0.08  # m, of walls and floor
CELL = 0.03  # m, of the grid on which light is found
SHARP = 25.0  # ° between faces from which their edge is drawn
LIGHT = np.array([0.5, -0.6, -0.62])  # from where it falls on the clouds

Floats = NDArray[np.float64]
to_vtk: Callable[..., Any] = numpy_support.numpy_to_vtk
to_vtk_ids: Callable[..., Any] = numpy_support.numpy_to_vtkIdTypeArray


def main(scan: Path, picture: Path) -> None:
    """Fit the scan, and draw what comes of it."""
    cloud = read(scan)
    result = fit_scan(cloud)
    fitted = result.model.vaults[0]
    frame = fitted.pose.frame()
    xyz = cloud.xyz @ frame[:, :3].T + frame[:, 3]
    floor = float(np.quantile(xyz[:, 2], 0.01))
    half = fitted.vault.plan.half
    # The wall towards the eye is left away, with what stands beyond the others.
    shown = (xyz[:, 1] > -half[1] + 0.08) & (np.abs(xyz[:, :2]) < half + 0.1).all(axis=1)
    component, light = result.labels.component, _light(xyz)
    strength = np.ones(len(xyz)) if cloud.intensity is None else 0.75 + 0.25 * _stretched(cloud.intensity)
    stone = np.full((len(xyz), 3), 225.0)
    named = np.array([(215, 215, 215), *(_rgb(k) for k in range(1, 1 + len(fitted.components)))])[component]
    # Behind the solid, walls and floor alone: no furniture, no stray points.
    on_shell = (np.abs(np.abs(xyz[:, :2]) - half) < NEAR).any(axis=1) | (xyz[:, 2] < floor + NEAR)
    room = shown & (component == 0) & on_shell
    faint = np.repeat((190 + 55 * light[room])[:, None], 3, axis=1)
    panels = (
        (f"scan: {len(xyz):,} points", [_points(xyz[shown], (stone * (light * strength)[:, None])[shown])]),
        (f"components: {len(fitted.components)}", [_points(xyz[shown], (named * light[:, None])[shown])]),
        (
            f"solid: {fitted.vault.title}",
            [_points(xyz[room], faint), *_solid(bodies(fitted.vault, result.model.thickness))],
        ),
    )
    window = vtkRenderWindow()
    window.SetOffScreenRendering(True)
    window.SetMultiSamples(0)
    window.SetSize(*SIZE)
    for k, (title, actors) in enumerate(panels):
        renderer = _renderer(title, actors, floor)
        renderer.SetViewport(k / len(panels), 0, (k + 1) / len(panels), 1)
        window.AddRenderer(renderer)
    window.Render()
    image = vtkWindowToImageFilter()
    image.SetInput(window)
    image.SetInputBufferTypeToRGB()
    writer = vtkPNGWriter()
    writer.SetInputConnection(image.GetOutputPort())
    writer.SetFileName(str(picture))
    writer.Write()


def _stretched(intensity: NDArray[np.uint16]) -> Floats:
    low, high = np.quantile(intensity, [0.02, 0.98])
    share: Floats = np.clip((intensity - low) / max(high - low, 1), 0, 1)
    return share


def _light(xyz: NDArray[np.floating]) -> Floats:
    """Light (n,) on points (n, 3) from 0.45 to 1, by their normals of either sign."""
    thinned = thin(xyz, CELL, inverse=True)
    normals = np.nan_to_num(estimate(thinned.xyz))[thinned.inverse].astype(np.float64)
    light: Floats = 0.45 + 0.55 * np.abs(normals @ (LIGHT / np.linalg.norm(LIGHT)))
    return light


def _rgb(component: int) -> tuple[int, int, int]:
    found = colour(component)
    return found.red, found.green, found.blue


def _points(xyz: NDArray[np.floating], rgb: Floats) -> vtkActor:
    data = vtkPolyData()
    data.SetPoints(_vertices(xyz))
    cells = vtkCellArray()
    n = len(xyz)
    cells.SetData(to_vtk_ids(np.arange(n + 1), True), to_vtk_ids(np.arange(n), True))
    data.SetVerts(cells)
    data.GetPointData().SetScalars(to_vtk(np.ascontiguousarray(rgb, np.uint8), True))
    actor = _actor(data)
    actor.GetProperty().SetPointSize(2)
    actor.GetProperty().LightingOff()
    return actor


def _solid(pieces: Iterable[Body]) -> Iterable[vtkActor]:
    """Each component's body in its colour, with its sharp edges."""
    for body in pieces:
        data = vtkPolyData()
        data.SetPoints(_vertices(body.vertices))
        cells, n = vtkCellArray(), len(body.triangles)
        corners = body.triangles.astype(np.int64).ravel()
        cells.SetData(to_vtk_ids(3 * np.arange(n + 1), True), to_vtk_ids(corners, True))
        data.SetPolys(cells)
        smooth = vtkPolyDataNormals()
        smooth.SetInputData(data)
        smooth.SetFeatureAngle(SHARP)
        smooth.Update()
        actor = _actor(smooth.GetOutput())
        actor.GetProperty().SetColor(*colour(body.id).unit)
        actor.GetProperty().SetAmbient(0.6)
        actor.GetProperty().SetDiffuse(0.5)
        yield actor
        edges = vtkFeatureEdges()
        edges.SetInputData(data)
        edges.SetFeatureAngle(SHARP)
        edges.ColoringOff()
        edges.Update()
        line = _actor(edges.GetOutput())
        line.GetProperty().SetColor(0.15, 0.15, 0.15)
        line.GetProperty().SetLineWidth(1.2)
        yield line


def _vertices(xyz: NDArray[np.floating]) -> vtkPoints:
    points = vtkPoints()
    points.SetData(to_vtk(np.ascontiguousarray(xyz, np.float32), True))
    return points


def _actor(data: vtkPolyData) -> vtkActor:
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(data)
    actor = vtkActor()
    actor.SetMapper(mapper)
    return actor


def _renderer(title: str, actors: Iterable[vtkActor], floor: float) -> vtkRenderer:
    """One panel."""
    renderer = vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    for actor in actors:
        renderer.AddActor(actor)
    text = vtkTextActor()
    text.SetInput(title)
    text.GetTextProperty().SetFontSize(19)
    text.GetTextProperty().SetColor(0.2, 0.2, 0.2)
    text.SetPosition(24, 16)
    renderer.AddViewProp(text)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(EYE[0], EYE[1], EYE[2] + floor)
    camera.SetFocalPoint(LOOK[0], LOOK[1], LOOK[2] + floor)
    camera.SetViewUp(0, 0, 1)
    camera.SetViewAngle(40)
    renderer.ResetCameraClippingRange()
    return renderer


if __name__ == "__main__":
    given = [Path(argument) for argument in sys.argv[1:]]
    main(*(given + [ROOT / "examples" / "room.laz", ROOT / "docs" / "picture.png"][len(given) :]))
