"""Segmentation of point clouds: reading, thinning, normals, primitives. Arrays in, arrays out; knows no vault.

Names are imported when they are first used, so that importing the package costs nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from segmentation.cloud import Cloud as Cloud
    from segmentation.comparison import Comparison as Comparison
    from segmentation.comparison import compare as compare
    from segmentation.errors import ReadError as ReadError
    from segmentation.io import read as read
    from segmentation.io import write_cloud as write_cloud
    from segmentation.io import write_labelled as write_labelled
    from segmentation.ransac.detect import Segment as Segment
    from segmentation.ransac.detect import Segments as Segments
    from segmentation.ransac.detect import detect as detect
    from segmentation.ransac.presets import PRESETS as PRESETS
    from segmentation.ransac.settings import Settings as Settings

_EXPORTS = {
    "Cloud": "segmentation.cloud",
    "Comparison": "segmentation.comparison",
    "compare": "segmentation.comparison",
    "ReadError": "segmentation.errors",
    "read": "segmentation.io",
    "write_cloud": "segmentation.io",
    "write_labelled": "segmentation.io",
    "PRESETS": "segmentation.ransac.presets",
    "Segment": "segmentation.ransac.detect",
    "Segments": "segmentation.ransac.detect",
    "detect": "segmentation.ransac.detect",
    "Settings": "segmentation.ransac.settings",
}
__all__ = list(_EXPORTS)


def __getattr__(name: str) -> Any:
    if name not in _EXPORTS:
        raise AttributeError(f"module 'segmentation' has no attribute {name!r}")
    return getattr(import_module(_EXPORTS[name]), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *_EXPORTS])
