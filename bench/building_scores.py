"""What a fit made of a labelled scan of a building, against its truth: one figure a question."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import pi, radians
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from vaultcad.model import FittedVault
from vaultcad.pipeline import Result
from vaultcad.scanner import vault_of
from vaultcad.scanner.building.labels import Kind
from vaultcad.scanner.turned import quarters, turned

Numbers = NDArray[np.int64]
Array = NDArray[np.float64]

FOUND, INVENTED = 0.6, 0.3  # IoU from which a vault is found, and below which a found one is none
PLAN = ("span", "length")  # how names of lengths in plan begin
LEAST = 500  # points of a vault that a scan has seen


@dataclass(frozen=True)
class Score:
    """What became of one building. seconds by the clock, memory [bytes] at its peak; refusal: why nothing was found.

    said: stated confidence of every found vault, and whether it is right. sizes: largest error [m] of a length of each
    bay that is one of several equal ones. plans: that of those in plan, which no settlement
    hides. arch_recall, arch_precision: of points; None where arches are not told.
    """

    name: str
    vaults: int
    found: int = 0
    invented: int = 0
    right: int = 0
    components: tuple[float, ...] = ()
    said: tuple[tuple[float, bool], ...] = ()
    sizes: tuple[float, ...] = ()
    plans: tuple[float, ...] = ()
    arch_recall: float | None = None
    arch_precision: float | None = None
    stray: float = 0.0
    families: Mapping[str, tuple[int, int]] = field(default_factory=dict)  # id -> right, true
    seconds: float = 0.0
    memory: float = 0.0
    refusal: str = ""


def seen(truth: Mapping[str, NDArray[Any]]) -> int:
    """How many vaults the scan shows."""
    return int((np.bincount(truth["vault"])[1:] >= LEAST).sum())


def score(truth: Mapping[str, NDArray[Any]], case: Mapping[str, Any], result: Result) -> dict[str, Any]:
    """The fields of a `Score` that the labels (n,) of the truth and of a fit say, point by point."""
    vault, component, kind = (truth[key].astype(np.int64) for key in ("vault", "component", "kind"))
    own, part = (getattr(result.labels, key).astype(np.int64) for key in ("vault", "component"))
    told, fitted = case["vaults"], result.model.vaults
    scored = ~np.isin(
        vault * 256 + component, [256 * k + c for k, v in enumerate(told, 1) for c in v.get("optional", [])]
    )
    merged = whole_barrels(np.where(scored, vault, 0), told, np.where(scored, own, 0))
    there = np.flatnonzero(np.bincount(merged, minlength=len(told) + 1)[1:] >= LEAST) + 1
    iou = overlaps(merged, np.where(scored, own, 0), len(told), len(fitted))
    pairs = {int(t) + 1: int(f) + 1 for t, f in zip(*linear_sum_assignment(-iou), strict=True)}
    found = {t: f for t, f in pairs.items() if t in there and iou[t - 1, f - 1] >= FOUND}
    right = {t: f for t, f in found.items() if is_right(told[t - 1], fitted[f - 1])}
    stone = (kind == Kind.PIER) | (kind == Kind.ARCH)
    off = list(errors(told, right, fitted))
    families = {family: [t for t in there.tolist() if told[t - 1]["family"] == family] for family in ids(told, there)}
    return {
        "vaults": len(there),
        "found": len(found),
        "invented": int((iou.max(axis=0, initial=0) < INVENTED).sum()),
        "right": len(right),
        "components": tuple(
            component_iou(np.where(merged == t, component, 0), np.where(own == f, part, 0)) for t, f in right.items()
        ),
        "said": tuple((one.confidence, f in right.values()) for f, one in enumerate(fitted, 1)),
        "sizes": tuple(max(one.values()) for one in off),
        "plans": tuple(max(plan) for one in off if (plan := [one[name] for name in one if name.startswith(PLAN)])),
        "stray": float((own[stone] > 0).mean()) if stone.any() else 0.0,
        "families": {family: (sum(t in right for t in group), len(group)) for family, group in families.items()},
        **arches(truth["arch"], getattr(result.labels, "arch", None)),
    }


def ids(told: Sequence[Mapping[str, Any]], there: NDArray[np.integer]) -> list[str]:
    """Those of the families that are there."""
    return sorted({told[t - 1]["family"] for t in there.tolist()})


def overlaps(true: Numbers, found: Numbers, trues: int, founds: int) -> Array:
    """IoU of the labels from 1 up, rows true, columns found."""
    size = founds + 1
    both = np.bincount(true * size + found, minlength=(trues + 1) * size).reshape(-1, size)
    either = both.sum(axis=1)[1:, None] + both.sum(axis=0)[None, 1:] - both[1:, 1:]
    shares: Array = both[1:, 1:] / np.maximum(either, 1)
    return shares


def component_iou(true: Numbers, found: Numbers) -> float:
    """Mean over the true components, 0 for those without a match."""
    iou = overlaps(true, found, int(true.max()), int(found.max(initial=0)))
    return float(iou[linear_sum_assignment(-iou)].sum() / len(np.unique(true[true > 0])))


def whole_barrels(vault: Numbers, told: Sequence[Mapping[str, Any]], found: Numbers) -> Numbers:
    """Pieces of one barrel between its arches under one number, where the found vaults agree better with that."""
    for group in {v["group"] for v in told if v.get("group")}:
        own = [k for k, v in enumerate(told, 1) if v.get("group") == group]
        mine = np.isin(vault, own)
        most = int(found.max(initial=0))
        apart = overlaps(np.where(mine, vault, 0), found, len(told), most)
        whole = overlaps(mine.astype(np.int64), found, 1, most)
        if whole.max(initial=0) > apart[linear_sum_assignment(-apart)].sum() / len(own):
            vault = np.where(mine, own[0], vault)
    return vault


def is_right(told: Mapping[str, Any], fitted: FittedVault) -> bool:
    """Whether the family is the true one, or another that is as true."""
    return fitted.vault.id in (told["family"], *told.get("also", ()))


def errors(
    told: Sequence[Mapping[str, Any]], right: Mapping[int, int], fitted: Sequence[FittedVault]
) -> Iterator[dict[str, float]]:
    """The errors [m] of all lengths by name, of each bay that has equals and is no piece of a longer barrel."""
    parameters = [None if v.get("group") else v.get("parameters") for v in told]
    for t, f in right.items():
        if parameters[t - 1] is None or parameters.count(parameters[t - 1]) < 2:
            continue
        true, one = vault_of(dict(told[t - 1])), fitted[f - 1]
        same = turned(true, quarters(one.pose.yaw, radians(told[t - 1]["yaw_deg"]) % (2 * pi)))
        lengths = {name for name, value in one.parameters.items() if value.unit == "m"}
        if same is not None and (common := lengths & same[0].keys()):
            yield {name: abs(one.parameters[name].value - same[0][name]) for name in sorted(common)}


def arches(true: NDArray[Any], found: NDArray[Any] | None) -> dict[str, float]:
    """Recall and precision of their points, where a fit tells them."""
    if found is None:
        return {}
    both, trues, founds = (int(np.count_nonzero(one)) for one in ((true > 0) & (found > 0), true, found))
    return {"arch_recall": both / max(1, trues), "arch_precision": both / max(1, founds)}
