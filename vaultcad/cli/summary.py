"""What a fit found, in a few lines."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import typer

from vaultcad.cli.tables import show_table
from vaultcad.model import FLAGS, Estimate, FittedVault, Model, said


def show_summary(model: Model, out: Path) -> None:
    """The vaults of a model, and the files of its folder, on standard output."""
    for fitted in model.vaults:
        show_table(("", ""), _rows(fitted, float(model.origin[2])))
    typer.echo(f"{out}: {', '.join(sorted(path.name for path in out.iterdir() if not path.name.startswith('.')))}")


def _rows(fitted: FittedVault, up: float) -> Iterator[tuple[str, str]]:
    """Up: height of the scan's origin [m]."""
    yield "family", f"{fitted.vault.title} ({fitted.vault.id}), confidence {fitted.confidence:.0%}"
    others = ", ".join(f"{name} {score:.0%}" for name, score in fitted.alternatives[:3])
    if others:
        yield "or else", others
    if fitted.doubt:
        yield "doubt", fitted.unlike
    for name, kinds in fitted.arches.items():
        yield name, kinds + _odds(fitted.odds.get(name, {}))
    spread = {} if fitted.covariance is None else fitted.covariance.stds()
    yield "springing", f"at {_length(fitted.pose.z + up, spread.get('z'))}"
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


def _odds(odds: Mapping[str, float]) -> str:
    """How likely each of the kinds that are said is."""
    told = ", ".join(f"{odds[kind]:.0%}" for kind in said(odds))
    return f" ({told})" if told else ""


def _size(estimate: Estimate) -> str:
    return f"{_length(estimate.value, estimate.std)} {estimate.marks}".rstrip()


def _length(value: float, std: float | None) -> str:
    return f"{value:.3f} m" + (f" ± {1000 * std:.1f} mm" if std else "")
