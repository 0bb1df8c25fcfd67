"""Reading and writing point clouds.

formats.py: read(path), and the table of readers, one file per format beside it.
write.py: write_cloud(path, xyz, …), and the table of writers, one file per format beside it.
labelled.py: write_labelled(scan, path, cloud, extra), a scan once more with labels.
Inside: a reader yields chunks (chunk.py) and fills facts (facts.py); assemble.py makes the Cloud of them, by scale.py
(units), specks.py (points far from all others), precision.py and place.py (the origin), ranges.py (colours and
intensities). table.py reads columns of numbers, header.py understands their names, guess.py does without; records.py
finds columns in records, columns.py makes them, whole.py lets no half file stay.
"""

from segmentation.io.formats import READERS, read
from segmentation.io.labelled import write_labelled
from segmentation.io.write import WRITERS, write_cloud

__all__ = ["READERS", "WRITERS", "read", "write_cloud", "write_labelled"]
