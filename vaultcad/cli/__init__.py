"""The command line: `main` is its entry point, every command a file of its own, heavy imports inside the commands."""

from vaultcad.cli.app import main

__all__ = ["main"]
