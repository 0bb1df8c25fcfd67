"""What got worse from one run to another: `python -m bench compare OLD NEW`.

A figure is worse if it moved in its bad direction by more than its noise: that of its column, or, for shares of drawn
cases, two standard deviations of their difference (the pooled test of two proportions). Less than two units of the last
shown digit tell nothing either.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import dataclass
from math import inf, sqrt
from pathlib import Path

from bench.figures import Column, Figure, Table
from bench.record import Record
from bench.tables import told

STANDARD_DEVIATIONS, DIGITS = 2.0, 2.0
OF_THE_MACHINE = ("s", "ms", "µs")  # units of what another machine changes, and other work on it
WORSE, REFUSED = 1, 2


@dataclass(frozen=True)
class Change:
    """One figure in both runs. where: benchmark, table, row and column. verdict: "worse", "better" or ""."""

    where: str
    old: str
    new: str
    ratio: float
    verdict: str


def main(arguments: list[str]) -> int:
    """The command line: tells what got worse, then what got better; 1 if something got worse."""
    parser = argparse.ArgumentParser(prog="python -m bench compare", description=__doc__)
    parser.add_argument("old", type=Path, help="figures of the earlier run, of --json")
    parser.add_argument("new", type=Path, help="those of the later one")
    chosen = parser.parse_args(arguments)
    try:
        old, new = Record.read(chosen.old), Record.read(chosen.new)
    except ValueError as error:
        print(error)
        return REFUSED
    print(f"old: {old.told}\nnew: {new.told}")
    if reason := untimed(old, new):
        print(f"{reason}: times are not judged")
    changes, left_out = compared(old, new)
    for reason in left_out:
        print(f"not compared: {reason}")
    for verdict in ("worse", "better"):
        for change in (c for c in changes if c.verdict == verdict):
            print(f"{verdict:6}  {change.where}: {change.old} -> {change.new}, x {change.ratio:.3f}")
    worse, better = (sum(c.verdict == v for c in changes) for v in ("worse", "better"))
    print(f"{len(changes)} figures compared: {worse} worse, {better} better")
    if not changes:
        return REFUSED
    return WORSE if worse else 0


def untimed(old: Record, new: Record) -> str:
    """Why times tell nothing; empty where they do."""
    if old.machine != new.machine:
        return "the machines differ"
    if max(old.load, new.load) >= float(old.machine["cores"]):
        return "other work kept the machine busy"
    return ""


def compared(old: Record, new: Record) -> tuple[list[Change], list[str]]:
    """All figures that both runs have and that have a good direction; and what was left out, with the reason."""
    changes: list[Change] = []
    left_out: list[str] = []
    timed = not untimed(old, new)
    for name in sorted({*old.benchmarks, *new.benchmarks}):
        before = {table.name: table for table in old.benchmarks.get(name, ())}
        after = {table.name: table for table in new.benchmarks.get(name, ())}
        for key in [*before, *(key for key in after if key not in before)]:
            where = f"{name}, {key}"
            if key not in before or key not in after:
                left_out.append(f"{where}: only in the {'new' if key in after else 'old'} run")
            elif before[key].settings != after[key].settings:
                left_out.append(f"{where}: the settings differ")
            else:
                changes += _changes(where, before[key], after[key], timed)
                rows, others = _rows(before[key]), _rows(after[key])
                left_out += [f"{where}, {row}: only in the old run" for row in rows if row not in others]
    return changes, left_out


def _changes(where: str, before: Table, after: Table, timed: bool) -> Iterator[Change]:
    old, new = _rows(before), _rows(after)
    for row in (row for row in new if row in old):
        for column in after.columns:
            if column.better and (timed or column.unit not in OF_THE_MACHINE) and column.name in old[row]:
                was, now = old[row][column.name], new[row][column.name]
                if isinstance(was, int | float) and isinstance(now, int | float):
                    cases = _cases(old[row], column), _cases(new[row], column)
                    ratio = now / was if was else (1.0 if now == was else inf)
                    place = f"{where}, {row}, {column.name}"
                    yield Change(place, told(column, was), told(column, now), ratio, verdict(column, was, now, cases))


def verdict(column: Column, old: float, new: float, cases: tuple[float, float] = (1.0, 1.0)) -> str:
    """Whether a figure is "worse" or "better"; "" where the difference is noise. cases: of shares, in either run."""
    gained = new - old if column.better == "more" else old - new
    if column.of:
        shares = (old, new) if column.unit == "%" else (old / cases[0], new / cases[1])
        pooled = (shares[0] * cases[0] + shares[1] * cases[1]) / sum(cases)
        noise = STANDARD_DEVIATIONS * sqrt(max(0.0, pooled * (1 - pooled)) * (1 / cases[0] + 1 / cases[1]))
        told_apart = abs(shares[1] - shares[0]) > noise
    else:
        digit = 10.0 ** -(column.decimals or 0)
        told_apart = abs(gained) > column.noise * min(abs(old), abs(new)) and abs(gained) >= DIGITS * digit
    if not told_apart or gained == 0:
        return ""
    return "better" if gained > 0 else "worse"


def _rows(table: Table) -> dict[str, dict[str, Figure]]:
    """What tells a row from the others -> name of a column -> figure."""
    names = [column.name for column in table.columns]
    labels = [k for k, column in enumerate(table.columns) if column.names]
    return {
        " ".join(str(row[k]) for k in labels) or "all": dict(zip(names, row, strict=True))
        for row in map(tuple, table.rows)
    }


def _cases(row: dict[str, Figure], column: Column) -> float:
    found = row.get(column.of)
    return float(found) if isinstance(found, int | float) and found > 0 else 1.0
