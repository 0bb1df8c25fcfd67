"""Declarations into options: a parameter's range, unit and meaning become --name, its help and its check."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from math import inf, isfinite, pi
from typing import Annotated, Any, Literal, NamedTuple, Protocol

import typer

from vaultcad.cli.errors import InputError

SHOWN = {"m": ("m", 1.0), "rad": ("°", 180 / pi), "1": ("", 1.0)}
"""Unit of a declaration -> the unit that people read, and its factor."""
Axis = Literal["z", "y", "x", "-z", "-y", "-x"]
"""As `segmentation.cloud.Up`, which takes too long to import."""
METAVAR = {"m": "M", "rad": "DEG", "1": "NUMBER"}


class Limits(Protocol):
    """A declared range: of `families`, of `segmentation`, or of here."""

    @property
    def low(self) -> float:
        """Least value."""

    @property
    def high(self) -> float:
        """Greatest value; infinite where there is none."""

    @property
    def unit(self) -> str:
        """One of "m", "rad", "1"."""

    @property
    def meaning(self) -> str:
        """What the number says."""


class Bounds(NamedTuple):
    """The range of a number that no dataclass declares."""

    low: float
    high: float
    unit: str
    meaning: str


@dataclass(frozen=True)
class Option:
    """An option that is not written out in a command's signature. `name` is that of the value, kind its type."""

    name: str
    kind: Any
    help: str
    metavar: str | None = None
    panel: str | None = None
    parser: Callable[[str], Any] | None = None

    def parameter(self) -> inspect.Parameter:
        """As a keyword of a signature that typer reads; None where it is not given."""
        flags = f"{flag(self.name)}/--no-{flag(self.name)[2:]}" if self.kind is bool else flag(self.name)
        info = typer.Option(
            None,
            flags,
            help=self.help,
            metavar=self.metavar,
            rich_help_panel=self.panel,
            parser=self.parser,
            show_default=False,
        )
        return inspect.Parameter(self.name, inspect.Parameter.KEYWORD_ONLY, default=info, annotation=self.kind | None)


def flag(name: str) -> str:
    """The option of a parameter: span_x -> --span-x."""
    return "--" + name.replace("_", "-")


def number(
    name: str, limits: Limits, default: float | str, *, integer: bool = False, panel: str | None = None
) -> Option:
    """The option of one declared number; angles are given in degrees. A default may be a text for the help."""
    ending = default if isinstance(default, str) else f"default {with_unit(default, limits.unit)}"
    text = f"{limits.meaning}; {span(limits)}, {ending}"
    metavar = "N" if integer else METAVAR[limits.unit]
    return Option(name, float, text, metavar, panel, lambda text: read(text, name, limits, integer=integer))


def number_info(name: str, limits: Limits, *, integer: bool = False) -> Any:
    """The same for an option that is written out in a command's signature, with its default there."""
    return typer.Option(
        flag(name),
        help=f"{limits.meaning}; {span(limits)}.",
        metavar="N" if integer else METAVAR[limits.unit],
        parser=lambda text: read(text, name, limits, integer=integer),
    )


def read(text: str, name: str, limits: Limits, *, integer: bool = False) -> float:
    """The value that is meant, in the unit of its declaration; whole numbers may be written as 1e6.

    Raises:
        InputError: it is no number, no whole number where one is needed, or outside the range.
    """
    said = f"{flag(name)} {text}"
    try:
        value = float(text) / SHOWN[limits.unit][1]
    except ValueError:
        raise InputError(f"{said}: is no number; give {span(limits)}") from None
    if not isfinite(value) or not limits.low <= value <= limits.high:
        raise InputError(f"{said}: lies outside what can be; give {span(limits)}")
    if integer and value != int(value):
        raise InputError(f"{said}: is no whole number; give {span(limits)}")
    return int(value) if integer else value


def span(limits: Limits) -> str:
    """The range in words: "0.5 to 40 m", "0 m or more"."""
    if limits.high == inf:
        return f"{with_unit(limits.low, limits.unit)} or more"
    return f"{limits.low * SHOWN[limits.unit][1]:.6g} to {with_unit(limits.high, limits.unit)}"


def with_unit(value: float, unit: str) -> str:
    """A value in the unit that people read: "0.5 m", "25°"."""
    name, factor = SHOWN[unit]
    return f"{value * factor:.6g}{' ' if name.isalpha() else ''}{name}"


def with_options(command: Callable[..., Any], options: Iterable[Option], **bound: Any) -> Callable[..., Any]:
    """`command` with further options: those that the user gave reach it as the dict `declared`, by name.

    `bound`: arguments of the command that are settled, and are no options.
    """
    names = {option.name: option for option in options}
    own = inspect.signature(command, eval_str=True).parameters.values()

    def run(**given: Any) -> Any:
        declared = {name: value for name in names if (value := given.pop(name)) is not None}
        return command(**given, **bound, declared=declared)

    run.__doc__, run.__name__ = command.__doc__, command.__name__
    free = [p.replace(kind=p.KEYWORD_ONLY) for p in own if p.name != "declared" and p.name not in bound]
    signature = inspect.Signature([*free, *(option.parameter() for option in names.values())])
    run.__signature__ = signature  # type: ignore[attr-defined]  # inspect and typer read it, mypy does not know it
    return run


def single(command: Callable[..., Any], name: str, help: str | None = None) -> Any:
    """A command for the program's table of commands; its help is the docstring where none is given."""
    from typer.main import get_command

    app = typer.Typer(add_completion=False)
    app.command(name, help=help)(command)
    return get_command(app)


Seed = Annotated[int, number_info("seed", Bounds(0, inf, "1", "of all that is random"), integer=True)]
Vault = Annotated[
    int | None, number_info("vault", Bounds(1, inf, "1", "number of a vault; all if left out"), integer=True)
]
Vaults = Annotated[
    list[int] | None,
    number_info("vault", Bounds(1, inf, "1", "number of a vault, may be repeated; all if left out"), integer=True),
]
Force = Annotated[
    bool, typer.Option("--force", help="Replace an earlier result although a person has changed it since.")
]
InSpace = Annotated[
    Literal["file", "metres"],
    typer.Option("--coordinates", help="Of lines in space: as the scan's file has them, or metres with z up."),
]
"""As `vaultcad.coordinates.Coordinates`, which takes too long to import."""
AsBuilt = Annotated[
    Literal["ideal", "as-built", "both"],
    typer.Option(
        "--as-built", help="Bodies in STEP, IFC and GLB: of the ideal vault, of the stone as it stands, or both."
    ),
]
"""As `vaultcad.model.Drawn`, which takes too long to import."""
