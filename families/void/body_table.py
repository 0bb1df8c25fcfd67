"""The bodies of a void as a table of numbers, for compiled code."""

from __future__ import annotations

from math import hypot, inf

import numpy as np
from numpy.typing import NDArray

from families.declaration.pieces import Ball, BarrelPart, Ceiling, Lid, Part, Piece, Turned, Web
from families.declaration.plan import Plan
from families.declaration.profiles import UNSTILTED, BasketHandle, Curve, Elliptical, Pointed

Array = NDArray[np.float64]

# Columns of the packed table, one row a body.
PIECE, KIND, X, Y, ACROSS_X, ACROSS_Y, BASE, SIDE, CROWN_RISE, HALF_LENGTH, SLOPE, SPLAY, FLARE, RADIUS = range(14)
HALF_SPAN, RISE, STILT, ARCS, U1, Z1, R1, U2, Z2, R2 = range(14, 24)
NAME, NAMING = 24, 28  # four names from 24 on; NAMING says how the name is chosen
FOOT = 29  # height from which on the piece is free of the plan, -inf if it never is
WIDTH = 30
KINDS_OF = (PIECE, KIND, ARCS, NAMING)  # columns that tell kinds, and no sizes

# Those of a web, in places that it has no other use for: kind of its arch, haunch ratio of that, bow of the ridge,
# distance of the wall, middle of that along it, half its length, reach and rise.
ARCH, BOW, DEPTH, MIDDLE, HALF, FAR, CROWN, HAUNCH = (
    SIDE,
    CROWN_RISE,
    HALF_LENGTH,
    SLOPE,
    SPLAY,
    FLARE,
    RADIUS,
    NAME + 1,
)

# BENT: a barrel that is not level or not even; ASIDE, RING: a ball or turned profile that is not about the origin.
BARREL, BENT, BALL, TURNED, CEILING, LID, ASIDE, RING, WEB = range(9)
ALONG, QUARTER, HEIGHT, ONE = range(4)  # NAMING: by the sign along the axis, the corner of the plan, the height, or one
KINDS = UNSTILTED  # ARCH: the place in this row
POINTED, BASKET, ELLIPTICAL = map(KINDS.index, (Pointed, BasketHandle, Elliptical))
BELOW = 2  # which of a barrel's names is that of its walls; 0 if they have none of their own

NO_WALLS = np.empty((0, 5))


def pack(pieces: tuple[Piece, ...], components: tuple[str, ...]) -> Array:
    """Table (bodies, WIDTH) of a void; component ids are 1 + index in `components`."""
    ids = {name: float(i + 1) for i, name in enumerate(components)}
    table = np.array([_row(k, part, ids) for k, piece in enumerate(pieces) for part in piece.parts])
    if any(piece.foot is not None for piece in pieces):
        table[:, FOOT] = [-inf if piece.foot is None else piece.foot for piece in pieces for _ in piece.parts]
    return table


def pack_plan(plan: Plan | None) -> Array:
    """Table (sides, 5) of the walls on a plan (`families.declaration.plan`), of no side if there are none."""
    return NO_WALLS if plan is None else plan.table


def _row(piece: int, part: Part, ids: dict[str, float]) -> list[float]:
    row = [0.0] * WIDTH
    row[PIECE], row[FOOT] = piece, -inf
    match part:
        case BarrelPart():
            bent = part.crown_rise or part.slope or part.splay or part.flare
            row[KIND], row[NAMING] = BENT if bent else BARREL, ALONG
            row[X:BASE] = *part.origin, *part.across
            row[BASE], row[SIDE], row[SLOPE], row[SPLAY] = part.base, part.side, part.slope, part.splay
            row[FLARE], row[CROWN_RISE], row[HALF_LENGTH] = part.flare, part.crown_rise, part.half_length
            row[HALF_SPAN:NAME] = _curve(part.curve)
            row[NAME : NAME + BELOW] = [ids[n] for n in part.names]
            row[NAME + BELOW] = ids[part.below] if part.below else 0.0
            return row
        case Ball():
            row[KIND], row[NAMING], row[BASE], row[R1] = BALL, QUARTER, part.z, part.radius
            row[X], row[Y] = part.centre
            if any(part.centre):
                row[KIND] = ASIDE
        case Turned():
            row[KIND], row[NAMING], row[BASE], row[RADIUS] = TURNED, HEIGHT, part.base, part.radius
            row[X], row[Y] = part.centre
            if part.radius or any(part.centre):
                row[KIND] = RING
            row[HALF_SPAN:NAME] = _curve(part.curve)
        case Web():
            (x, y), (x0, y0), (x1, y1) = part.centre, part.start, part.end
            size = hypot(x1 - x0, y1 - y0)
            tx, ty = (x1 - x0) / size, (y1 - y0) / size
            row[KIND], row[NAMING], row[NAME], row[X], row[Y] = WEB, ONE, ids[part.names[0]], x, y
            row[ACROSS_X], row[ACROSS_Y], row[HALF] = tx, ty, size / 2
            row[DEPTH] = (x0 - x) * ty - (y0 - y) * tx
            row[MIDDLE] = ((x0 + x1) / 2 - x) * tx + ((y0 + y1) / 2 - y) * ty
            row[ARCH], row[HAUNCH] = KINDS.index(type(part.arch)), getattr(part.arch, "haunch_ratio", 0.0)
            row[BOW], row[FAR], row[CROWN] = -1.0 if part.bow is None else part.bow, part.reach, part.rise
            row[HALF_SPAN:NAME] = _curve(part.diagonal)
            return row
        case Ceiling():
            row[KIND], row[BASE] = CEILING, part.z
        case Lid():
            row[KIND], row[BASE] = LID, part.z
            return row
    names = part.names * (4 // len(part.names))
    row[NAME : NAME + 4] = [ids[n] for n in names]
    return row


def _curve(curve: Curve) -> list[float]:
    arcs = [value for a in curve.arcs for value in (a.u, a.z, a.radius)]
    return [curve.half_span, curve.rise, curve.stilt, float(len(curve.arcs)), *arcs, *[0.0] * (6 - len(arcs))]
