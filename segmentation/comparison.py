"""How well a segmentation agrees with a reference: per component, under the best one-to-one match."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class Match:
    """One reference component and the found one matched to it; `found` is 0, and its figures too, where there is none.

    count_ratio is found over reference points (the paper's Figure 8); iou, precision and recall count common points.
    """

    truth: int
    found: int
    truth_points: int
    found_points: int
    count_ratio: float
    iou: float
    precision: float
    recall: float


@dataclass(frozen=True)
class Comparison:
    """Matches in the order of the reference's labels, and the found components (labels) that match none."""

    matches: tuple[Match, ...]
    unmatched: tuple[int, ...]

    @property
    def mean_iou(self) -> float:
        """Mean over the reference's components, those not found counted as 0; NaN where the reference has none."""
        return float(np.mean([match.iou for match in self.matches])) if self.matches else float("nan")

    @property
    def least_iou(self) -> float:
        """The worst component's IoU; NaN where the reference has none."""
        return min((match.iou for match in self.matches), default=float("nan"))

    def table(self) -> str:
        """Plain text, a line for each component and one for the mean."""
        head = f"{'truth':>6} {'found':>6} {'points':>12} {'found points':>12} {'ratio':>8}"
        lines = [f"{head} {'IoU':>7} {'precision':>9} {'recall':>7}"]
        lines += [
            f"{m.truth:>6} {m.found or '-':>6} {m.truth_points:>12,} {m.found_points:>12,} {m.count_ratio:>8.2%}"
            f" {m.iou:>7.4f} {m.precision:>9.4f} {m.recall:>7.4f}"
            for m in self.matches
        ]
        lines.append(
            f"{len(self.matches)} components, {len(self.unmatched)} found without a match, mean IoU {self.mean_iou:.4f}"
        )
        return "\n".join(lines)

    def json(self) -> str:
        """JSON object: mean_iou (null for no components), components, unmatched."""
        mean = self.mean_iou if self.matches else None
        return json.dumps(
            {"mean_iou": mean, "components": [asdict(m) for m in self.matches], "unmatched": list(self.unmatched)}
        )

    def csv(self) -> str:
        """Comma-separated values, the field names of `Match` in the first line."""
        out = io.StringIO()
        writer = csv.DictWriter(out, fieldnames=list(Match.__dataclass_fields__), lineterminator="\n")
        writer.writeheader()
        writer.writerows(asdict(match) for match in self.matches)
        return out.getvalue()


def compare(labels: ArrayLike, truth: ArrayLike) -> Comparison:
    """Compare labels (n,) with a reference (n,), whole numbers with 0 for none; the match has the largest sum of IoU.

    Raises:
        ValueError: the two differ in length, or hold something other than whole numbers from 0.

    >>> judged = compare([7, 7, 7, 2, 2, 0], [1, 1, 1, 1, 2, 2])
    >>> [(match.truth, match.found, round(match.iou, 3)) for match in judged.matches]
    [(1, 7, 0.75), (2, 2, 0.333)]
    """
    found_label, found = _numbered(labels, "labels")
    truth_label, reference = _numbered(truth, "truth")
    if len(found) != len(reference):
        raise ValueError(f"labels has {len(found)} points, truth has {len(reference)}: both must label the same cloud")
    from scipy.optimize import linear_sum_assignment

    width = len(found_label)
    table = np.bincount(reference * width + found, minlength=len(truth_label) * width).reshape(-1, width)
    truth_points, found_points = table.sum(axis=1), table.sum(axis=0)
    union = truth_points[:, None] + found_points - table
    iou = table / np.maximum(union, 1)
    rows, columns = (index + 1 for index in linear_sum_assignment(-iou[1:, 1:]))
    partner = {int(r): int(c) for r, c in zip(rows, columns, strict=True) if table[r, c] > 0}
    matches = []
    for row in range(1, len(truth_label)):
        column = partner.get(row, 0)
        common, own, theirs = (
            (int(v) for v in (table[row, column], truth_points[row], found_points[column]))
            if column
            else (0, int(truth_points[row]), 0)
        )
        matches.append(
            Match(
                truth=int(truth_label[row]),
                found=int(found_label[column]),
                truth_points=own,
                found_points=theirs,
                count_ratio=theirs / own,
                iou=float(iou[row, column]) if column else 0.0,
                precision=common / theirs if theirs else 0.0,
                recall=common / own,
            )
        )
    used = set(partner.values())
    return Comparison(tuple(matches), tuple(int(found_label[c]) for c in range(1, width) if c not in used))


def _numbered(labels: ArrayLike, name: str) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The labels that occur, 0 before all, and the place of each point's label among them."""
    values = np.asarray(labels)
    if values.ndim != 1 or not np.issubdtype(values.dtype, np.integer) or (values.size and values.min() < 0):
        raise ValueError(f"{name} of shape {values.shape} and type {values.dtype}: expected whole numbers from 0, (n,)")
    used = np.flatnonzero(np.bincount(values)) if values.size else np.empty(0, dtype=np.int64)
    used = np.union1d(used, [0])
    return used, np.searchsorted(used, values)
