"""A family's declarations as properties of a document's object, and back as a request for the worker."""

from __future__ import annotations

from typing import Any

from .catalogue import KINDS, SIGNED, Declaration, numbers, shown, title
from .texts import translate

HIDDEN, READ_ONLY, EDITABLE = 2, 1, 0  # FreeCAD's editor modes
SAME = 1e-9  # [m]
CLOSE = 1e-9  # share of a range by which a value may be off through the change of units


def add(obj: Any, declaration: Declaration) -> None:
    """A property for each declared parameter, those of all profiles included, and for each size that follows."""
    for parameter in declaration["parameters"]:
        if parameter["kind"] == "choice":
            _add(obj, parameter["name"], KINDS["choice"].property, parameter["group"], parameter["meaning"])
            setattr(obj, title(parameter["name"]), list(parameter["choices"]))
            setattr(obj, title(parameter["name"]), parameter["default"])
            for name, (group, kind, text) in _of_profiles(parameter).items():
                _add(obj, name, kind, group, text)
        else:
            text = f"{parameter['meaning']}: {_span(parameter)}"
            _add(obj, parameter["name"], _type(parameter), parameter["group"], text)
    for size in declaration["sizes"]:
        kind = SIGNED if size["kind"] == "length" else KINDS[size["kind"]].property
        text = "; " + translate("VaultCad", "edit it, and its ratio follows") if size["decides"] else ""
        _add(obj, size["name"], kind, size["group"], size["meaning"] + text)
    for parameter in numbers(declaration, profiles(obj, declaration)):
        put(obj, parameter, parameter["default"])
    show(obj, declaration)


def show(obj: Any, declaration: Declaration) -> None:
    """Hide the parameters of profiles that are not chosen, protect sizes that decide nothing. Documents lose this."""
    live = {parameter["name"] for parameter in numbers(declaration, profiles(obj, declaration))}
    for parameter in declaration["parameters"]:
        for name in _of_profiles(parameter):
            obj.setEditorMode(title(name), EDITABLE if name in live else HIDDEN)
    for size in declaration["sizes"]:
        obj.setEditorMode(title(size["name"]), EDITABLE if size["decides"] else READ_ONLY)


def profiles(obj: Any, declaration: Declaration) -> dict[str, str]:
    """Field -> id of the profile that is chosen."""
    names = (p["name"] for p in declaration["parameters"] if p["kind"] == "choice")
    return {name: str(getattr(obj, title(name))) for name in names}


def values(obj: Any, declaration: Declaration) -> dict[str, float]:
    """Parameter -> value [m, rad or 1]."""
    return {p["name"]: get(obj, p) for p in numbers(declaration, profiles(obj, declaration))}


def get(obj: Any, parameter: dict[str, Any]) -> float:
    """The value of a declared number, in its unit; an end of its range exactly where units have rounded it off."""
    held = getattr(obj, title(parameter["name"]))
    value = float(getattr(held, "Value", held)) / KINDS[parameter["kind"]].factor
    low, high = parameter["low"], parameter["high"]
    ends = [end for end in (low, high) if abs(value - end) < CLOSE * (high - low)]
    return float(ends[0]) if ends else value


def put(obj: Any, parameter: dict[str, Any], value: float) -> None:
    """Set a declared number, given in its unit; one that holds it already stays untouched."""
    kind = KINDS[parameter["kind"]]
    held = getattr(obj, title(parameter["name"]))
    wanted = int(value) if parameter["kind"] == "integer" else value * kind.factor
    if getattr(held, "Value", held) != wanted:
        setattr(obj, title(parameter["name"]), wanted)


def choose(obj: Any, declaration: Declaration, chosen: dict[str, str], parameters: dict[str, float]) -> None:
    """Set profiles and parameters [m, rad or 1]."""
    for name, kind in chosen.items():
        if getattr(obj, title(name)) != kind:
            setattr(obj, title(name), kind)
    for parameter in numbers(declaration, chosen):
        put(obj, parameter, parameters[parameter["name"]])


def follow(obj: Any, declaration: Declaration, sizes: dict[str, float]) -> None:
    """Set the sizes that follow from the parameters [m or rad]."""
    for size in declaration["sizes"]:
        put(obj, size, sizes[size["name"]])


def lengths(obj: Any, declaration: Declaration, sizes: dict[str, float]) -> dict[str, float]:
    """Sizes [m] that were edited since they were `sizes`, and decide on a parameter."""
    held = {s["name"]: getattr(obj, title(s["name"])).Value / KINDS[s["kind"]].factor for s in _deciding(declaration)}
    return {name: value for name, value in held.items() if name in sizes and abs(value - sizes[name]) > SAME}


def refit(obj: Any, declaration: Declaration, changed: str) -> None:
    """After a profile was changed: its parameters are shown, and start from their defaults where they must."""
    for choice in declaration["parameters"]:
        if title(choice["name"]) == changed and choice["kind"] == "choice":
            for parameter in choice["choices"][getattr(obj, changed)]:
                if not parameter["low"] <= get(obj, parameter) <= parameter["high"]:
                    put(obj, parameter, parameter["default"])
            show(obj, declaration)


def _deciding(declaration: Declaration) -> list[dict[str, Any]]:
    return [size for size in declaration["sizes"] if size["decides"]]


def _add(obj: Any, name: str, kind: str, group: str, text: str) -> None:
    obj.addProperty(kind, title(name), group, text)


def _type(parameter: dict[str, Any]) -> str:
    return SIGNED if parameter["kind"] == "length" and parameter["low"] < 0 else KINDS[parameter["kind"]].property


def _of_profiles(choice: dict[str, Any]) -> dict[str, tuple[str, str, str]]:
    """Parameter -> (group, type, text with the range in each profile) of all profiles of a field."""
    found: dict[str, tuple[str, str, str]] = {}
    for kind, parameters in choice.get("choices", {}).items():
        for p in parameters:
            before = found[p["name"]][2] if p["name"] in found else p["meaning"]
            found[p["name"]] = (p["group"], _type(p), f"{before}; {kind}: {_span(p)}")
    return found


def _span(parameter: dict[str, Any]) -> str:
    unit = parameter["unit"]
    return f"{shown(parameter['low'], unit)} to {shown(parameter['high'], unit)}"
