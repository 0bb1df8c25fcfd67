"""The section of report.html on how a vault seems to have moved."""

from __future__ import annotations

from html import escape

from vaultcad.export.movements import movement_table, resemblance_table
from vaultcad.model import FittedVault


def deformation_section(fitted: FittedVault) -> str:
    """Verdict, figures against each reference, and what they resemble; nothing where there is no reading."""
    told = fitted.deformation
    if told is None:
        return ""
    tables = "".join(
        f"<details{' open' if k == 0 else ''}><summary>Against {escape(one.reference)}</summary>"
        f"{movement_table(one.movements)}</details>"
        for k, one in enumerate(told.against)
    )
    caution = "".join(f"<li>{escape(line)}</li>" for line in told.caution)
    return (
        f"<section><h2>Deformation</h2><p class='lead'>{escape(told.verdict)}</p>{resemblance_table(told)}<p></p>"
        f"{tables}<ul class='soft'>{caution}</ul>"
        "<p class='soft'>Azimuths count clockwise from the scan's +y axis. Limits allow for noise, relief, uneven "
        "waves of the stone, the registration of stations, and for what the reference may be wrong by.</p></section>"
    )
