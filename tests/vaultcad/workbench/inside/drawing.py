"""A drawing of ours, opened by FreeCAD's own reader of DXF."""

import FreeCAD as App
import given
import Import


def work():
    document = App.newDocument("drawing")
    given_file = str(given.FOLDER / "drawings.dxf")
    Import.readDXF(given_file, "drawing", True, "User parameter:BaseApp/Preferences/Mod/Draft")
    boxes = [o.Shape.BoundBox for o in document.Objects if hasattr(o, "Shape") and not o.Shape.isNull()]
    return {
        "shapes": len(boxes),
        "box": [min(b.XMin for b in boxes), max(b.XMax for b in boxes), max(b.YMax for b in boxes)],
    }


given.told(work)
