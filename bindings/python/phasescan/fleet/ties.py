"""Stage 2, second half: which logs share a place. A tie is three matches, from views half a metre apart, that agree.

A match of two views of one place is a witness of where one log's map lies on the other's. Witnesses from one stop are one. What they
agree on is then held against views that must see the same, matched with no guess as well; there a match counts that says the same,
even where people or furniture have moved. Where most say something else, it was a place that only looks alike.
"""
from __future__ import annotations

import dataclasses
import math
from typing import Any, Sequence

import numpy as np
import numpy.typing as npt

from .._core import Pose2, _places

Floats = npt.NDArray[np.float64]

APART_M = 0.5           # views nearer than this are of one stop
WITNESSES = 3           # that a tie needs
AGREE_M, AGREE_DEG = 0.3, 4.0    # of two witnesses: matches and both maps between their views are off by less
OVERLAP_M = 1.0         # views so near to each other, by a hypothesis, must see the same
CHECKED = 10            # pairs of views that a hypothesis is held against
LEAST_SHARE = 0.6       # of them that must agree
HYPOTHESES = 3          # of a pair of logs


@dataclasses.dataclass(frozen=True)
class Tie:
    """Where the map of log `b` lies on that of log `a` (a < b), and what says so."""

    a: int
    b: int
    T_a_b: tuple[float, float, float]
    witnesses: int
    checked: int


def agree(one: Pose2, other: Pose2) -> bool:
    """Whether two poses are near enough to be of one place."""
    off = one.inverse() * other
    return math.hypot(off.x, off.y) <= AGREE_M and abs(off.theta) <= math.radians(AGREE_DEG)


def witnesses_of(own: dict[str, Any], others: dict[int, dict[str, Any]], alike: npt.NDArray[np.int64]) -> list[tuple[int, int, int]]:
    """Matches views that look alike; those of one place as (own view, other log, its view)."""
    if len(alike) == 0:
        return []
    a = own["ranges"][alike[:, 0]]
    b = np.stack([others[int(other)]["ranges"][int(view)] for _, other, view in alike])
    same, _, _ = _places.match_views(a, b)
    return [(int(i), int(other), int(j)) for (i, other, j), is_same in zip(alike, same) if is_same]


def tie_of(a: int, b: int, views_a: dict[str, Any], views_b: dict[str, Any], pairs: Sequence[tuple[int, int]]) -> Tie | None:
    """The tie of two logs, from pairs of views that match; None where too few agree."""
    best: Tie | None = None
    for T_a_b in _hypotheses(views_a, views_b, pairs):
        checked = _pairs_to_check(views_a["poses"], views_b["poses"], T_a_b)
        if len(checked) < WITNESSES:
            continue
        _, usable, poses = _places.match_views(views_a["ranges"][checked[:, 0]], views_b["ranges"][checked[:, 1]])
        # Two maps may each be bent a little: each witness is held against what the others say of its own place.
        told = [_map_pose(views_a["poses"][i], pose, views_b["poses"][j]) for (i, j), pose in zip(checked, poses)]
        good = [k for k in range(len(checked)) if usable[k] and agree(_seen(views_a, views_b, checked[k], T_a_b), Pose2(*poses[k]))]
        if len(good) >= WITNESSES and len(good) >= LEAST_SHARE * len(checked) and (best is None or len(good) > best.witnesses):
            middle = told[good[len(good) // 2]]
            best = Tie(a, b, (middle.x, middle.y, middle.theta), len(good), len(checked))
    return best


def _seen(views_a: dict[str, Any], views_b: dict[str, Any], pair: npt.NDArray[np.int64], T_a_b: Pose2) -> Pose2:
    """Where view j stands in the frame of view i, by a hypothesis."""
    return Pose2(*views_a["poses"][pair[0]]).inverse() * (T_a_b * Pose2(*views_b["poses"][pair[1]]))


def _map_pose(a: Floats, between: Floats, b: Floats) -> Pose2:
    """T_a_b of two maps, of a match between a view of each."""
    return Pose2(*a) * Pose2(*between) * Pose2(*b).inverse()


def _hypotheses(views_a: dict[str, Any], views_b: dict[str, Any], pairs: Sequence[tuple[int, int]]) -> list[Pose2]:
    """What the matches say of the two maps, what most agree on first."""
    pairs = sorted(set(pairs))
    _, _, poses = _places.match_views(views_a["ranges"][[i for i, _ in pairs]], views_b["ranges"][[j for _, j in pairs]])
    told = [_map_pose(views_a["poses"][i], pose, views_b["poses"][j]) for (i, j), pose in zip(pairs, poses)]
    left = list(range(len(told)))
    out: list[Pose2] = []
    while left and len(out) < HYPOTHESES:
        votes = [sum(agree(_at(told[k], views_b, pairs[k]), _at(told[m], views_b, pairs[k])) for m in left) for k in left]
        chosen = left[int(np.argmax(votes))]
        out.append(told[chosen])
        left = [k for k in left if not agree(_at(told[chosen], views_b, pairs[k]), _at(told[k], views_b, pairs[k]))]
    return out


def _at(T_a_b: Pose2, views_b: dict[str, Any], pair: tuple[int, int]) -> Pose2:
    """Where a hypothesis puts a view of b on a's map: what turns far away from it do not matter."""
    return T_a_b * Pose2(*views_b["poses"][pair[1]])


def _pairs_to_check(poses_a: Floats, poses_b: Floats, T_a_b: Pose2) -> npt.NDArray[np.int64]:
    """(n, 2) of views that stand at one place by a hypothesis, half a metre apart from each other, evenly along the way."""
    on_a = T_a_b.transform(poses_b[:, :2])
    distance = np.linalg.norm(poses_a[:, None, :2] - on_a[None], axis=2)
    kept: list[tuple[int, int]] = []
    for i in range(len(poses_a)):
        j = int(np.argmin(distance[i]))
        if distance[i, j] <= OVERLAP_M and all(np.linalg.norm(poses_a[i, :2] - poses_a[k, :2]) >= APART_M
                                              and np.linalg.norm(on_a[j] - on_a[m]) >= APART_M for k, m in kept):
            kept.append((i, j))
    if len(kept) > CHECKED:
        kept = [kept[round(k * (len(kept) - 1) / (CHECKED - 1))] for k in range(CHECKED)]
    return np.array(kept, np.int64).reshape(-1, 2)
