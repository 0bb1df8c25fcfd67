"""Units of length that scans come in."""

import re
import unicodedata
from collections.abc import Mapping

UNITS: Mapping[str, float] = {
    "m": 1.0,
    "cm": 0.01,
    "mm": 0.001,
    "ft": 0.3048,
    "ftUS": 1200 / 3937,
    "in": 0.0254,
}
"""Metres in each unit, by the names that `--unit` knows. The US survey foot is 1200/3937 m by law."""
NAMES: Mapping[str, str] = {
    "m": "metre", "cm": "centimetre", "mm": "millimetre", "ft": "foot", "ftUS": "US survey foot", "in": "inch",
}  # fmt: skip
"""What people call them."""
ALIASES: Mapping[str, tuple[str, ...]] = {
    "m": ("m", "mt", "mtr", "metre", "meter", "metres", "meters", "metri", "metro", "metros"),
    "cm": ("cm", "centimetre", "centimeter", "centimetres", "centimeters", "centimetri", "centimetro", "centimetros",
           "zentimeter"),
    "mm": ("mm", "millimetre", "millimeter", "millimetres", "millimeters", "millimetri", "millimetro", "milimetro",
           "milimetros"),
    "ft": ("ft", "foot", "feet", "fuss", "piede", "piedi", "pied", "pieds", "pie", "pies", "international foot",
           "international feet", "ift", "intl foot", "intl ft"),
    "ftUS": ("ftus", "usft", "us ft", "ft us", "us survey foot", "us survey feet", "survey foot", "survey feet",
             "foot us", "feet us", "us foot", "us feet", "sft"),
    "in": ("in", "inch", "inches", "zoll", "pollice", "pollici", "pouce", "pouces", "pulgada", "pulgadas"),
}  # fmt: skip
"""How files write them, without accents, brackets and dots."""
_BY_ALIAS = {alias: name for name, aliases in ALIASES.items() for alias in aliases}
EXACT = 1e-9
"""Relative difference of two factors that are one unit; the two feet differ by 2e-6."""


def unit_named(text: str) -> str | None:
    """The unit of UNITS that a text names ("Feet", "[mm]", "U.S. survey foot"); None if it names none."""
    return _BY_ALIAS.get(plain_words(text.replace(".", "")))


def unit_of(metres: float) -> str | None:
    """The unit of UNITS that is so many metres long; None if none is."""
    return next((name for name, size in UNITS.items() if abs(metres / size - 1) < EXACT), None)


def unit_said(text: str) -> str | None:
    """The unit that a line like "units: mm" or "# unit = feet" states; None if it states none."""
    found = re.search(r"\bunits?\b(?:\s+(?:of\s+length|is|are|in))*\s*[:=]?\s*[\"'\[(]?\s*([^\"'\])\n,;]+)", text, re.I)
    if not found:
        return None
    words = found[1].split()
    said = (unit_named(" ".join(words[:k])) for k in (3, 2, 1))
    return next((unit for unit in said if unit), None)


def plain_words(text: str) -> str:
    """Lower-case words without accents and signs, one blank between: "Höhe [m]" -> "hohe m"."""
    flat = unicodedata.normalize("NFKD", text.casefold())
    return " ".join(re.findall(r"[a-z0-9]+", "".join(c for c in flat if not unicodedata.combining(c))))
