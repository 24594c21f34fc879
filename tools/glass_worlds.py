"""Simulated flats with glass walls, windows, black panels and open doors, and how many of them `phasescan slam` finds.

Each seed is another flat of two rooms: a partition with an open door, a glass wall and a black panel; in the outer walls a window and an
open door to the outside, behind which there is nothing (a look-alike of glass). Kind `plain` is the same flat with matt walls in place
of glass and black. scripts/slam_results runs it (part `glass`).
"""
import json
import math
import random

import tum


def make_world(seed, kind):
    """(YAML text, [(kind, from, to)] of the hidden surfaces, [(from, to)] of the open doors)"""
    r = random.Random(seed)
    w, h, second = r.uniform(4.5, 6.5), r.uniform(5.5, 8.0), r.uniform(3.5, 5.5)
    hidden, doors, walls = [], [], []

    def wall(a, b, material="matt"):
        if math.dist(a, b) > 1e-6:
            walls.append((a, b, material if kind != "plain" else "matt"))

    def pieces(a, b, parts):
        """A wall from a to b; parts: (from, to, what) in metres along it."""
        length = math.dist(a, b)
        at = lambda s: (a[0] + (b[0] - a[0]) * s / length, a[1] + (b[1] - a[1]) * s / length)
        done = 0.0
        for start, end, what in parts:
            wall(at(done), at(start))
            if what == "door":
                doors.append((at(start), at(end)))
            else:
                wall(at(start), at(end), what)
                if kind != "plain":
                    hidden.append((what, at(start), at(end)))
            done = end
        wall(at(done), b)

    glass, black, door = r.uniform(1.2, 2.2), r.uniform(0.6, 1.2), 0.9
    gap = (h - glass - black - door - 0.3) / 3
    spans, s = [], 0.15
    for size, what in r.sample([(glass, "glass"), (black, "black"), (door, "door")], 3):
        s += gap * r.uniform(0.4, 1.0)
        spans.append((s, s + size, what))
        s += size
    pieces((w, 0), (w, h), spans)
    window, start = r.uniform(1.0, 1.8), r.uniform(0.5, 1.5)
    pieces((0, 0), (w, 0), [(start, start + window, "glass")])
    start = r.uniform(0.6, h - 1.8)
    pieces((0, h), (0, 0), [(start, start + 0.9, "door")])
    wall((w, h), (0, h))
    wall((w, 0), (w + second, 0))
    wall((w + second, 0), (w + second, h))
    wall((w + second, h), (w, h))
    boxes = []
    for x0, x1 in ((0, w), (w, w + second)):
        for _ in range(3):
            bw, bd, x = r.uniform(0.4, 1.2), r.uniform(0.3, 0.5), 0
            x = r.uniform(x0 + 0.7, x1 - 0.7 - bw)
            boxes.append([(x, h - bd), (x + bw, h - bd), (x + bw, h - 0.01), (x, h - 0.01)])
        cx, cy = r.uniform(x0 + 1.6, x1 - 1.6), r.uniform(0.35 * h, 0.65 * h)
        boxes += [[(cx + dx, cy + dy), (cx + dx + 0.05, cy + dy), (cx + dx + 0.05, cy + dy + 0.05), (cx + dx, cy + dy + 0.05)]
                  for dx in (-0.3, 0.3) for dy in (-0.3, 0.3)]
    show = lambda points: "[" + ", ".join(f"[{x:.4f}, {y:.4f}]" for x, y in points) + "]"
    text = "walls:\n" + "".join(f"  - {{points: {show([a, b])}, material: {m}}}\n" for a, b, m in walls)
    text += "".join(f"  - {{points: {show(box)}, closed: true}}\n" for box in boxes)
    text += "rooms:\n" + "".join(f"  - {show([(x0, 0), (x1, 0), (x1, h), (x0, h)])}\n" for x0, x1 in ((0, w), (w, w + second)))
    text += "doors:\n" + "".join(f"  - {show(d)}\n" for d in doors if abs(d[0][0] - w) < 1e-6)
    return text, hidden, doors


def poses(path):
    return [pose for _, pose in tum.read_tum(path)]


def alignment(estimate, truth):
    """The rigid motion (angle, x, y) that takes the estimate's positions to the truth's best."""
    n = len(estimate)
    ex, ey = sum(p[0] for p in estimate) / n, sum(p[1] for p in estimate) / n
    tx, ty = sum(p[0] for p in truth) / n, sum(p[1] for p in truth) / n
    dot = sum((e[0] - ex) * (t[0] - tx) + (e[1] - ey) * (t[1] - ty) for e, t in zip(estimate, truth))
    cross = sum((e[0] - ex) * (t[1] - ty) - (e[1] - ey) * (t[0] - tx) for e, t in zip(estimate, truth))
    angle = math.atan2(cross, dot)
    c, s = math.cos(angle), math.sin(angle)
    return angle, tx - c * ex + s * ey, ty - s * ex - c * ey


def distance(p, a, b):
    d = (b[0] - a[0], b[1] - a[1])
    t = max(0.0, min(1.0, ((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1]) / (d[0] ** 2 + d[1] ** 2)))
    return math.dist(p, (a[0] + t * d[0], a[1] + t * d[1]))


def samples(a, b, step=0.05):
    n = max(1, int(math.dist(a, b) / step))
    return [(a[0] + (b[0] - a[0]) * k / n, a[1] + (b[1] - a[1]) * k / n) for k in range(n + 1)]


def judge(folder, truth_file, hidden, doors):
    """Metres of truth found and not, of claims right and wrong, and of open doors claimed: surely and perhaps."""
    panes = json.loads((folder / "summary.json").read_text())["glass"]["panes"]
    angle, x, y = alignment(poses(folder / "trajectory.tum"), poses(truth_file))
    c, s = math.cos(angle), math.sin(angle)
    move = lambda p: (c * p[0] - s * p[1] + x, s * p[0] + c * p[1] + y)
    near = 0.15
    out = {}
    for name, sure_only in (("sure", True), ("all", False)):
        claims = [(move(p["from"]), move(p["to"])) for p in panes if p["sure"] or not sure_only]
        row = {"claimed_m": sum(math.dist(a, b) for a, b in claims), "right_m": 0.0, "door_m": 0.0}
        for a, b in claims:
            points = samples(a, b)
            each = math.dist(a, b) / len(points)
            row["right_m"] += each * sum(any(distance(p, h[1], h[2]) < near for h in hidden) for p in points)
            # What reaches over a jamb by less than the tolerance is a claim about the jamb.
            row["door_m"] += each * sum(any(distance(p, *d) < near and min(math.dist(p, d[0]), math.dist(p, d[1])) > near for d in doors)
                                        for p in points)
        for what in ("glass", "black"):
            row[f"{what}_m"] = row[f"{what}_found_m"] = 0.0
            for kind, a, b in hidden:
                if kind != what:
                    continue
                points = samples(a, b)
                row[f"{what}_m"] += math.dist(a, b)
                row[f"{what}_found_m"] += math.dist(a, b) / len(points) * sum(any(distance(p, *k) < near for k in claims) for p in points)
        out[name] = row
    return out
