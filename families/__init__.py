"""Ideal masonry vaults: parameters, numeric surfaces, B-Rep and sampling. Knows no scan."""

from families.barrel import Barrel
from families.catalogue import FAMILIES, family, ideal, profile
from families.dome import Dome
from families.groin import Groin
from families.lunette import Lunette
from families.mirror import Mirror
from families.parameters import Parameter, Range
from families.profiles import PROFILES, BasketHandle, Elliptical, Pointed, Profile, Segmental, Semicircular, Stilted
from families.sail import Sail
from families.trough import Trough
from families.vault import Surface, Vault

__all__ = [
    "FAMILIES",
    "PROFILES",
    "Barrel",
    "BasketHandle",
    "Dome",
    "Elliptical",
    "Groin",
    "Lunette",
    "Mirror",
    "Parameter",
    "Pointed",
    "Profile",
    "Range",
    "Sail",
    "Segmental",
    "Semicircular",
    "Stilted",
    "Surface",
    "Trough",
    "Vault",
    "family",
    "ideal",
    "profile",
]
