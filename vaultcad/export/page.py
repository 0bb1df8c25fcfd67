"""Parts of pages: tables, drawings, numbers as people read them."""

from __future__ import annotations

from collections.abc import Container, Iterable
from html import escape

from families.drawing.sheet import Drawing
from families.drawing.svg import svg
from vaultcad.uncertain import Estimate

Row = Iterable[str]


def html_table(head: Row, rows: Iterable[Row], numbers: slice, long: Container[int] = ()) -> str:
    """A table of cells that are HTML already; the columns `numbers` stand to the right.

    Each cell knows the title of its column: on a narrow screen rows are laid out as blocks, where those of `long`
    columns take a whole line.
    """
    titles = [escape(title) for title in head]
    right = range(len(titles))[numbers]
    classes = ["n" if k in right else "long" if k in long else "" for k in range(len(titles))]
    columns = list(zip(classes, titles, strict=True))

    def row(cells: Row) -> str:
        told = zip(columns, cells, strict=True)
        return "".join(f'<td class="{name}" data-title="{title}">{text}</td>' for (name, title), text in told)

    top = "".join(f'<th class="{name}">{title}</th>' for name, title in columns)
    body = "".join(f"<tr>{row(cells)}</tr>" for cells in rows)
    return f'<div class="wide"><table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table></div>'


def drawn(drawings: Iterable[Drawing]) -> str:
    """Drawings side by side, each over its title."""
    figures = "".join(
        f'<figure style="flex-grow:{drawing.size[0]:.2f}">{svg(drawing)}'
        f"<figcaption>{escape(drawing.title)}</figcaption></figure>"
        for drawing in drawings
    )
    return f'<div class="drawings">{figures}</div>'


def value_of(e: Estimate) -> str:
    """A number with its unit."""
    unit = "°" if e.unit == "deg" else f" {e.unit}" if e.unit != "1" else ""
    return f"{e.value:.{0 if e.value == int(e.value) and not unit else 3}f}{escape(unit)}"


def std_of(e: Estimate) -> str:
    """Its standard deviation, lengths in millimetres."""
    match e.std, e.unit:
        case None, _:
            return "–"
        case float(std), "m":
            return f"{1000 * std:.1f} mm"
        case std, "deg":
            return f"{std:.3f}°"
        case std, _:
            return f"{std:.4f}"


def percent(value: float) -> str:
    """A share."""
    return f"{100 * value:.1f} %"


def metres(value: float | None) -> str:
    """A length, or a dash."""
    return "–" if value is None else f"{value:.2f} m"
