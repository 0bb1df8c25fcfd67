"""What a fit found, in a few lines."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import typer

from vaultcad.cli.tables import show_table
from vaultcad.measure.building import building_of
from vaultcad.model import FittedVault, Model, said
from vaultcad.uncertain import FLAGS, Estimate


def show_summary(model: Model, out: Path) -> None:
    """The vaults of a model, and the files of its folder, on standard output; a building as a table of its bays."""
    if len(model.vaults) > 1:
        _show_building(model)
    else:
        show_table(("", ""), _rows(model.vaults[0], float(model.origin[2])))
    if told := _ceiling(model.ceiling):
        typer.echo(told)
    typer.echo(f"{out}: {', '.join(sorted(path.name for path in out.iterdir() if not path.name.startswith('.')))}")


def _show_building(model: Model) -> None:
    """A line a vault in the order of the rows, and one for all arches."""
    building, up = building_of(model), float(model.origin[2])
    head = ("no", "bay", "family", "sure", "plan, m", "rise", "springing", "rms, mm")
    rows = []
    for k in (k for row in building.rows for k in row):
        fitted = model.vaults[k - 1]
        low, high = fitted.vault.plan.box
        plan = " × ".join(f"{side:.2f}" for side in (high - low).tolist())
        rise = fitted.vault.derived_values()["rise"]
        figures = (f"{fitted.confidence:.0%}", plan, f"{rise:.2f}", f"{fitted.pose.z + up:.2f}")
        name = "{}{}".format(*building.bay(k))
        rows.append((f"{k}", name, fitted.vault.id, *figures, f"{1000 * fitted.deviation.rms:.1f}"))
    show_table(head, rows, numbers=(0, 3, 4, 5, 6, 7))
    if model.arches:
        typer.echo(f"{_arches(model)}\n")


def _arches(model: Model) -> str:
    """All of them in one line."""
    kinds = Counter(arch.vault.kinds["profile"] for arch in model.arches)
    told = ", ".join(f"{count} {kind}" for kind, count in sorted(kinds.items(), key=lambda one: (-one[1], one[0])))
    spans = _range([arch.vault.values()["span"] for arch in model.arches], 2)
    rms = _range([1000 * arch.deviation.rms for arch in model.arches], 1)
    return f"{len(model.arches)} arch{'es' * (len(model.arches) > 1)}: {told}; spans {spans} m, rms {rms} mm"


def _range(values: Sequence[float], decimals: int) -> str:
    low, high = (f"{value:.{decimals}f}" for value in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"


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


def _ceiling(ceiling: Mapping[str, float]) -> str:
    """What hangs over rooms is what; nothing where it was not looked at."""
    parts = [f"{area:.1f} m² {name}" for name, area in ceiling.items() if name != "area" and area > 0]
    return f"ceiling {ceiling['area']:.1f} m²: {', '.join(parts)}" if parts else ""


def _odds(odds: Mapping[str, float]) -> str:
    """How likely each of the kinds that are said is."""
    told = ", ".join(f"{odds[kind]:.0%}" for kind in said(odds))
    return f" ({told})" if told else ""


def _size(estimate: Estimate) -> str:
    return f"{_length(estimate.value, estimate.std)} {estimate.marks}".rstrip()


def _length(value: float, std: float | None) -> str:
    return f"{value:.3f} m" + (f" ± {1000 * std:.1f} mm" if std else "")
