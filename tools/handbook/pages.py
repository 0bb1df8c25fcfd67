"""What docs/families.md, its pictures and the README's table say of the families, from their declarations."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import partial
from inspect import getdoc
from pathlib import Path

from families import FAMILIES, PROFILES, Vault
from families.declaration.facts import LANGUAGES
from families.declaration.parameters import derived_declarations
from families.drawing.svg import document
from families.drawing.view import view
from tools.sections import replaced
from vaultcad.cli.options import span, with_unit
from vaultcad.export.drawing import ideal_plan
from vaultcad.fit.demands import constraints_of

ROOT = Path(__file__).parents[2]
PAGE, PICTURES, README = ROOT / "docs" / "families.md", ROOT / "docs" / "img", ROOT / "README.md"
SIDE = 360.0  # of a picture, the longer one, in pixels
THICKNESS = 0.15  # [m] of the masonry in plan
DRAWN = {  # each picture, not yet drawn
    PICTURES / f"{cls.id}-{what}.svg": partial(draw, cls())
    for cls in FAMILIES
    for what, draw in (("plan", partial(ideal_plan, thickness=THICKNESS)), ("view", view))
}
LAST = "## Add a family in ten minutes"  # the section before which a new family comes


def pages() -> dict[Path, str]:
    """The text of each file that depends on the declarations."""
    page = replaced(PAGE.read_text(encoding="utf-8"), "arches", "profiles", profiles())
    for cls in FAMILIES:
        page = replaced(page, "family", cls.id, family(cls), before=LAST)
    readme = replaced(README.read_text(encoding="utf-8"), "table of", "families", overview())
    return {PAGE: page, README: readme, **pictures()}


def pictures() -> dict[Path, str]:
    """Plan and view of each family, as SVG."""
    drawings = {path: draw() for path, draw in DRAWN.items()}
    return {path: document(drawing, SIDE / max(drawing.size)) for path, drawing in drawings.items()}


def overview() -> str:
    """A row a family: id, name, components, its first name in each language."""
    head = ("id", "vault", "components", *LANGUAGES.values())
    rows = (
        (f"`{c.id}`", c.title, str(len(c().components)), *(_first(c, code) for code in LANGUAGES)) for c in FAMILIES
    )
    return table(head, rows)


def _first(cls: type[Vault], code: str) -> str:
    name = cls.aliases[code][0]
    return name.capitalize() if code == "de" else name  # a noun, and in German written as one


def family(cls: type[Vault]) -> str:
    """Picture, description, components, parameters, sizes that follow, constraints and words of a family."""
    vault, values, sizes = cls(), cls().values(), cls().derived_values()
    blocks = [
        f"![Plan of the {cls.title}]({PICTURES.name}/{cls.id}-plan.svg)\n"
        f"![Lines on its intrados, seen from above]({PICTURES.name}/{cls.id}-view.svg)",
        getdoc(cls) or "",
        f"Components: {', '.join(f'`{name}`' for name in vault.components)}.",
        table(
            ("parameter", "default", "range", "meaning"),
            (
                *((f"`{name}`", kind, _kinds(cls, name), "kind of arch") for name, kind in vault.kinds.items()),
                *(
                    (f"`{p.name}`", with_unit(values[p.name], p.range.unit), span(p.range), p.range.meaning)
                    for p in vault.parameters()
                ),
            ),
        ),
        table(
            ("size that follows", "at defaults", "meaning"),
            (
                (f"`{name}`", with_unit(sizes[name], declared.unit), declared.meaning)
                for name, declared in derived_declarations(cls).items()
            ),
        ),
        table(
            ("constraint", "what a fit takes for true, unless the scan or `--free` says otherwise"),
            ((f"`{c.name}`", c.meaning) for c in constraints_of(cls)),
        ),
        table(("language", "names"), ((LANGUAGES[code], ", ".join(names)) for code, names in cls.aliases.items())),
    ]
    return "\n\n".join(filter(None, blocks))


def _kinds(cls: type[Vault], arch: str) -> str:
    kinds = cls.kinds_for(arch)
    return "any profile" if kinds == PROFILES else ", ".join(kind.id for kind in kinds)


def profiles() -> str:
    """A row a profile: names, what it is, its parameters with their ranges."""
    rows = []
    for cls in PROFILES:
        ranges = "; ".join(f"`{p.name}` {span(p.range)}, {p.range.meaning}" for p in cls().parameters())
        rows.append((f"`{cls.id}`", getdoc(cls) or "", ranges, ", ".join(cls.aliases)))
    return table(("profile", "what it is", "parameters", "names"), rows)


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table in Markdown; nothing where there are no rows."""
    body = [" | ".join(cell.replace("|", "\\|").replace("\n", " ") for cell in row) for row in rows]
    rule = "|".join("---" for _ in head)
    return "\n".join([f"| {' | '.join(head)} |", f"|{rule}|", *(f"| {row} |" for row in body)]) if body else ""
