"""What a reader learns of a file beside its points."""

import re
from collections import Counter
from dataclasses import dataclass, field

from segmentation.crs import Crs, of_code
from segmentation.notes import Note, count
from segmentation.units import UNITS, unit_said

ALIKE = 8
"""Notes of a kind that are told, as people read them."""


@dataclass
class Facts:
    """Filled while a file is read, complete once its last chunk is there.

    unit, height_unit: metres in a unit of the file's x and y, and of its z, as the file states them; None where it does
    not. stated_by: where it does ("its header"). format_unit: the unit that the format prescribes, for what states
    none. crs: the coordinate system that the file declares. notes: what was
    assumed or changed; others: how many more there were, by their code.
    """

    unit: float | None = None
    height_unit: float | None = None
    stated_by: str = ""
    format_unit: str | None = None
    crs: Crs | None = None
    notes: list[Note] = field(default_factory=list)
    others: Counter[str] = field(default_factory=Counter)

    def tell(self, code: str, text: str) -> None:
        """Note something, once; of a kind that comes again and again, as with each of a thousand scans, the first."""
        note = Note(code, " ".join(text.split()))
        if note in self.notes:
            return
        if sum(other.code == code for other in self.notes) < ALIKE:
            self.notes.append(note)
        else:
            self.others[code] += 1

    def told(self) -> tuple[Note, ...]:
        """All notes, and how many more of a kind there were."""
        return *self.notes, *(Note(code, f"and {count(n, 'other')} like these") for code, n in self.others.items())

    def declare(self, crs: Crs | None) -> None:
        """Take a coordinate system, and the units that it states."""
        if crs is None:
            return
        self.crs = crs
        if self.unit is None and (crs.unit is not None or crs.height_unit is not None):
            self.unit, self.height_unit = crs.unit, crs.height_unit
            self.stated_by = f"its coordinate system, {crs.title}"

    def listen(self, comment: str) -> None:
        """Take what a comment in a file's header says of its unit ("units: mm") or coordinate system ("EPSG:2056")."""
        code = re.search(r"\bEPSG\s*[:=]+\s*(\d{4,6})\b", comment, re.IGNORECASE)
        if code and self.crs is None:
            self.declare(of_code(int(code[1])))
        unit = unit_said(comment)
        if unit is not None:
            self.unit = self.height_unit = UNITS[unit]
            self.stated_by = "its header"
