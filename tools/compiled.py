"""Has numba compile what the tests will call: once, and not by each of their workers.

    python -m tools.compiled

A scan goes the way that leads through most of what is compiled; numba keeps that beside the code.
"""

import sys
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory

from vaultcad.cli import main

SCAN = Path(__file__).parents[1] / "examples" / "room.laz"


def compile_all() -> str:
    """What was said when one of the commands failed; empty if none did."""
    with TemporaryDirectory() as folder, redirect_stdout(StringIO()) as said, redirect_stderr(said):
        out = Path(folder)
        fit = ("fit", str(SCAN), "-o", str(out / "fit"), "--family", "groin", "--review")
        segment = ("segment", str(SCAN), "-o", str(out / "segments.laz"))
        later = [(name, str(out / "fit"), "-o", str(out / name)) for name in ("drawings", "nurbs", "unroll")]
        return said.getvalue() if any(main(list(command)) for command in (fit, segment, *later)) else ""


if __name__ == "__main__":
    sys.exit(compile_all() or 0)
