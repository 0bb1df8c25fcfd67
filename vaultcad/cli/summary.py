"""What a fit found, in a few lines."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import typer

from families import Profile
from vaultcad.cli.tables import show_table
from vaultcad.model import FLAGS, Estimate, FittedVault, Model


def show_summary(model: Model, out: Path) -> None:
    """The vaults of a model, and the files of its folder, on standard output."""
    for fitted in model.vaults:
        show_table(("", ""), _rows(fitted))
    typer.echo(f"{out}: {', '.join(sorted(path.name for path in out.iterdir()))}")


def _rows(fitted: FittedVault) -> Iterator[tuple[str, str]]:
    yield "family", f"{fitted.vault.title} ({fitted.vault.id}), confidence {fitted.confidence:.0%}"
    others = ", ".join(f"{name} {score:.0%}" for name, score in fitted.alternatives[:3])
    if others:
        yield "or else", others
    for name, value in vars(fitted.vault).items():
        if isinstance(value, Profile):
            yield name, value.id
    for name, estimate in fitted.parameters.items():
        if estimate.unit == "m":
            yield name, _size(estimate)
    flags = {flag for estimate in fitted.parameters.values() if estimate.unit == "m" for flag in estimate.flags}
    for flag, (sign, text) in FLAGS.items():
        if flag in flags:
            yield sign, text
    d = fitted.deviation
    near = ", ".join(f"{share:.0%} within {1000 * limit:g} mm" for limit, share in d.within.items())
    yield "deviation", f"rms {1000 * d.rms:.1f} mm, 95% below {1000 * d.p95:.1f} mm; {near}; {d.loa}"
    if fitted.as_built is not None:
        yield "as built", f"rms {1000 * fitted.as_built.rms:.1f} mm from the smooth surface through the points"
    points = sum(c.points for c in fitted.components)
    yield (
        "coverage",
        f"{fitted.coverage:.0%} of the intrados seen, in {points:,} points of {len(fitted.components)} components",
    )
    if not fitted.converged:
        yield "note", "the fit did not settle; look at the report before you use it"


def _size(estimate: Estimate) -> str:
    std = "" if not estimate.std else f" ± {1000 * estimate.std:.1f} mm"
    return f"{estimate.value:.3f} m{std} {estimate.marks}".rstrip()
