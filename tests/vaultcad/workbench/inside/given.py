"""For the scripts that FreeCAD runs: what the test gives them, and what they tell it."""

import json
import os
import traceback
from pathlib import Path

GIVEN = json.loads(os.environ["VAULTCAD_GIVEN"])
FOLDER = Path(GIVEN["folder"])


def tell(found):
    Path(os.environ["VAULTCAD_RESULT"]).write_text(json.dumps(found), encoding="utf-8")


def told(work):
    """Run the script's work, and tell the test what it gives or how it failed."""
    try:
        tell(work())
    except BaseException:
        tell({"failed": traceback.format_exc()})


def extent(obj):
    """How far its shape goes along each axis [mm]."""
    box = obj.Shape.BoundBox
    return [round(v, 3) for v in (box.XMin, box.XMax, box.YMin, box.YMax, box.ZMin, box.ZMax)]


def state(obj):
    """What of a vault must be right at any time."""
    return {
        "states": list(obj.State),
        "valid": obj.Shape.isValid(),
        "faces": len(obj.Shape.Faces),
        "names": list(obj.FaceNames),
        "colours": len(obj.FaceColors),
        "box": extent(obj),
        "volume": round(obj.Shape.Volume) if obj.Shape.Solids else 0,  # to integrate it over open shells takes long
    }
