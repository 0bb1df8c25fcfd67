"""Runs the benchmarks that are named, or all, and shows their tables; `compare OLD NEW` says what got worse."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from bench import (
    barren,
    buildings,
    cost,
    defaults,
    deformation,
    further,
    limits,
    measured,
    profiles,
    regressions,
    rooms,
    sections,
    shapes,
    strangers,
    tables,
    uncertainty,
    workbench,
)
from bench.peers import table as peers
from bench.record import Record

BENCHMARKS = {
    "shapes": shapes.run,
    "cost": cost.run,
    "further": further.run,
    "peers": peers.run,
    "rooms": rooms.run,
    "buildings": buildings.run,
    "barren": barren.run,
    "strangers": strangers.run,
    "profiles": profiles.run,
    "limits": limits.run,
    "defaults": defaults.run,
    "uncertainty": uncertainty.run,
    "sections": sections.run,
    "deformation": deformation.run,
    "workbench": workbench.run,
}


def main(arguments: list[str]) -> int:
    """The command line."""
    if arguments[:1] == ["compare"]:
        return regressions.main(arguments[1:])
    parser = argparse.ArgumentParser(prog="python -m bench", description=__doc__)
    parser.add_argument("names", nargs="*", default=[], help=f"any of {', '.join(BENCHMARKS)}; all if none is named")
    parser.add_argument("--json", type=Path, help="file for the figures, with date, machine, versions and revision")
    parser.add_argument("--write", action="store_true", help=f"put the figures into docs/{measured.PAGE.name}")
    parser.add_argument("--seeds", type=int, default=3, help="seeds of each ideal cloud (shapes), default 3")
    parser.add_argument("--points", type=int, default=1_000_000, help="points of a cloud, default 1000000")
    for module in (
        cost,
        further,
        peers,
        rooms,
        buildings,
        barren,
        strangers,
        profiles,
        limits,
        defaults,
        uncertainty,
        deformation,
        sections,
    ):
        module.options(parser)
    chosen = parser.parse_args(arguments)
    unknown = sorted(set(chosen.names) - set(BENCHMARKS))
    if unknown:
        parser.error(f"no benchmark {', '.join(unknown)}; there are {', '.join(BENCHMARKS)}")
    record = Record.here()
    print(record.told)
    for name in chosen.names or BENCHMARKS:
        record.benchmarks[name] = tuple(map(tables.show, BENCHMARKS[name](chosen)))
        if chosen.json:  # after each, for they take long
            record.write(chosen.json)
        if chosen.write:
            measured.write(record)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
