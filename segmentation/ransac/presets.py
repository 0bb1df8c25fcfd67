"""The settings of the paper's Figure 2, for seven ideal vaults and the seven scans."""

from __future__ import annotations

import math

from segmentation.ransac.settings import Settings

_INF = math.inf
_S, _C, _CP, _SC = ("sphere",), ("cylinder",), ("plane", "cylinder"), ("sphere", "cylinder")

# name: support as a share, epsilon, beta, primitives, sphere radii, cylinder radii [m]
_ROWS: dict[str, tuple[float, float, float, tuple[str, ...], tuple[float, float], tuple[float, float]]] = {
    "sail-ideal": (0.020, 0.010, 0.060, _S, (0.0, 4.24), (0.0, _INF)),
    "barrel-ideal": (0.020, 0.010, 0.070, _C, (0.0, _INF), (0.0, 3.00)),
    "lunette-ideal": (0.005, 0.010, 0.100, _C, (0.0, _INF), (1.40, 3.00)),
    "trough-ideal": (0.004, 0.001, 0.100, _C, (0.0, _INF), (3.00, 3.00)),
    "mirror-ideal": (0.010, 0.010, 0.070, _CP, (0.0, _INF), (3.00, 3.00)),
    "groin-ideal": (0.005, 0.001, 0.060, _C, (0.0, _INF), (0.0, 3.00)),
    "dome-ideal": (0.020, 0.030, 0.100, _SC, (5.00, 7.08), (0.0, 5.00)),
    "sail-real": (0.020, 0.070, 0.060, _S, (0.0, 2.20), (0.0, _INF)),
    "barrel-real": (0.020, 0.040, 0.070, _C, (0.0, _INF), (0.0, 2.60)),
    "lunette-real": (0.005, 0.060, 0.100, _C, (0.0, _INF), (1.20, 1.50)),
    "trough-real": (0.004, 0.060, 0.100, _C, (0.0, _INF), (2.10, 2.75)),
    "mirror-real": (0.010, 0.010, 0.070, _CP, (0.0, _INF), (1.60, 2.10)),
    "groin-real": (0.005, 0.030, 0.060, _C, (0.0, _INF), (0.0, 2.60)),
    "dome-real": (0.020, 0.030, 0.100, _SC, (2.10, 3.00), (0.0, 2.10)),
}

PRESETS: dict[str, Settings] = {
    name: Settings(
        min_support=support,
        epsilon=epsilon,
        alpha=math.radians(25.0),
        beta=beta,
        overlooking_probability=0.010,
        sphere_r_min=sphere[0],
        sphere_r_max=sphere[1],
        cylinder_r_min=cylinder[0],
        cylinder_r_max=cylinder[1],
        primitives=primitives,
    )
    for name, (support, epsilon, beta, primitives, sphere, cylinder) in _ROWS.items()
}
"""By name: `groin-ideal` … `dome-real`."""
