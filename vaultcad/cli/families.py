"""`vaultcad families`: what vaults there are."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from vaultcad.cli.errors import refusing
from vaultcad.cli.options import single, span, with_unit
from vaultcad.cli.tables import show_table


def command() -> Any:
    """The command for the program."""
    return single(families, "families")


def families(
    family: Annotated[str | None, typer.Argument(help="A family, in any language; all of them if left out.")] = None,
) -> None:
    """List the families of vaults; of one family its names, components and parameters with their ranges."""
    import families as ideal

    if family is None:
        rows = (
            (c.id, c.title, ", ".join(names[0] for names in c.aliases.values()), str(len(c().components)))
            for c in ideal.FAMILIES
        )
        show_table(("id", "vault", "names", "components"), rows, numbers=[3])
        _show_profiles()
        typer.echo("Parameters of a family: vaultcad families ID")
        return
    with refusing():
        cls = ideal.family(family)
    _show_family(cls)


def _show_family(cls: Any) -> None:
    from families.declaration.facts import LANGUAGES
    from families.declaration.parameters import derived_declarations
    from vaultcad.fit.demands import constraints_of

    vault = cls()
    typer.echo(f"{cls.id}: {cls.title}")
    for code, names in cls.aliases.items():
        typer.echo(f"  {LANGUAGES[code]}: {', '.join(names)}")
    typer.echo(f"  components: {', '.join(vault.components)}")
    for name, kind in vault.kinds.items():
        typer.echo(f"  {name}: {kind}, or another of the profiles")
    values = vault.values()
    rows = [
        (p.name, with_unit(values[p.name], p.range.unit), span(p.range), p.range.meaning) for p in vault.parameters()
    ]
    show_table(("parameter", "default", "range", "meaning"), rows, numbers=[1])
    sizes = vault.derived_values()
    declared = derived_declarations(cls)
    rows = [(name, with_unit(sizes[name], d.unit), "", d.meaning) for name, d in declared.items()]
    show_table(("size that follows", "at defaults", "", "meaning"), rows, numbers=[1])
    held = [(c.name, c.meaning) for c in constraints_of(cls)]
    show_table(("constraint", "what a fit takes for true, unless the scan or --free says otherwise"), held)
    _show_profiles()


def _show_profiles() -> None:
    from families import PROFILES

    rows = []
    for cls in PROFILES:
        profile = cls()
        ranges = "; ".join(f"{p.name} {span(p.range)}" for p in profile.parameters())
        rows.append((cls.id, ", ".join(cls.aliases), ranges))
    show_table(("profile", "names", "parameters"), rows)
