"""three.js, which draws the 3D view, out of the viewer that trimesh brings along."""

from __future__ import annotations

import re

# The library as one script: from its licence, which goes with it, to the end of the line that it is minified to.
THREE = re.compile(r"/\*\*\s+\* @license\s[^/]*SPDX-License-Identifier: MIT\s[^/]*/\n[^\n]*\.THREE=\{\}[^\n]*")


def three_js() -> str:
    """three.js as a classic script that declares `THREE`, with its licence.

    Raises:
        LookupError: this trimesh brings none; says which does.
    """
    import trimesh
    from trimesh import resources, util

    (page,) = util.decompress(resources.get_bytes("templates/viewer.zip"), file_type="zip").values()
    found = THREE.search(page.read().decode("utf-8"))
    if found is None:
        raise LookupError(f"trimesh {trimesh.__version__} brings no three.js along; install trimesh 5.2")
    return found[0]
