"""The families' colours, as all exporters know them."""

from families.declaration.palette import COMPONENTS, STONE, Colour, colour

__all__ = ["COMPONENTS", "STONE", "Colour", "colour"]
