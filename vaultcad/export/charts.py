"""Charts of the report as SVG."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from families.drawing.deviation_colours import shade, signed_mm

WIDTH, HEIGHT, FOOT = 640.0, 150.0, 22.0
EDGE = 30.0  # half of the widest label, "−120 mm"
BINS = 60


def histogram(values: NDArray[np.float64], limit: float) -> str:
    """Histogram of signed distances (n,) [m], as wide as 99 % of them need, in whole centimetres.

    Bars have the colours of their deviations, on a scale that ends at `limit` [m].
    """
    reach = max(0.01, float(np.ceil(100 * np.quantile(np.abs(values), 0.99))) / 100)
    counts, edges = np.histogram(values, BINS, (-reach, reach))
    tall = (HEIGHT - FOOT) / max(1, int(counts.max()))
    wide = WIDTH / BINS
    bars = "".join(
        f'<rect x="{k * wide + 0.5:.1f}" y="{HEIGHT - FOOT - count * tall:.1f}" width="{wide - 1:.1f}" '
        f'height="{count * tall:.1f}" fill="{shade((low + high) / 2, limit).hex}"><title>'
        f"{1000 * low:.1f} to {1000 * high:.1f} mm: {count}</title></rect>"
        for k, (count, low, high) in enumerate(zip(counts.tolist(), edges, edges[1:], strict=False))
        if count
    )
    ticks = np.linspace(-reach, reach, 5)
    places = np.clip((ticks + reach) / (2 * reach) * WIDTH, EDGE, WIDTH - EDGE)
    labels = "".join(
        f'<text x="{x:.1f}" y="{HEIGHT - 5:.0f}">{signed_mm(t)}</text>' for x, t in zip(places, ticks, strict=True)
    )
    base, middle = HEIGHT - FOOT, WIDTH / 2
    axis = f'<path d="M0 {base}H{WIDTH:.0f}M{middle:.0f} 0V{base}"/>'
    return f'<svg class="chart" viewBox="0 0 {WIDTH:.0f} {HEIGHT:.0f}" role="img">{bars}{axis}{labels}</svg>'
