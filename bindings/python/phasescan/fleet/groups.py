"""Which logs belong together: what ties hang together, and which ties contradict the others."""
from __future__ import annotations

import dataclasses
import math
from typing import Sequence

from .._core import Pose2
from .ties import Tie

CONTRADICTS_M, CONTRADICTS_DEG = 1.0, 10.0  # by which a tie is off from what the others say


@dataclasses.dataclass
class Grouping:
    """Logs by group, each group and all of them in the manifest's order, and ties that were not believed."""

    groups: list[list[int]]
    contradicted: list[Tie]


def group_logs(count: int, ties: Sequence[Tie]) -> Grouping:
    """Groups of logs 0 .. count - 1. The best witnessed ties come first; one that contradicts those is left out."""
    root = list(range(count))
    T_root: list[Pose2] = [Pose2() for _ in range(count)]
    contradicted = []
    for tie in sorted(ties, key=lambda t: (-t.witnesses, -t.witnesses / t.checked, t.a, t.b)):
        T_a_b = Pose2(*tie.T_a_b)
        if root[tie.a] == root[tie.b]:
            off = (T_root[tie.a].inverse() * T_root[tie.b]).inverse() * T_a_b
            if math.hypot(off.x, off.y) > CONTRADICTS_M or abs(off.theta) > math.radians(CONTRADICTS_DEG):
                contradicted.append(tie)
            continue
        moved, T_new = root[tie.b], T_root[tie.a] * T_a_b * T_root[tie.b].inverse()
        for k in range(count):
            if root[k] == moved:
                T_root[k] = T_new * T_root[k]
                root[k] = root[tie.a]
    members: dict[int, list[int]] = {}
    for k in range(count):
        members.setdefault(root[k], []).append(k)
    return Grouping(sorted(members.values()), contradicted)
