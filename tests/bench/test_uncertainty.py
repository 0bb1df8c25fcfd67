"""The benchmark of stated deviations, small: settled vaults in rooms, through the whole pipeline."""

from __future__ import annotations

import numpy as np

from bench.uncertainty import FIRST, measure, within


def test_the_truth_of_scanned_rooms_mostly_lies_within_the_stated_deviations() -> None:
    quickest = (FIRST + 7, FIRST + 8, FIRST + 10)  # a sail, a barrel, a trough vault
    numbers, left_out = measure(quickest, points=30_000)
    assert sum(left_out.values()) <= 2
    assert {"pose", "parameter", "derived"} == {n.kind for n in numbers}
    assert within(numbers).mean() > 0.75
    assert np.median([n.std for n in numbers]) < 0.1
