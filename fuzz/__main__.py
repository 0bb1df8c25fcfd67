"""A table of what becomes of mutants: `python -m fuzz [MUTANTS] [FORMAT …]`."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from fuzz.outcomes import tally
from fuzz.samples import MAKERS

OUTCOMES = ("refused", "told", "same", "silent", "abort", "hang", "traceback", "memory")


def main(number: int, names: list[str], first: int = 0) -> None:
    """Print a line for each format, and what was silent, by the kind of damage, and what else went wrong."""
    print(f"{'format':32}" + "".join(f"{outcome:>10}" for outcome in OUTCOMES), flush=True)
    for name in names or list(MAKERS):
        with tempfile.TemporaryDirectory() as folder:
            found = tally(name, range(first, first + number), Path(folder))
        print(f"{name:32}" + "".join(f"{found.number(outcome):10,}" for outcome in OUTCOMES), flush=True)
        for kind, silent in found.kinds("silent").items():
            print(f"    silent: {kind} {silent:,}")
        for outcome in OUTCOMES[4:]:
            for seed, kind, words in found.examples.get(outcome, [])[:6]:
                print(f"    {outcome}: seed {seed}, {kind}: {words.strip()[-600:]}")


if __name__ == "__main__":
    main(int(sys.argv[1]) if sys.argv[1:] else 300, sys.argv[2:])
