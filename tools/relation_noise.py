"""How exact verified relations are: two answers that know nothing of each other, a match of the two scans alone and the trajectory of SLAM,
agree with each other better than with the relation. What the errors of both have in common is the relation's own. scripts/slam_results
runs it (part `relations`)."""
import collections
import gzip
import json
import math
import subprocess

import tum

CLASSES = ((0.0, 10.0), (10.0, 60.0), (60.0, 181.0))  # turn of the relation [deg]: from, up to
MISMATCH = 0.3  # [m] a match farther than this from the trajectory found another place: no judge of the relation


def compose(a, b):
    c, s = math.cos(a[2]), math.sin(a[2])
    return (a[0] + c * b[0] - s * b[1], a[1] + s * b[0] + c * b[1], math.remainder(a[2] + b[2], 2 * math.pi))


def inverse(a):
    c, s = math.cos(a[2]), math.sin(a[2])
    return (-c * a[0] - s * a[1], s * a[0] - c * a[1], -a[2])


def read_scans(log):
    """Scans of a CARMEN log by their time in milliseconds."""
    scans = {}
    with gzip.open(log, "rt") as lines:
        for line in lines:
            words = line.split()
            if words and words[0] == "FLASER":
                n = int(words[1])
                ranges = [r if r < 80.0 else 0.0 for r in map(float, words[2:2 + n])]
                beams = 180 if n <= 181 else 360
                scans[round(1000 * float(words[n + 8]))] = {"angle_min": -math.pi / 2, "angle_increment": math.pi / beams,
                                                            "range_min": 0.02, "range_max": 80.0, "ranges": ranges}
    return scans


def covariance(a, b):
    """Sum over x and y of the covariances of two lists of errors [m^2]."""
    total = 0.0
    for axis in (0, 1):
        ma, mb = (sum(e[axis] for e in errors) / len(errors) for errors in (a, b))
        total += sum((p[axis] - ma) * (q[axis] - mb) for p, q in zip(a, b)) / len(a)
    return total


def mean(errors):
    return sum(math.hypot(e[0], e[1]) for e in errors) / len(errors)


def judge(command, log, relations, trajectory, mount, folder):
    """A row per class of turn. `mount`: x of the laser in the frame of the trajectory [m]."""
    scans, poses = read_scans(log), {round(1000 * t): pose for t, pose in tum.read_tum(trajectory)}
    cases = []
    for line in open(relations):
        words = [float(w) for w in line.split()]
        a, b = (round(1000 * t) for t in words[:2])
        if a in scans and b in scans and a in poses and b in poses:
            cases.append((a, b, (words[2], words[3], words[7])))
    pairs = folder / "pairs.jsonl"
    with open(pairs, "w") as out:
        for k, (a, b, truth) in enumerate(cases):
            out.write(json.dumps({"id": str(k), "dataset": "relations", "class": "global", "reference": scans[a], "scan": scans[b],
                                  "truth": dict(zip(("x", "y", "theta"), truth))}) + "\n")
    done = subprocess.run([command, "match", "--pairs", pairs], stdout=subprocess.PIPE, text=True, check=True)
    pairs.unlink()
    at_laser = (mount, 0.0, 0.0)
    groups = collections.defaultdict(list)
    for (a, b, truth), answer in zip(cases, map(json.loads, done.stdout.splitlines())):
        matched = tuple(answer["pose"][k] for k in ("x", "y", "theta"))
        as_laser = compose(inverse(compose(poses[a], at_laser)), compose(poses[b], at_laser))
        apart = compose(inverse(as_laser), matched)
        if answer["usable"] and math.hypot(apart[0], apart[1]) < MISMATCH:
            groups[next(c for c in CLASSES if abs(math.degrees(truth[2])) < c[1])].append({
                "apart": apart,
                "match_laser": compose(inverse(truth), matched),
                "match_base": compose(inverse(truth), compose(compose(at_laser, matched), inverse(at_laser))),
                "slam_laser": compose(inverse(truth), as_laser),
                "slam_base": compose(inverse(truth), compose(inverse(poses[a]), poses[b]))})
    rows = []
    for c, errors in sorted(groups.items()):
        columns = {k: [e[k] for e in errors] for k in errors[0]}
        common = covariance(columns["slam_base"], columns["match_base"])
        own = covariance(columns["slam_base"], columns["slam_base"])
        rows.append({"turn_deg": c, "n": len(errors), "relations": sum(c[0] <= abs(math.degrees(t[2])) < c[1] for _, _, t in cases),
                     "mean_m": {k: mean(v) for k, v in columns.items()},
                     "exact_mean_m": mean(columns["slam_base"]) * math.sqrt(max(0.0, common) / own)})
    return rows
