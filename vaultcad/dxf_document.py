"""A DXF document in metres with layers by a table, written without clock or chance."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from datetime import datetime
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from segmentation.io.stamp import stamp

if TYPE_CHECKING:
    from ezdxf.document import Drawing

RELEASE = "R2010"
METRES = 6  # $INSUNITS
DASHED = (0.3, 0.2, -0.1)  # m: the pattern's length, a dash, a gap
DASH_DOT = (0.5, 0.3, -0.1, 0.0, -0.1)
FIXED = datetime(2000, 1, 1)  # what ezdxf writes when it is told to write no time


class Layer(NamedTuple):
    """A layer: colour of AutoCAD's index, line type, weight of its lines [1/100 mm]."""

    colour: int
    linetype: str
    weight: int


@contextmanager
def dxf_document(path: Path, place: str, dash: float = 1.0) -> Iterator[Drawing]:
    """A new document in metres, which is written to `path` at the end, the same bytes for the same content.

    place: in words, to what its coordinates are relative. dash: how much longer than usual dashes are.
    """
    import ezdxf
    from ezdxf.tools.juliandate import juliandate

    told = StringIO()
    with _without_clock():
        document = ezdxf.new(RELEASE, units=METRES)
        document.header["$MEASUREMENT"] = 1  # metric
        document.header.custom_vars.append("place", place)
        document.linetypes.add("DASHED", [dash * v for v in DASHED], description="dashed __ __ __")
        document.linetypes.add("DASHDOT", [dash * v for v in DASH_DOT], description="dash dot __ . __ . __")
        yield document
        for name in sorted(document.entitydb.dxf_types_in_use()):  # ezdxf adds them as a set has them
            document.classes.add_class(name)
        document.write(told)
    text = told.getvalue().replace(f"\n{juliandate(FIXED)}\n", f"\n{juliandate(stamp().replace(tzinfo=None))}\n")
    path.write_text(text, encoding="utf-8", newline="\n")


def add_layers(document: Drawing, layers: Mapping[str, Layer], suffix: str = "") -> None:
    """Enter the layers of a table, their names with a suffix."""
    for name, layer in layers.items():
        document.layers.add(name + suffix, color=layer.colour, linetype=layer.linetype, lineweight=layer.weight)


@contextmanager
def _without_clock() -> Iterator[None]:
    """Elsewhere ezdxf writes the time, and identities by chance."""
    import ezdxf

    kept = ezdxf.options.write_fixed_meta_data_for_testing
    ezdxf.options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        ezdxf.options.write_fixed_meta_data_for_testing = kept
