#!/usr/bin/python3
"""Whether the covariance of a match is honest on recorded logs, without any truth.

    tools/covariance_table.py [--bin phasescan] [--pairs 300] [LOG...]

Two kinds of pairs have a known answer. Standing still: two scans of one stop (the wheels, where there are any, did not move,
and neither did SLAM's pose) have the identity between them. Triangles: a to b, b to c and c to a, each 0.2 to 0.9 m apart,
multiply to the identity; errors that three matches share cancel, so less than 95 % within the bound is overconfidence for sure.
Prints, as Markdown, for each log and kind: how many, the share with e' C^-1 e below 7.81 (95 % of a chi-square of three), and
the deviations said and seen (root mean square of x, y [mm] and theta [mrad]). Answers that are not usable are left out and
counted. Without logs: those of $PHASESCAN_DATA or ../shared/data, carmen and lowcost. Same seed, same table.
"""
import argparse
import json
import math
import os
import pathlib
import random
import subprocess
import sys
import tempfile

import numpy as np

BOUND = 7.81
STILL_M, STILL_RAD, LEAST_STOP = 0.004, 0.0035, 6
NEAR_M, FAR_M, LONGEST_SPAN = 0.2, 0.9, 400


def as_matrix(p):
    c, s = math.cos(p[2]), math.sin(p[2])
    return np.array([[c, -s, p[0]], [s, c, p[1]], [0.0, 0.0, 1.0]])


def as_pose(m):
    return np.array([m[0, 2], m[1, 2], math.atan2(m[1, 0], m[0, 0])])


def turn_between(a, b):
    return abs(math.remainder(a - b, math.tau))


class Drive:
    """Scans of a log with the wheels' poses and SLAM's."""

    def __init__(self, command, log, folder):
        scan_log, out = folder / "log.jsonl", folder / "slam"
        subprocess.run([command, "convert", log, scan_log], capture_output=True, check=False)
        subprocess.run([command, "slam", log, "--out", out, "--no-times"], capture_output=True, check=False)
        self.scans, self.wheels, self.poses = [], [], []
        if not scan_log.exists() or not (out / "trajectory.tum").exists():
            return
        for line in scan_log.open(encoding="utf-8"):
            scan = json.loads(line)
            wheels = scan.pop("odometry", None)
            self.wheels.append((wheels["x"], wheels["y"], wheels["theta"]) if wheels else None)
            self.scans.append(scan)
        for line in (out / "trajectory.tum").open(encoding="utf-8"):
            if line.strip() and not line.startswith("#"):
                f = [float(word) for word in line.split()]
                self.poses.append((f[1], f[2], 2.0 * math.atan2(f[6], f[7])))
        self.size = min(len(self.scans), len(self.poses))

    def at_rest(self, i, k):
        a, b = self.poses[i], self.poses[k]
        if math.dist(a[:2], b[:2]) >= STILL_M or turn_between(a[2], b[2]) >= STILL_RAD:
            return False
        u, v = self.wheels[i], self.wheels[k]
        return not u or not v or max(abs(u[0] - v[0]), abs(u[1] - v[1]), abs(u[2] - v[2])) < 1e-6

    def stops(self):
        found, i = [], 0
        while i < self.size - LEAST_STOP:
            k = i + 1
            while k < self.size and self.at_rest(i, k):
                k += 1
            if k - i >= LEAST_STOP:
                found.append(range(i + 1, k - 1))
            i = k
        return found

    def standing(self, count, rng):
        stops = [stop for stop in self.stops() if len(stop) >= 2]
        pairs = []
        for _ in range(count if stops else 0):
            a, b = rng.sample(rng.choice(stops), 2)
            if self.scans[a]["ranges"] != self.scans[b]["ranges"]:
                pairs.append((a, b))
        return pairs

    def triangles(self, count, rng):
        found = []
        for _ in range(200 * count if self.size > 2 else 0):
            a = rng.randrange(self.size)
            b = a + rng.randrange(1, LONGEST_SPAN)
            c = b + rng.randrange(1, LONGEST_SPAN)
            if c >= self.size:
                continue
            sides = [math.dist(self.poses[p][:2], self.poses[q][:2]) for p, q in ((a, b), (b, c), (c, a))]
            if all(NEAR_M < side < FAR_M for side in sides):
                found.append((a, b, c))
                if len(found) == count:
                    break
        return found


def match_all(command, drive, pairs, folder):
    """The answers of `pairs` (indices of reference and scan), in order."""
    path = folder / "pairs.jsonl"
    with path.open("w", encoding="utf-8") as out:
        for i, (a, b) in enumerate(pairs):
            out.write(json.dumps({"id": str(i), "reference": drive.scans[a], "scan": drive.scans[b]}) + "\n")
    text = subprocess.run([command, "match", "--pairs", path], capture_output=True, text=True, check=True).stdout
    return [json.loads(line) for line in text.splitlines()]


def pose_of(answer):
    return np.array([answer["pose"][k] for k in ("x", "y", "theta")])


def covariance_of(answer):
    return np.array(answer["covariance"]).reshape(3, 3)


def closure(answers):
    """What three matches around a triangle leave, and its covariance to first order."""
    steps = [as_matrix(pose_of(answer)) for answer in answers]
    left = as_pose(steps[0] @ steps[1] @ steps[2])
    covariance = np.zeros((3, 3))
    for k, answer in enumerate(answers):
        jacobian = np.zeros((3, 3))
        for c in range(3):
            moved = pose_of(answer)
            moved[c] += 1e-5
            changed = list(steps)
            changed[k] = as_matrix(moved)
            jacobian[:, c] = (as_pose(changed[0] @ changed[1] @ changed[2]) - left) / 1e-5
        covariance += jacobian @ covariance_of(answer) @ jacobian.T
    return left, covariance


def row(name, kind, found, refused):
    if not found:
        print(f"| {name} | {kind} | 0 | {refused} | | | |")
        return
    errors = np.array([e for e, _ in found])
    within = np.mean([e @ np.linalg.solve(c, e) < BOUND for e, c in found])
    said = np.sqrt(np.mean([np.diag(c) for _, c in found], axis=0)) * 1000.0
    seen = np.sqrt(np.mean(errors**2, axis=0)) * 1000.0
    words = [" / ".join(f"{value:.1f}" for value in values) for values in (said, seen)]
    print(f"| {name} | {kind} | {len(found)} | {refused} | {100.0 * within:.1f} | {words[0]} | {words[1]} |", flush=True)


def table_of(command, log, count):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        drive = Drive(command, log, folder)
        if not drive.scans:
            return
        rng = random.Random(5)
        pairs, triangles = drive.standing(count, rng), drive.triangles(count, rng)
        sides = [side for a, b, c in triangles for side in ((a, b), (b, c), (c, a))]
        answers = match_all(command, drive, pairs + sides, folder)
        still = [(pose_of(a), covariance_of(a)) for a in answers[: len(pairs)] if a["usable"]]
        row(log.name, "standing", still, len(pairs) - len(still))
        rest = answers[len(pairs):]
        whole = [rest[k : k + 3] for k in range(0, len(rest), 3)]
        closed = [closure(three) for three in whole if all(a["usable"] for a in three)]
        row(log.name, "triangles", closed, len(whole) - len(closed))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    root = pathlib.Path(__file__).resolve().parent.parent
    parser.add_argument("--bin", default=str(root / "build/release/bin/phasescan"))
    parser.add_argument("--pairs", type=int, default=300)
    parser.add_argument("logs", nargs="*", type=pathlib.Path)
    options = parser.parse_args()
    logs = options.logs
    if not logs:
        data = pathlib.Path(os.environ.get("PHASESCAN_DATA", root.parent / "shared" / "data"))
        logs = sorted(p for kind in ("carmen", "lowcost") for p in (data / kind).glob("*.gz") if "corrected" not in p.name)
        if not logs:
            sys.exit(f"{data} holds no logs; expected them there or named")
    print("| log | pairs | usable | not usable | within 95 % [%] | said: x / y [mm] / theta [mrad] | seen |\n|---|---|---:|---:|---:|---:|---:|")
    for log in logs:
        table_of(options.bin, log, options.pairs)


if __name__ == "__main__":
    main()
