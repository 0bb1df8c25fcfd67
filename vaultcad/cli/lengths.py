"""An option for each length that people measure, in place of the ratio that a family is declared with."""

from __future__ import annotations

from families import Vault
from families.declaration.parameters import derived_declarations
from vaultcad.cli.options import Bounds, Option, flag, read

LONGEST_LENGTH = 1000.0  # m, so that what is no length is told at once


def length_options(cls: type[Vault], panel: str) -> list[Option]:
    """An option for each length of a family."""
    declared = derived_declarations(cls)

    def option(name: str, ratio: str) -> Option:
        limits = Bounds(-LONGEST_LENGTH, LONGEST_LENGTH, "m", declared[name].meaning)
        text = f"{limits.meaning}; in place of {flag(ratio)}"
        return Option(name, float, text, "M", panel, lambda text: read(text, name, limits))

    return [option(name, ratio) for name, ratio in cls.ratios.items()]
