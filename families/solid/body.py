"""A body [mm] from the surfaces of a vault's pieces: they are laid cell by cell, and plane ends close them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray
from OCP.TopoDS import TopoDS_Shape

from families.declaration.pieces import Ball, Lid, Piece, Turned
from families.declaration.units import MM
from families.declaration.vault import IDENTITY
from families.solid.barrel_faces import Web, webs
from families.solid.barrel_slopes import forget
from families.solid.boundary import Loop, Pole
from families.solid.face_net import Net, Patch
from families.solid.occ.shapes import is_sound, together
from families.solid.plan_cells import Cuts
from families.solid.plane_ends import Box, close
from families.solid.plane_regions import area
from families.solid.round_faces import rounds
from families.solid.surfaces import Flat

Array = NDArray[np.float64]
THIN = 1e-4  # of the square of its size, the area in plan of a face that is all but plumb


@dataclass(frozen=True)
class Skin:
    """The surface of a union of pieces; `stone` if the body lies outside of it, as it does about the intrados."""

    pieces: tuple[Piece, ...]
    stone: bool

    @property
    def top(self) -> float:
        """Highest point [m]."""
        return max(part.top for piece in self.pieces for part in piece.parts)

    def webs(self, half: tuple[float, float], cuts: Cuts, alone: bool) -> Iterator[Web]:
        """Its parts above the ground and within a plan of half extents [m]; with those on its sides if it is alone."""
        drawn = tuple(p for p in self.pieces if not _is_round(p))
        for cell in cuts.cells(*half, 0.0, self.top) if drawn else ():
            yield from webs(drawn, cell, half if alone else (inf, inf))
        for piece in self.pieces:
            if _is_round(piece):
                yield from rounds(piece, np.array(half))


def body(
    half: tuple[float, float], skins: list[Skin], cuts: Cuts, within: Callable[[Array], NDArray[np.bool_]]
) -> TopoDS_Shape:
    """The solid between skins, the ground, and the sides of a plan of half extents [m]; `within` knows its points [m].

    Raises:
        ValueError: its faces do not close, or OpenCASCADE finds a fault in it.
    """
    lids = {part.z for skin in skins for piece in skin.pieces for part in piece.parts if isinstance(part, Lid)}
    box = Box((MM * half[0], MM * half[1]), MM * max(skin.top for skin in skins), tuple(MM * z for z in sorted(lids)))
    net = _laid(half, skins, cuts, box.corners())
    close(net, box, lambda points: within(points / MM))
    shape = net.solids()
    if not is_sound(shape):
        raise ValueError("OpenCASCADE finds a fault in the body of this vault; change a parameter a little")
    return shape


def surface(half: tuple[float, float], skin: Skin, cuts: Cuts) -> TopoDS_Shape:
    """The faces of a skin alone, above the ground and within a plan of half extents [m]."""
    return together(face for face, _ in _laid(half, [skin], cuts, ()).faces)


def _laid(half: tuple[float, float], skins: list[Skin], cuts: Cuts, corners: Iterable[Array]) -> Net:
    """A net of the faces of skins; it has vertices at the corners too."""
    forget()  # the same body has the same bytes, whatever was built before
    net = Net()
    webs = [(web, skin.stone) for skin in skins for web in skin.webs(half, cuts, alone=len(skins) == 1)]
    for corner in corners:
        net.vertex(corner)
    loops = net.cut([_counterclockwise(web) for web, _ in webs])
    for (web, stone), loop in zip(webs, loops, strict=True):
        net.add(Patch(web.sheet, [loop], flipped=stone != web.inwards))
    return net


def inside(pieces: tuple[Piece, ...], half: tuple[float, float], points: Array) -> NDArray[np.bool_]:
    """Whether points (n, 3) [m] are in a void above the ground; what is turned may stand beyond the plan."""
    from families.void import kernel

    plan = (np.abs(points[:, :2]) < half).all(axis=1)
    found = np.zeros(len(points), bool)
    for piece in pieces:
        turned = [part for part in piece.parts if isinstance(part, Turned)]
        names = {n: 0 for part in piece.parts if not isinstance(part, Lid) for n in part.names}
        table = kernel.pack((piece,), tuple(names))
        here = kernel.distances(points, IDENTITY, table, kernel.pack_plan(None)) < 0
        found |= here & (points[:, 2] > min(part.foot for part in turned) if turned else plan)
    found &= points[:, 2] > 0
    return found


def _is_round(piece: Piece) -> bool:
    return any(isinstance(part, Ball | Turned) for part in piece.parts)


def _counterclockwise(web: Web) -> Loop:
    """The loop of a web so that it runs about its face to the left."""
    if any(isinstance(step, Pole) for step in web.loop):
        return web.loop
    points = np.concatenate([step.places[:2] for step in web.loop])
    # Normals away from the void look up, unless a face is all but plumb: the plan tells, and costs less.
    turn = 0.0 if isinstance(web.sheet, Flat) else area(points[:, :2])
    if abs(turn) < THIN * np.ptp(points, axis=0).max() ** 2:
        turn = area(web.sheet.parameters(points))
    return web.loop if turn > 0 else [step.reversed for step in web.loop[::-1]]
