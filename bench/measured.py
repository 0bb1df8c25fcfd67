"""Figures into docs/measured.md: a section a benchmark, between two markers; what stands around them stays."""

from __future__ import annotations

from pathlib import Path

from bench.figures import Table
from bench.record import ROOT, Record
from bench.tables import lines
from tools.sections import replaced

PAGE = ROOT / "docs" / "measured.md"


def write(record: Record, page: Path = PAGE) -> None:
    """Put the tables of a run into their sections; a benchmark that has none yet gets one at the end."""
    told = page.read_text(encoding="utf-8")
    for name, tables in record.benchmarks.items():
        told = replaced(told, "bench", name, section(record, tables))
    page.write_text(told, encoding="utf-8")


def section(record: Record, tables: tuple[Table, ...]) -> str:
    """Date and machine, then the tables as blocks of text."""
    blocks = ["\n".join(f"    {line}" for line in lines(table)) for table in tables if not table.detail]
    return "\n\n".join([f"On {record.told}:", *blocks])
