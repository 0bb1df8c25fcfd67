"""The part of report.html that holds the 3D view: a button, and what it opens, packed."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

from vaultcad.export.viewer.library import three_js
from vaultcad.export.viewer.packing import page_text
from vaultcad.export.viewer.scene import scene
from vaultcad.model import Model

SCRIPTS = (
    "scene.js",
    "cap.js",
    "orbit.js",
    "pick.js",
    "measure.js",
    "view.js",
)  # in the order in which they are joined
HERE = files("vaultcad.export.viewer")


def viewer_style() -> str:
    """CSS of the view."""
    return _text("viewer.css")


def viewer_section(
    model: Model,
    titles: Sequence[str],
    points: NDArray[np.floating] | None,
    component: NDArray[np.integer] | None,
    deviation: NDArray[np.floating] | None,
    vault: NDArray[np.integer] | None,
) -> str:
    """HTML of the 3D view of a model; the arguments are those of `write_report_html`, titles are the vaults'."""
    try:
        library = three_js()
    except LookupError as error:
        return f'<section><h2>3D view</h2><p class="warning">There is none: {escape(str(error))}.</p></section>'
    xyz = np.zeros((0, 3)) if points is None else points
    off = np.full(len(xyz), np.nan) if deviation is None else deviation
    part = np.isfinite(off).astype(np.uint16) if component is None else component
    owner = np.where(np.isfinite(off), 1, 0) if vault is None else vault
    shown = scene(model, titles, xyz, part, off, owner)
    code = "\n".join(_text(name) for name in SCRIPTS)
    packed = {"library": library.encode(), "code": code.encode(), "scene": shown}
    blocks = "".join(
        f'<script type="text/plain" data-packed="{name}">{page_text(plain)}</script>' for name, plain in packed.items()
    )
    return f'<section id="view3d">{_text("viewer.html")}{blocks}<script>{_text("open.js")}</script></section>'


def _text(name: str) -> str:
    return (HERE / name).read_text(encoding="utf-8")
