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
           "international feet", "ift", "intl foot", "intl ft",
           "int ft", "int foot", "international ft"),
    "ftUS": ("ftus", "usft", "us ft", "ft us", "us survey foot", "us survey feet", "survey foot", "survey feet",
             "foot us", "feet us", "us foot", "us feet", "sft", "us survey ft",
             "survey ft", "us surveyfoot", "ussurveyfoot", "us surveyft", "foot us survey", "feet us survey"),
    "in": ("in", "inch", "inches", "zoll", "pollice", "pollici", "pouce", "pouces", "pulgada", "pulgadas"),
}  # fmt: skip
"""How files write them, without accents, brackets and dots."""
_BY_ALIAS = {alias: name for name, aliases in ALIASES.items() for alias in aliases}
UNIT_WORDS = {"unit", "units", "einheit", "einheiten", "unita", "unite", "unites", "unidad", "unidades"}
FILLERS = {"of", "length", "lengths", "is", "are", "in", "system", "linear", "the", "1", "coordinates"}
"""What may stand between such a word and the unit."""
OTHER_THINGS = {"intensity", "angle", "angular", "time", "temperature", "reflectance", "color", "colour"}
EXACT_UNIT = 1e-9
"""Relative difference of two factors that are one unit; the two feet differ by 2e-6."""


def unit_named(text: str) -> str | None:
    """The unit of UNITS that a text names ("Feet", "[mm]", "U.S. survey foot"); None if it names none."""
    return _BY_ALIAS.get(plain_words(text.replace(".", "")))


def unit_of(metres: float) -> str | None:
    """The unit of UNITS that is so many metres long; None if none is."""
    return next((name for name, size in UNITS.items() if abs(metres / size - 1) < EXACT_UNIT), None)


def unit_said(text: str) -> str | None:
    """The unit that a line like "units: mm", "# lengthUnit = feet" or "Einheit: Meter" states; None if it states none.

    Units of other things than lengths say nothing of these.
    """
    apart = re.sub(r"([a-z])([A-Z])", r"\1 \2", text.replace(".", ""))
    words = plain_words(apart).split()
    at = next((k for k, word in enumerate(words) if word in UNIT_WORDS), None)
    if at is None or OTHER_THINGS & set(words[:at]):
        return None
    rest = words[at + 1 :]
    while len(rest) > 1 and rest[0] in FILLERS:
        rest = rest[1:]
    said = (_BY_ALIAS.get(" ".join(rest[:k])) for k in (3, 2, 1))
    return next((unit for unit in said if unit), None)


def plain_words(text: str) -> str:
    """Lower-case words without accents and signs, one blank between: "Höhe [m]" -> "hohe m"."""
    flat = unicodedata.normalize("NFKD", text.casefold())
    return " ".join(re.findall(r"[a-z0-9]+", "".join(c for c in flat if not unicodedata.combining(c))))
