"""`vaultcad doctor`: the state of the installation."""

from __future__ import annotations

from typing import Any

import typer

from vaultcad.cli.options import single
from vaultcad.cli.tables import show_table


def command() -> Any:
    """The command for the program."""
    return single(doctor, "doctor")


def doctor() -> int:
    """Say what of the installation is missing or broken, and the command that mends it.

    Ends with exit code 1 if something is that vaultcad cannot do without.
    """
    from vaultcad.cli.status import status
    from vaultcad.doctor import examine

    with status(["trying every library"]):
        findings = examine()
    show_table(
        ("", "version", "state", ""),
        (
            (f.name, f.version, f.state + (" (optional)" if f.optional and f.state != "ok" else ""), f.detail)
            for f in findings
        ),
    )
    for finding in findings:
        if finding.remedy:
            typer.echo(f"{finding.name}: {finding.remedy}")
    return int(any(f.state != "ok" and not f.optional for f in findings))
