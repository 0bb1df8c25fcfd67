"""Figures as text: the one place that turns tables into lines, for the terminal and for the documentation."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from bench.figures import Column, Figure, Table

NARROWEST = 7  # characters of a column of figures
NOTHING = "–"


def show(table: Table) -> Table:
    """Print a table row by row as they are measured; the table with all its rows."""
    rows = []
    print("\n" + "\n".join(head(table)), flush=True)
    for row in table.rows:
        rows.append(row)
        print(line(table.columns, row), flush=True)
    for note in table.notes:
        print(note)
    return replace(table, rows=tuple(rows))


def lines(table: Table) -> Iterator[str]:
    """All lines of a table."""
    yield from head(table)
    yield from (line(table.columns, row) for row in table.rows)
    yield from table.notes


def head(table: Table) -> Iterator[str]:
    """The title with the settings, and the names of the columns with their units."""
    settings = ", ".join(f"{name} {_plain(value)}" for name, value in table.settings.items())
    yield f"{table.title} ({settings})" if settings else table.title
    yield _joined(table.columns, [_name(column) for column in table.columns])


def line(columns: tuple[Column, ...], row: tuple[Figure, ...]) -> str:
    """One row."""
    return _joined(columns, [told(column, value) for column, value in zip(columns, row, strict=True)])


def told(column: Column, value: Figure) -> str:
    """A figure as its column says."""
    if value is None:
        return NOTHING
    if isinstance(value, str) or column.decimals is None:
        return str(value)
    return f"{value:.{column.decimals}%}" if column.unit == "%" else f"{value:,.{column.decimals}f}"


def _name(column: Column) -> str:
    return f"{column.name} [{column.unit}]" if column.unit not in ("", "%") else column.name


def _joined(columns: tuple[Column, ...], cells: list[str]) -> str:
    """Words to the left, figures to the right."""
    aligned = (
        f"{cell:{column.width}}" if column.decimals is None else f"{cell:>{max(NARROWEST, len(_name(column)))}}"
        for column, cell in zip(columns, cells, strict=True)
    )
    return "  ".join(aligned).rstrip()


def _plain(value: Figure) -> str:
    return f"{value:,}" if isinstance(value, int) else str(value)
