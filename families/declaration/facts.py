"""What every family has to say of itself: asked for when its class is made, read through when it is registered."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import TYPE_CHECKING

from families.declaration.footprint import SHAPES
from families.declaration.parameters import derived_declarations

if TYPE_CHECKING:
    from families.declaration.vault import Vault

FACTS = {
    "id": 'what it is called in files and on the command line, such as "groin"',
    "title": 'what people call it, such as "groin vault"',
    "aliases": "its names by the code of their language",
    "roof_type": 'what IFC calls it, of IfcRoofTypeEnum; "USERDEFINED" if nothing there suits',
    "ratios": "the lengths that people measure, each with the one parameter that it decides; {} if there are none",
    "quarter_turn": "what a turn by a right angle changes; None if it is no vault of the family then",
    "components": "the names of its components",
    "plan": "the half extents of its plan",
    "pieces": "the void under it",
    "rise": "the height of its crown above the springing, a derived length",
    "first_guesses": "the vaults that a fit looks for first over what a scan shows of their plan",
    "drawn": "how a vault of it is drawn at random, of sizes as they are built",
}
"""What has no default."""
LANGUAGES = {"it": "Italian", "fr": "French", "de": "German", "es": "Spanish"}
"""Of aliases, by code."""
ROOF_TYPES = (
    *("FLAT_ROOF", "SHED_ROOF", "GABLE_ROOF", "HIP_ROOF", "HIPPED_GABLE_ROOF", "GAMBREL_ROOF", "MANSARD_ROOF"),
    *("BARREL_ROOF", "RAINBOW_ROOF", "BUTTERFLY_ROOF", "PAVILION_ROOF", "DOME_ROOF", "FREEFORM", "USERDEFINED"),
)
"""IfcRoofTypeEnum of IFC4."""


def demand_facts(cls: type, base: type) -> None:
    """See that a family says all that has no default; `base` is the class of all families.

    Raises:
        TypeError: it does not; names the fact and what it is.
    """
    own: set[str] = set()
    for kind in cls.__mro__[: cls.__mro__.index(base)]:
        own |= vars(kind).keys()
    for name, meaning in FACTS.items():
        if name not in own:
            raise TypeError(f"family {cls.__name__} lacks `{name}`: {meaning}")


def check_facts(cls: type[Vault]) -> None:
    """See that what a family says names what there is.

    Raises:
        ValueError: it does not; names the fact, the name, and what there is.
    """
    try:
        vault = cls()
    except (TypeError, ValueError) as error:
        raise ValueError(f"family {cls.__name__} cannot be made as it is declared: {error}") from error
    for fact, names, known in _names(vault):
        for name in names:
            if name not in known:
                raise ValueError(f"family {cls.__name__}: `{fact}` names {name!r}; there are {', '.join(known)}")
    for name in vault.profiles:
        if "profile" not in name.split("_"):  # so its parameters find their names
            raise ValueError(f"family {cls.__name__}: `{name}` is an arch; call it profile, profile_{name} or the like")
    if len({*vault.components}) < len(vault.components):
        raise ValueError(f"family {cls.__name__}: two of its `components` have one name")


def _names(vault: Vault) -> Iterator[tuple[str, Collection[str], Collection[str]]]:
    """Facts with the names that stand in them, and the names that there are."""
    arches, lengths = vault.profiles, derived_declarations(type(vault))
    variants = [vault, *(vault.with_arches({name: kind()}) for name in arches for kind in vault.kinds_for(name))]
    sizes = dict.fromkeys(p.name for one in variants for p in one.parameters())
    bodies = [part for piece in vault.pieces() for part in piece.parts]
    yield "aliases", vault.aliases, LANGUAGES
    yield "roof_type", (vault.roof_type,), ROOF_TYPES
    yield "rise", ("rise",), lengths
    yield "pieces", [name for part in bodies for name in getattr(part, "names", ())], vault.components
    for fact, table in (("ratios", vault.ratios), ("held", vault.held)):
        yield fact, table, lengths
        yield fact, table.values(), sizes
    for length, parts in vault.stands_for.items():
        yield "stands_for", (length, *parts(1.0)), sizes | lengths
    yield "usual", vault.usual, sizes
    yield "alike", vault.alike, arches
    yield "raised", vault.raised, arches
    yield "arch_kinds", vault.arch_kinds, arches
    yield "half_turn", () if vault.half_turn is None else vault.half_turn.negated, sizes | lengths
    yield "variants", vault.variants, sizes
    yield "stands_over", (vault.stands_over,), SHAPES
    for constraint in vault.constraints:
        yield f"constraints: {constraint.name}", constraint.holds(vault), sizes
