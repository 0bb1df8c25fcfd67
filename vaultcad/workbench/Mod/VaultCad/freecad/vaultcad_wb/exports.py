"""Vaults of the document as STEP, IFC or GLB, through vaultcad's own exporters."""

from __future__ import annotations

from typing import Any

from .client import BUILDER
from .fit import pose, report
from .vault import MM

FILTERS = "STEP (*.step *.stp);;IFC (*.ifc);;GLB (*.glb)"


def export(vaults: list[Any], path: str) -> None:
    """Write vaults to a file, whose suffix says how, each with its own thickness and label.

    Raises:
        client.RefusedError: it cannot be; why.
        client.GoneError: the worker ended.
        ValueError: a vault is tilted.
    """
    asked = []
    for obj in vaults:
        request = obj.Proxy.request(obj)
        told = {name: request[name] for name in ("family", "profiles", "parameters")}
        own = {"label": obj.Label, "thickness": obj.Thickness.Value / MM}
        asked.append({**(report(obj) or {}), **told, **own, "pose": pose(obj)})
    scans = [obj.Scan for obj in vaults if getattr(obj, "Scan", None) is not None]
    BUILDER.ask(
        "export",
        path=path,
        name=scans[0].Label if scans else vaults[0].Document.Label,
        origin=list(scans[0].Origin) if scans else [0.0, 0.0, 0.0],
        vaults=asked,
    )
