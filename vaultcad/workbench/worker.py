"""The worker that FreeCAD's add-on starts: `python -m vaultcad.workbench.worker`, with requests on standard input."""

from __future__ import annotations

import faulthandler

from vaultcad.workbench.declarations import families
from vaultcad.workbench.files import export
from vaultcad.workbench.protocol import Request, serve
from vaultcad.workbench.scans import fit, read
from vaultcad.workbench.shapes import build


def ping(request: Request) -> dict[str, object]:
    """Version and process number, after the slow imports and a first shape, so that the next is quick."""
    import os

    from families import Sail
    from vaultcad.versions import versions
    from vaultcad.workbench.shapes import made

    made(Sail(), 0.0)
    return {"pid": os.getpid(), "vaultcad": versions()["vaultcad"]}


REQUESTS = {"ping": ping, "families": families, "build": build, "read": read, "fit": fit, "export": export}

if __name__ == "__main__":
    faulthandler.enable()
    serve(REQUESTS)
