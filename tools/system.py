"""Find what the operating system lacks before anything is installed, and install it where the user may.

Where the user is not root, one line names the missing packages and the command, and the exit status is 1.
Standard library only: it runs under the bare interpreter that .venv is then made from.
"""

import ctypes
import importlib
import importlib.util
import os
import runpy
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def loads(library: str) -> bool:
    """Whether the dynamic linker finds a shared library, for example "libusb-1.0.so.0"."""
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True


def missing() -> dict[str, str]:
    """What is not there, mapped to the Debian package that holds it."""
    importlib.invalidate_caches()
    lacking = {}
    if importlib.util.find_spec("ensurepip") is None:
        lacking["ensurepip"] = f"python3.{sys.version_info.minor}-venv"
    if sys.platform == "linux":
        # By path, for the package itself cannot be imported from an interpreter without its dependencies.
        libraries: dict[str, str] = runpy.run_path(str(ROOT / "vaultcad" / "doctor.py"))["LIBRARIES"]
        lacking |= {library: package for library, package in libraries.items() if not loads(library)}
    return lacking


def main() -> None:
    """Install what is missing, or exit with a line that says how to."""
    lacking = missing()
    if not lacking:
        return
    if shutil.which("apt-get") is None:
        sys.exit(f"vaultcad needs {', '.join(lacking)}: install them with this system's package manager")
    packages = sorted(set(lacking.values()))
    install = ["apt-get", "install", "-y", "--no-install-recommends", *packages]
    if os.geteuid() != 0:
        sys.exit(f"vaultcad needs {', '.join(lacking)}: sudo apt-get update && sudo {' '.join(install)}")
    sys.stdout.write(f"{' '.join(install)}\n")
    environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    for command in (["apt-get", "update"], install):
        run = subprocess.run(
            [*command, "-qq"], env=environment, stdin=subprocess.DEVNULL, capture_output=True, check=False
        )
        if run.returncode:
            sys.stderr.write(run.stderr.decode(errors="replace"))
            sys.exit(f"`{' '.join(command)}` failed; vaultcad needs {', '.join(lacking)}")
    if lacking := missing():
        sys.exit(f"vaultcad still lacks {', '.join(lacking)} after `{' '.join(install)}`")


if __name__ == "__main__":
    main()
