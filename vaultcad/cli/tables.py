"""Tables on standard output."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


def show_table(
    head: Sequence[str], rows: Iterable[Sequence[str]], *, title: str = "", numbers: Sequence[int] = ()
) -> None:
    """A table of texts; the columns in `numbers` are set to the right. Long texts are wrapped, never cut.

    Where all heads are empty there is neither a head nor an empty line around the rows.
    """
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.table import Table

    headed = any(head)
    table = Table(
        title=title or None,
        title_justify="left",
        box=SIMPLE_HEAD if headed else None,
        show_header=headed,
        pad_edge=False,
        padding=(0, 1) if headed else (0, 2, 0, 0),
    )
    for k, name in enumerate(head):
        table.add_column(name, justify="right" if k in numbers else "left", overflow="fold")
    for row in rows:
        table.add_row(*row)
    Console(markup=False, highlight=False, emoji=False).print(table)
