"""The parametric object: properties from the family's declaration, a shape from the worker."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path
from typing import Any

import FreeCAD as App
import Part

from . import properties
from .catalogue import Declaration, families
from .client import BUILDER, GoneError, RefusedError
from .texts import complain, translate

MM = 1000.0
GAP = 1000.0  # [mm] between a new vault and what is there already
ENDLESS = 1e9  # [mm]: planes of reference are larger
HIDDEN = properties.HIDDEN
INNER = (  # what the object keeps for itself, undone and saved like the rest
    ("App::PropertyString", "Built", "the request that the shape answers, and its sizes"),
    ("App::PropertyString", "Report", "what the fit found, as JSON"),
    ("App::PropertyColorList", "FaceColors", "colour of each face"),
)


def make(document: Any, family: str, name: str | None = None) -> Any:
    """A new vault of a family in a document; `document.recompute()` gives it its shape.

    Raises:
        client.GoneError: the worker cannot be had.
        KeyError: no such family.
    """
    declaration = families()[family]
    obj = document.addObject("Part::FeaturePython", name or declaration["id"].capitalize())
    obj.Label = name or declaration["title"].capitalize()
    Vault(obj, declaration)
    if App.GuiUp:
        from .view import VaultView

        VaultView(obj.ViewObject)
    return obj


def is_vault(obj: Any) -> bool:
    """Whether an object of a document is a vault of ours."""
    return isinstance(getattr(obj, "Proxy", None), Vault)


def put_beside(obj: Any) -> None:
    """Move a vault along x, past all that is seen in its document: shapes, scans, meshes."""
    there = App.BoundBox()
    for other in obj.Document.Objects:
        if other is not obj and other.Visibility:
            for name in ("Shape", "Points", "Mesh"):
                box = getattr(getattr(other, name, None), "BoundBox", None)
                if box is not None and box.isValid() and box.DiagonalLength < ENDLESS:
                    there.add(box)
    if there.isValid() and not obj.Shape.isNull():
        obj.Placement.Base.x += there.XMax + GAP - obj.Shape.BoundBox.XMin


def faces(obj: Any, component: str) -> list[Any]:
    """The faces of a vault that show a component, such as "web_south", "extrados" or "side"."""
    return [face for face, name in zip(obj.Shape.Faces, obj.FaceNames, strict=True) if name == component]


class Vault:
    """The behaviour of the object; the object's own properties hold all values."""

    def __init__(self, obj: Any, declaration: Declaration) -> None:
        self.declaration = declaration
        obj.Proxy = self
        obj.addProperty("App::PropertyString", "Family", "Dimensions", translate("VaultCad", "family of the vault"))
        obj.Family = declaration["title"]
        properties.add(obj, declaration)
        text = translate("VaultCad", "thickness of the masonry; 0 shows the intrados alone")
        obj.addProperty("App::PropertyLength", "Thickness", "Masonry", text)
        text = translate("VaultCad", "component that each face shows: Face1, Face2, ...")
        obj.addProperty("App::PropertyStringList", "FaceNames", "Masonry", text)
        for kind, name, text in INNER:
            obj.addProperty(kind, name, "Inner", text)
        self._hide(obj)

    def execute(self, obj: Any) -> None:
        """Rebuild the shape; a refused value goes back to the last good one.

        Raises:
            RuntimeError: there is no last good one, an expression sets the value, or the worker ended. FreeCAD shows
                the reason at the object, whose last good shape stays.
        """
        request, built = self.request(obj), json.loads(obj.Built or "{}")
        lengths = properties.lengths(obj, self.declaration, built.get("sizes", {}))
        if request == built.get("request") and not lengths and not obj.Shape.isNull():
            return
        with tempfile.TemporaryDirectory(prefix="vaultcad-") as folder:
            path = Path(folder) / "shape.brep"
            try:
                reply = BUILDER.ask("build", path=str(path), lengths=lengths, **request)
            except RefusedError as error:
                if not obj.Built or obj.ExpressionEngine:
                    raise RuntimeError(f"{obj.Label}: {error}") from None
                self._restore(obj)
                complain(f"{obj.Label}: {error}; " + translate("VaultCad", "the last good value is back"))
                return
            except GoneError as error:
                complain(f"{obj.Label}: {error}")
                raise RuntimeError(str(error)) from None
            shape = Part.Shape()
            shape.importBrep(str(path))
        whole = shape.Solids[0] if len(shape.Solids) == 1 else shape
        whole.Placement = obj.Placement
        obj.Shape = whole
        obj.FaceNames = reply["faces"]
        obj.FaceColors = [(*reply["colours"][name], 0.0) for name in reply["faces"]]
        properties.choose(obj, self.declaration, request["profiles"], reply["parameters"])
        properties.follow(obj, self.declaration, reply["sizes"])
        obj.Built = json.dumps({"request": self.request(obj), "sizes": reply["sizes"]})

    def request(self, obj: Any) -> dict[str, Any]:
        """What the worker is asked: family, profiles, parameters and thickness, in metres and radians."""
        return {
            "family": self.declaration["id"],
            "profiles": properties.profiles(obj, self.declaration),
            "parameters": properties.values(obj, self.declaration),
            "thickness": obj.Thickness.Value / MM,
        }

    def onChanged(self, obj: Any, name: str) -> None:
        """A profile was chosen: show its parameters."""
        if hasattr(self, "declaration") and not App.isRestoring() and "Built" in obj.PropertiesList:
            properties.refit(obj, self.declaration, name)

    def onDocumentRestored(self, obj: Any) -> None:
        """What documents do not keep: which properties are hidden."""
        properties.show(obj, self.declaration)
        self._hide(obj)

    def dumps(self) -> dict[str, Any]:
        """What the document keeps of this: enough to open it without the worker."""
        return {"declaration": self.declaration}

    def loads(self, state: dict[str, Any]) -> None:
        """The inverse of `dumps`."""
        self.declaration = state["declaration"]

    __getstate__, __setstate__ = dumps, loads  # the names that FreeCAD 0.20 knows them by

    def _restore(self, obj: Any) -> None:
        built = json.loads(obj.Built)
        good = built["request"]
        properties.follow(obj, self.declaration, built["sizes"])
        properties.choose(obj, self.declaration, good["profiles"], good["parameters"])
        obj.Thickness = good["thickness"] * MM

    def _hide(self, obj: Any) -> None:
        for name in ("Family", "FaceNames"):
            obj.setEditorMode(name, properties.READ_ONLY)
        for _, name, _ in INNER:
            obj.setEditorMode(name, HIDDEN)
