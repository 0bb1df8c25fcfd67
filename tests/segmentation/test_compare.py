"""Comparison: figures by hand, and under any renaming of the labels."""

import csv
import io
import json

import numpy as np
import pytest

from segmentation import compare

TRUTH = np.array([1] * 6 + [2] * 3 + [0])


def test_a_segmentation_equals_itself_under_other_names():
    result = compare(np.array([0, 7, 3])[TRUTH], TRUTH)
    assert [(m.truth, m.found, m.iou, m.precision, m.recall, m.count_ratio) for m in result.matches] == [
        (1, 7, 1.0, 1.0, 1.0, 1.0),
        (2, 3, 1.0, 1.0, 1.0, 1.0),
    ]
    assert result.mean_iou == 1.0
    assert result.unmatched == ()


def test_figures_of_a_worked_example():
    match = compare([5, 5, 5, 5, 0, 9, 9, 9, 9, 9], TRUTH).matches
    assert (match[0].iou, match[0].precision, match[0].recall) == pytest.approx((4 / 6, 1.0, 4 / 6))
    assert (match[1].iou, match[1].precision, match[1].recall) == pytest.approx((3 / 5, 3 / 5, 1.0))
    assert match[1].count_ratio == pytest.approx(5 / 3)


def test_the_match_is_the_best_altogether_not_first_come():
    truth = np.repeat([1, 2], [10, 9])
    found = np.repeat([4, 4, 5], [6, 9, 4])  # 4 overlaps both, 5 only a tail of 2
    assert [m.found for m in compare(found, truth).matches] == [4, 5]


def test_missing_and_surplus_components_are_named():
    result = compare([1, 1, 1, 3, 3, 3, 0, 0, 0, 0], TRUTH)
    assert result.matches[1].found == 0
    assert result.matches[1].iou == result.matches[1].recall == 0.0
    assert result.unmatched == (3,)
    assert result.mean_iou == pytest.approx(0.25)


def test_nothing_compares_with_nothing():
    result = compare(np.zeros(0, dtype=np.uint16), np.zeros(0, dtype=np.uint16))
    assert result.matches == ()
    assert np.isnan(result.mean_iou)
    assert json.loads(result.json())["mean_iou"] is None


@pytest.mark.parametrize(
    ("labels", "complaint"),
    [
        ([1, 2], "labels has 2 points, truth has 10"),
        (np.ones(10), "whole numbers"),
        (-np.ones(10, dtype=int), "whole numbers"),
    ],
)
def test_what_is_not_labels_is_refused(labels, complaint):
    with pytest.raises(ValueError, match=complaint):
        compare(labels, TRUTH)


def test_table_json_and_csv_say_the_same():
    result = compare([1, 1, 1, 1, 1, 1, 2, 2, 0, 0], TRUTH)
    rows = list(csv.DictReader(io.StringIO(result.csv())))
    data = json.loads(result.json())
    assert (
        [float(row["iou"]) for row in rows] == [m["iou"] for m in data["components"]] == [m.iou for m in result.matches]
    )
    assert "mean IoU 0.8333" in result.table()
