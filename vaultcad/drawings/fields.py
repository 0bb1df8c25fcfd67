"""What every title block says: the scan, where it lies, units, who drew it and when."""

from __future__ import annotations

from collections.abc import Iterator

from segmentation.io.stamp import stamp
from vaultcad.model import Assembly


def scan_fields(model: Assembly) -> Iterator[tuple[str, str]]:
    """Label and text. The day is told where SOURCE_DATE_EPOCH does."""
    yield "scan", model.scan.name
    yield "heights from", model.place
    made = f"vaultcad {model.versions.get('vaultcad', '')}".strip()
    day = stamp()
    yield "drawn by", f"{made}{f', {day:%Y-%m-%d}' if day.timestamp() else ''}; lengths in metres"
