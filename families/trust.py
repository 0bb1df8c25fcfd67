"""Whether a body made by OpenCASCADE shows the surface that it should: some of its intersections fail unsaid."""

from __future__ import annotations

import numpy as np
from OCP.BRep import BRep_Tool
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.BRepTools import BRepTools
from OCP.TopAbs import TopAbs_FACE
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Shape

from families.cells import Cell
from families.parts import Barrel, Lid, Piece, Turned
from families.sketch import MM
from families.vault import IDENTITY

CLOSE = 1e-4  # [m]
COARSE = 20.0, 0.3  # [mm] and [rad] of the triangles whose corners are asked


def has_ellipse(pieces: tuple[Piece, ...]) -> bool:
    """Whether an exact ellipse is among the profiles; with circles and planes OpenCASCADE can be trusted."""
    curves = [part.curve for piece in pieces for part in piece.parts if isinstance(part, Barrel | Turned)]
    return any(not curve.arcs and not curve.oval for curve in curves)


def shows(shape: TopoDS_Shape, pieces: tuple[Piece, ...], cell: Cell) -> bool:
    """Whether all points of a shape's faces lie on the union of the pieces, or on a side of the cell."""
    from families import kernel

    points = _corners(shape)
    names = tuple({n: 0 for p in pieces for part in p.parts if not isinstance(part, Lid) for n in part.names})
    distance = np.abs(kernel.distances(points, IDENTITY, kernel.pack(pieces, names), kernel.pack_plan(None)))
    low = np.array([cell.x[0], cell.y[0], cell.low])
    high = np.array([cell.x[1], cell.y[1], cell.high])
    side = (np.abs(points - low) < CLOSE).any(axis=1) | (np.abs(points - high) < CLOSE).any(axis=1)
    return bool((side | (distance < CLOSE)).all())


def _corners(shape: TopoDS_Shape) -> np.ndarray:
    BRepMesh_IncrementalMesh(shape, COARSE[0], False, COARSE[1], False)
    found, explorer = [], TopExp_Explorer(shape, TopAbs_FACE)
    while explorer.More():
        place = TopLoc_Location()
        part = BRep_Tool.Triangulation_s(TopoDS.Face_s(explorer.Current()), place)
        if part is not None:
            nodes = (part.Node(k).Transformed(place.Transformation()) for k in range(1, part.NbNodes() + 1))
            found += [(n.X(), n.Y(), n.Z()) for n in nodes]
        explorer.Next()
    BRepTools.Clean_s(shape)
    return np.array(found).reshape(-1, 3) / MM
