"""A command with one subcommand a family, whose options are the family's declared parameters."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from typing import Any

from typer.core import TyperCommand, TyperGroup

from families import FAMILIES, Vault, family, profile
from families.declaration.lengths import with_lengths
from families.declaration.parameters import Parameter, flat_name
from vaultcad.cli.errors import InputError, refusing
from vaultcad.cli.lengths import length_options
from vaultcad.cli.options import Option, flag, number, read, single, span, with_options

PANEL = "The vault"


class FamilyGroup(TyperGroup):
    """`run(vault class, ..., declared)` as a subcommand a family, with the family's options and `further` ones."""

    def __init__(self, name: str, help: str, run: Callable[..., Any], further: Sequence[Option] = ()) -> None:
        super().__init__(name=name, help=help, subcommand_metavar="FAMILY [OPTIONS]", options_metavar=None)
        self.run, self.further = run, further
        for cls in FAMILIES:
            self.add_command(TyperCommand(cls.id, help=f"{cls.title}."))

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """The command of the family that the first argument names, in any language."""
        name, *rest = args
        with refusing():
            cls = family(name)
        run = with_options(self.run, [*vault_options(cls), *self.further], cls=cls)
        return cls.id, single(run, cls.id, f"{self.help} The vault: {cls.title}."), rest


def vault_options(cls: type[Vault]) -> list[Option]:
    """One option for each parameter and each profile of a family, and for each parameter that some profile has."""
    default = cls()
    values, own, arches = default.values(), {p.path[0]: p for p in default.parameters()}, default.profiles
    options = []
    for name in (field.name for field in fields(cls)):
        if name in arches:
            names = ", ".join(p.id for p in cls.kinds_for(name))
            options.append(Option(name, str, f"one of {names}; default {arches[name].id}", "NAME", PANEL))
            options += _profile_options(cls, name)
        elif name in own:
            p = own[name]
            options.append(number(p.name, p.range, values[p.name], integer=p.integer, panel=PANEL))
    return options + length_options(cls, PANEL)


def vault_of(cls: type[Vault], declared: Mapping[str, Any]) -> Vault:
    """The vault of the options that were given; others of `declared` are left alone.

    Raises:
        InputError: an unknown profile, or a parameter of a profile that is outside its range or that it does not have.
    """
    vault = cls()
    for name in vault.profiles:
        if name in declared:
            with refusing():
                vault = vault.with_arches({name: profile(declared[name])()})
    limits = {p.name: p.range for p in vault.parameters()}
    values = {p.name: declared[p.name] for p in vault.parameters() if p.path[1:] == () and p.name in declared}
    for field in vault.profiles:
        for name, of in _profile_parameters(cls, field).items():
            if name in declared and name not in limits:
                own, having = vault.kinds[field], ", ".join(of)
                raise InputError(
                    f"{flag(name)} {declared[name]}: a {own} profile has no such parameter; "
                    f"add {flag(field)} with one of {having}"
                )
            if name in declared:
                values[name] = read(declared[name], name, limits[name])
    lengths = {name: declared[name] for name in cls.ratios if name in declared}
    for name, ratio in cls.ratios.items():
        if name in lengths and ratio in declared:
            raise InputError(f"{flag(name)} and {flag(ratio)} say the same; leave one out")
    vault = vault.replaced(values)
    if lengths:
        with refusing():
            return with_lengths(vault, lengths, called=flag)
    return vault


def _profile_parameters(cls: type[Vault], field: str) -> dict[str, dict[str, Parameter]]:
    """Flat parameter name of a profile field -> profile id -> declaration, over all profiles that it may have."""
    found: dict[str, dict[str, Parameter]] = {}
    for kind in cls.kinds_for(field):
        for p in kind().parameters():
            found.setdefault(flat_name(field, p.name), {})[kind.id] = p
    return found


def _profile_options(cls: type[Vault], field: str) -> list[Option]:
    options = []
    for name, of in _profile_parameters(cls, field).items():
        ranges = ", ".join(f"{id_} {span(p.range)}" for id_, p in of.items())
        meaning = next(iter(of.values())).range.meaning
        # Read when the profile is known, which decides on the range.
        options.append(Option(name, str, f"{meaning}, of {flag(field)}: {ranges}", "NUMBER", PANEL))
    return options
