#!/usr/bin/python3
"""Fits the confidence of a pose on a map (src/localize/pose_confidence.cpp) on simulated scans, and says what it is worth.

    tools/localize_fit.py --places out/localize_fit        # makes maps and scans where they are not there, fits, prints the constants
    tools/localize_fit.py --places out/localize_fit --test # other worlds: how the constants in the program judge them

Worlds are of other seeds than those of scripts/localize_results. A quarter of the scans are from rooms that are wiped from the map; in half
of the groups furniture is moved and people stand about. The logistic function maximises the likelihood with a small ridge; a weight never
has the sign that would make a pose surer by what speaks against it.
"""
import argparse
import json
import math
import pathlib
import subprocess
import sys

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
SENSORS = ["rplidar-a1-real", "ld06-real", "ydlidar-x4-real", "rplidar-c1-real", "urg-04lx-real", "rplidar-a1"]
WORLDS = [["building:{0}"], ["flat:{0}", "flat:{1}", "flat:{2}", "flat:{3}"], ["office:{0}", "office:{1}", "office:{2}"],
          ["hall:{0}"], ["building:{0}", "flat:{1}"]]
# Number of a case, its transformation, the sign of its weight.
FEATURES = [
    ("margin / 10", lambda r: min(r["margin"], MOST_MARGIN) / 10, 1),
    ("odds of explained", lambda r: math.log((r["explained"] + ROUND) / (1 + ROUND - r["explained"])), 1),
    ("contradicting", lambda r: r["contradicting"], -1),
    ("sigma", lambda r: math.log(max(0.01, r["sigma_m"]) / 0.02), -1),
]
MOST_MARGIN, ROUND = 60.0, 0.02
RIDGE = 1.0
DEGRADED = 0.8  # kDegradedConfidence of src/localize/locate.cpp


def groups(first):
    """Worlds, sensor and flags of each group of scans."""
    out, seed = [], first
    for k, sensor in enumerate(SENSORS):
        for later in (False, True):
            words = WORLDS[(2 * k + later) % len(WORLDS)]
            worlds = [w.format(*range(seed, seed + 4)) for w in words]
            seed += 4
            flags = ["--unmapped", "0.25"] + (["--moved", "0.3", "--people", "3"] if later else [])
            out.append((f"{k}-{sensor}-{'later' if later else 'same'}", worlds, sensor, flags))
    return out


def cases(options, first):
    rows = []
    for name, worlds, sensor, flags in groups(first):
        folder = options.places / f"{first}-{name}"
        lines = options.places / f"{first}-{name}.jsonl"
        command = [options.phasescan, "bench", "localize", "--worlds", ",".join(worlds), "--sensor", sensor, "--poses", options.poses, "--seed", first,
                   "--places", folder, "--cases", lines, "--no-times", *flags, *(["--config", options.config] if options.config else [])]
        done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"{' '.join(map(str, command))}\n{done.stderr}")
        print(name, done.stdout.strip(), flush=True)
        for line in lines.read_text().splitlines():
            row = json.loads(line)
            row["group"] = name
            if row["status"] != "initialising" and row["sigma_m"] > 0:
                rows.append(row)
    return rows


def columns(rows):
    return np.array([[f(r) for _, f, _ in FEATURES] for r in rows])


def fit(x, right):
    """@return the constant and the weights, by Newton steps; weights of the wrong sign are left out and the rest fitted again"""
    kept = list(range(x.shape[1]))
    while True:
        a = np.hstack([np.ones((len(x), 1)), x[:, kept]])
        w = np.zeros(a.shape[1])
        ridge = np.full(a.shape[1], RIDGE)
        ridge[0] = 0.0
        for _ in range(60):
            p = 1.0 / (1.0 + np.exp(-(a @ w)))
            gradient = a.T @ (right - p) - ridge * w
            hessian = (a * (p * (1 - p))[:, None]).T @ a + np.diag(ridge) + 1e-9 * np.eye(len(w))
            w = w + np.linalg.solve(hessian, gradient)
        bad = [k for n, k in enumerate(kept) if w[n + 1] * FEATURES[k][2] < 0]
        if not bad:
            weights = np.zeros(x.shape[1])
            weights[kept] = w[1:]
            return w[0], weights
        kept = [k for k in kept if k not in bad]


def show(rows, p, gap):
    right = np.array([r["right"] for r in rows])
    mapped = np.array([r["mapped"] for r in rows])
    margin = np.array([r["margin"] for r in rows])
    alone = margin >= gap
    ok, degraded = (p > 0.95) & alone, (p > DEGRADED) & (p <= 0.95) & alone
    print(f"n {len(rows)}  on the map {mapped.sum()}, of them right {right[mapped].sum()}")
    print(f"on the map: ok {ok[mapped].sum()}, wrong and ok {(ok & ~right)[mapped].sum()}, degraded {degraded[mapped].sum()}, of them wrong {(degraded & ~right)[mapped].sum()}")
    print(f"off the map: right {right[~mapped].sum()} ok {ok[~mapped].sum()}, wrong and ok {(ok & ~right)[~mapped].sum()}, "
          f"wrong and degraded {(degraded & ~right)[~mapped].sum()} of {(~mapped).sum()}")
    error = 0.0
    for low in np.arange(0, 1, 0.1):
        here = alone & (p >= low) & (p < low + 0.1 + 1e-9 * (low > 0.85))
        if here.sum():
            print(f"  {low:.1f}-{low + 0.1:.1f}: n {here.sum():5d} confidence {p[here].mean():.3f} right {right[here].mean():.3f}")
            error += here.sum() * abs(p[here].mean() - right[here].mean())
    print(f"calibration error {error / max(1, alone.sum()):.4f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--places", type=pathlib.Path, required=True)
    parser.add_argument("--phasescan", default=ROOT / "build/release/bin/phasescan")
    parser.add_argument("--poses", type=int, default=300)
    parser.add_argument("--config", help="a YAML file for phasescan")
    parser.add_argument("--test", action="store_true")
    parser.add_argument("--gap", type=float, default=6.0)
    options = parser.parse_args()
    options.places.mkdir(parents=True, exist_ok=True)
    rows = cases(options, 7001 if options.test else 5001)
    if options.test:
        show(rows, np.array([r["confidence"] for r in rows]), options.gap)
        return
    x, right = columns(rows), np.array([r["right"] for r in rows]).astype(float)
    # Judged by constants that were fitted on the other groups.
    names = sorted({r["group"] for r in rows})
    p = np.zeros(len(rows))
    for name in names:
        held = np.array([r["group"] == name for r in rows])
        b, w = fit(x[~held], right[~held])
        p[held] = 1.0 / (1.0 + np.exp(-(b + x[held] @ w)))
    show(rows, p, options.gap)
    b, w = fit(x, right)
    print("constant", f"{b:.3f}", *(f"{name} {value:.3f}" for (name, _, _), value in zip(FEATURES, w)))


if __name__ == "__main__":
    main()
