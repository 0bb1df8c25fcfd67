"""Ideal masonry vaults: parameters, numeric surfaces, B-Rep and sampling. Knows no scan."""

from families.catalogue import FAMILIES, family, ideal, profile, register
from families.declaration.parameters import Parameter, Range
from families.declaration.profiles import (
    PROFILES,
    BasketHandle,
    Elliptical,
    Pointed,
    Profile,
    Segmental,
    Semicircular,
    Stilted,
)
from families.declaration.ribs import Ribs
from families.declaration.vault import Surface, Vault
from families.kinds.annular import Annular
from families.kinds.barrel import Barrel
from families.kinds.cloister import Cloister
from families.kinds.conch import Conch
from families.kinds.dome import Dome
from families.kinds.groin import Groin
from families.kinds.lunette import Lunette
from families.kinds.mirror import Mirror
from families.kinds.rib import Rib
from families.kinds.rotunda import Rotunda
from families.kinds.sail import Sail
from families.kinds.trough import Trough
from families.kinds.umbrella import Umbrella

__all__ = [
    "FAMILIES",
    "PROFILES",
    "Annular",
    "Barrel",
    "BasketHandle",
    "Cloister",
    "Conch",
    "Dome",
    "Elliptical",
    "Groin",
    "Lunette",
    "Mirror",
    "Parameter",
    "Pointed",
    "Profile",
    "Range",
    "Rib",
    "Ribs",
    "Rotunda",
    "Sail",
    "Segmental",
    "Semicircular",
    "Stilted",
    "Surface",
    "Trough",
    "Umbrella",
    "Vault",
    "family",
    "ideal",
    "profile",
    "register",
]
