"""ISO 10303-21, the text format of STEP and IFC: how strings are written, and records put in order."""

from __future__ import annotations

import re

PLAIN = re.compile(
    r"[^ -:<-\[\]-~]+"
)  # what is not written as it is; ";" too, as some take the one in ENDSEC; for real
COLOURS = "MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION("  # of one vault, in STEP
RECORD = re.compile(r"#(\d+) = (.*?);\n", re.DOTALL)
REFERENCE = re.compile(r"#(\d+)")
LINE = re.compile(r"(.{60,72}?,)(?=.)")  # where a long record is broken


def encoded(text: str) -> str:
    r"""What stands between the quotes: ASCII, others as \X2\ and UTF-16 (6.4.3), quotes and backslashes doubled."""
    return PLAIN.sub(_escaped, text).replace("'", "''")


def _escaped(found: re.Match[str]) -> str:
    parts = (part for part in re.split(r"(\\+)", found[0]) if part)
    return "".join(2 * part if part[0] == "\\" else f"\\X2\\{_utf_16(part)}\\X0\\" for part in parts)


def _utf_16(text: str) -> str:
    return text.encode("utf-16-be", "replace").hex().upper()


def unbroken(record: str) -> str:
    """A record in one line."""
    return record.replace("\n  ", "").replace("\n", "")


def in_order(text: str) -> str:
    """A STEP file whose last records are the colours, which OpenCASCADE has in the order of addresses in memory.

    They follow one another as the vaults do, each followed by what it refers to, and are numbered anew.
    """
    first = next((found for found in RECORD.finditer(text) if found[2].startswith(COLOURS)), None)
    if first is None:
        return text
    last = list(RECORD.finditer(text, first.start()))
    records = {int(found[1]): unbroken(found[2]) for found in last}
    heads = [k for k, record in records.items() if record.startswith(COLOURS)]
    heads.sort(key=lambda k: _references(records[k])[-1])  # the context of the vault's shape, which comes before
    number: dict[int, int] = {}
    for k in (*heads, *records):
        _visit(k, records, number, first=int(first[1]))
    told = (
        f"#{number[k]} = " + REFERENCE.sub(lambda found: f"#{number.get(int(found[1]), int(found[1]))}", records[k])
        for k in number
    )
    return (
        text[: first.start()] + "".join(LINE.sub(r"\1\n  ", record) + ";\n" for record in told) + text[last[-1].end() :]
    )


def _visit(k: int, records: dict[int, str], number: dict[int, int], first: int) -> None:
    """Number a record and then, where they have no number yet, those that it refers to."""
    if k in number or k not in records:
        return
    number[k] = first + len(number)
    for other in _references(records[k]):
        _visit(other, records, number, first)


def _references(record: str) -> list[int]:
    return [int(found) for found in REFERENCE.findall(record)]
