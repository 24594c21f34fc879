"""Simulated logs of a fleet, and what came out against their truth.

Two logs of a world belong together where the true ways pass within 2 m of each other; logs of one world hang together through others.
Precision: share of the pairs in one group that are of one world. Recall: share of the logs with such a neighbour that are in a group
with one of their world. Joint maps: ATE of each group's trajectory over all its logs in one frame, against the world's.
"""
import hashlib
import itertools
import json
import pathlib
import sys

import numpy as np

import phasescan

SEED, SCANS_S, NEAR_M, GOOD_M = 5000, 55.0, 2.0, 0.08


def make_logs(folder, kinds, each):
    folder.mkdir(parents=True, exist_ok=True)
    for world, kind in enumerate(kinds):
        for k in range(each):
            path = folder / f"{world:03d}-{k}.jsonl"
            if not path.exists():
                phasescan.simulate(f"{kind}:{SEED + world}", seed=1000 * world + k + 7, duration_s=SCANS_S).save(path)
    return sorted(folder.glob("*.jsonl"))


def world_of(name):
    return int(pathlib.PurePath(name).name[:3])


def truth_of(path):
    return np.loadtxt(f"{path}.truth.tum")


def near_pairs(paths):
    """Pairs of names of one world whose true ways pass within 2 m of each other."""
    pairs = set()
    for _, of_world in itertools.groupby(paths, lambda p: world_of(p.name)):
        ways = [(p.name, truth_of(p)[::5, 1:3]) for p in of_world]
        for (a, way_a), (b, way_b) in itertools.combinations(ways, 2):
            if np.linalg.norm(way_a[:, None] - way_b[None], axis=2).min() <= NEAR_M:
                pairs.add((a, b))
    return pairs


def groups_of(out):
    """What groups.json says: groups with more than one log, as [names]."""
    groups = json.loads((out / "groups.json").read_text())
    return [(sorted(pathlib.PurePath(name).name for name in group["logs"]), group["map"]) for group in groups]


def share(part, whole, digits):
    return f"{part} of {whole} ({100 * part / max(whole, 1):.{digits}f} %)"


def group_lines(paths, groups):
    together = [pair for names, _ in groups for pair in itertools.combinations(names, 2)]
    right = {pair for pair in together if world_of(pair[0]) == world_of(pair[1])}
    near = near_pairs(paths)
    asked = {name for pair in near for name in pair}
    tied = {name for pair in right for name in pair}
    yield f"| pairs in one group that are of one world | {share(len(right), len(together), 2)} |"
    yield f"| logs that pass within {NEAR_M:g} m of another of their world: in a group with one of it | {share(len(asked & tied), len(asked), 1)} |"
    yield f"| pairs of logs that pass within {NEAR_M:g} m of each other: in one group | {share(len(near & right), len(near), 1)} |"
    alone = sorted(asked - tied)
    if alone:
        yield f"| alone, though they pass another | {', '.join(alone[:12])}{', ..' if len(alone) > 12 else ''} |"


def ate_of(estimate, truth):
    """Poses pair by their number: the times of drives overlap."""
    stamps = np.arange(len(truth), dtype=float)
    pose = lambda t: np.column_stack([t[:, 1], t[:, 2], 2 * np.arctan2(t[:, 6], t[:, 7])])
    return phasescan.evaluate((stamps, pose(estimate)), (stamps, pose(truth)))["ate_m"]["rmse"]


def joint_lines(folder, out, groups):
    errors = {}
    for _, joint in (group for group in groups if len(group[0]) > 1):
        place = out / pathlib.PurePath(joint).parent
        estimate = np.loadtxt(place / "trajectory.tum")
        summary = json.loads((place / "summary.json").read_text())
        truth = np.concatenate([truth_of(folder / entry["log"]) for entry in summary["inputs"]])
        if len(estimate) != len(truth):
            sys.exit(f"{joint}: {len(estimate)} poses of {len(truth)} scans")
        errors[str(pathlib.PurePath(joint).parent)] = ate_of(estimate, truth)
    if not errors:
        return
    found = np.array(list(errors.values()))
    worst = sorted(errors, key=errors.get)[-3:]
    yield f"| ATE of the {len(errors)} joint maps: median, 90 %, worst | {np.median(found):.3f}, {np.quantile(found, 0.9):.3f}, {found.max():.3f} m |"
    yield (f"| joint maps above {GOOD_M:g} m | {int((found > GOOD_M).sum())}"
           + (f" (worst: {', '.join(f'{name} {errors[name]:.3f} m' for name in reversed(worst))})" if found.max() > GOOD_M else "") + " |")


def results_digest(out):
    """Of all result files but those with times."""
    total = hashlib.sha256()
    for path in sorted(out.rglob("*")):
        if path.is_file() and path.name != "cost.json":
            total.update(str(path.relative_to(out)).encode() + b"\0" + path.read_bytes())
    return total.hexdigest()[:16]
