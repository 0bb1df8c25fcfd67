"""Reading point clouds.

read(path) in formats.py, one file per format beside it; chunk.py makes the Cloud, ranges.py unifies colours and
intensities, table.py reads columns of numbers.
"""

from segmentation.io.formats import READERS, read

__all__ = ["READERS", "read"]
