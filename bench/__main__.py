"""Runs the benchmarks that are named, or all, and prints their tables with date and machine."""

from __future__ import annotations

import argparse
import os
import platform
from datetime import date

from bench import barren, cost, defaults, limits, profiles, rooms, shapes, uncertainty, workbench
from bench.peers import table as peers

BENCHMARKS = {
    "shapes": shapes.run,
    "cost": cost.run,
    "peers": peers.run,
    "rooms": rooms.run,
    "barren": barren.run,
    "profiles": profiles.run,
    "limits": limits.run,
    "defaults": defaults.run,
    "uncertainty": uncertainty.run,
    "workbench": workbench.run,
}


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(prog="python -m bench", description=__doc__)
    parser.add_argument("names", nargs="*", default=[], help=f"any of {', '.join(BENCHMARKS)}; all if none is named")
    parser.add_argument("--seeds", type=int, default=3, help="seeds of each ideal cloud (shapes), default 3")
    parser.add_argument("--points", type=int, default=1_000_000, help="points of a cloud, default 1000000")
    cost.options(parser)
    peers.options(parser)
    rooms.options(parser)
    barren.options(parser)
    profiles.options(parser)
    limits.options(parser)
    defaults.options(parser)
    uncertainty.options(parser)
    chosen = parser.parse_args()
    unknown = sorted(set(chosen.names) - set(BENCHMARKS))
    if unknown:
        parser.error(f"no benchmark {', '.join(unknown)}; there are {', '.join(BENCHMARKS)}")
    machine = f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores"
    print(f"{date.today()}, {machine}, Python {platform.python_version()}")
    for name in chosen.names or BENCHMARKS:
        BENCHMARKS[name](chosen)


main()
