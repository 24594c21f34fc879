#!/usr/bin/python3
"""Fits the constants of the verdict (src/slam/verdict.cpp) and says what they are worth on runs left out.

    tools/verdict_runs.py --runs 100 --first-seed 1 --variants 3 --rows train.jsonl
    tools/verdict_runs.py --runs 100 --first-seed 100001 --rows train.jsonl
    tools/verdict_runs.py --runs 100 --first-seed 1 --sparse --rows train.jsonl
    tools/verdict_runs.py --runs 1000 --rows test.jsonl
    tools/verdict_fit.py train.jsonl --test test.jsonl

A run is right where its error is within 0.2 m or 1 % of the way. Every feature is log(1 + (number / scale)^2), its weight at most 0: more of
what speaks against a map never makes it better. No number grows with the length of a run by itself: shares, means of a worst twentieth, metres by
what a right map may be off. The logistic function maximises the likelihood with a ridge around a prior. Prints the
constants, and how runs are judged by constants fitted on the other runs (five parts) or on all (--test).
"""
import argparse
import json
import math
import sys

import numpy as np

sys.path.insert(0, __file__.rsplit("/", 1)[0])
import verdict_runs  # noqa: E402

# Number of the evidence, kind of the reason that it is, scale: what a run that is right may well have, and the weight that it has before
# any run was seen. What few runs show stays near to that.
FEATURES = [
    ("far_tail_crossed", "contradiction", 0.15, -1.5), ("far_tail_in_free", "contradiction", 0.3, -1.0), ("excess_crossed", "contradiction", 0.03, -0.7),
    ("excess_in_free", "contradiction", 0.05, -0.5), ("near_tail_against", "contradiction", 0.3, -0.5), ("far_tail_doubled", "doubled_walls", 0.15, -1.2),
    ("excess_doubled", "doubled_walls", 0.03, -0.5), ("expected_ratio", "gaps", 0.5, -1.8), ("lost_unaided", "gaps", 0.05, -1.0), ("unseen_ratio", "gaps", 8.0, -1.4), ("jump_ratio", "gaps", 1.0, -1.2),
    ("off_map", "pieces", 0.03, -1.0), ("off_map_ratio", "pieces", 0.2, -0.7), ("no_overlap", "bad_scans", 0.1, -0.4), ("kept", "bad_scans", 0.15, -0.4),
    ("degraded_unconfirmed", "bad_scans", 0.5, -0.7), ("left_out", "bad_scans", 0.1, -0.3),
    ("step_chi2_tail", "aliasing", 3.0, -0.7), ("bend_ratio", "aliasing", 0.3, -0.7), ("loop_chi2_tail", "aliasing", 10.0, -0.3),
    ("unseen_doubted", "aliasing", 1.0, -0.7), ("open_doubted", "aliasing", 0.5, -1.5), ("degraded_bent", "aliasing", 2.0, -1.2), ("wheels_slipped", "wheels", 0.3, -0.3)]
PRIOR = (6.0, np.array([prior for *_, prior in FEATURES]))
RIDGE = 5.0  # of a weight's distance from that, in units of one run
VARIANT = 0.3  # what a variant with more dirt counts for: most logs are not as bad


def read(path):
    with open(path) as lines:
        return [json.loads(line) for line in lines]


def columns(rows):
    return np.array([[math.log1p((r["evidence"][name] / scale) ** 2) for name, _, scale, _ in FEATURES] for r in rows])


def weights(rows):
    return np.array([VARIANT if r.get("variant") else 1.0 for r in rows])


def fit(x, right, weight):
    """@param weight  of each run @return the constant and the weights, by steps along the gradient that keep the weights at most 0"""
    b, w = PRIOR
    last, step, y = (b, w), 4.0 / (weight.sum() * (1.0 + (x ** 2).sum(axis=1).max()) + 4.0 * RIDGE), right.astype(float)
    for k in range(20000):  # with momentum: the ridge makes it convex, the bound is a projection
        ahead_b, ahead_w = b + k / (k + 3) * (b - last[0]), w + k / (k + 3) * (w - last[1])
        off = weight * (y - 1.0 / (1.0 + np.exp(-(ahead_b + x @ ahead_w))))
        last = (b, w)
        b = ahead_b + step * (off.sum() - 0.25 * RIDGE * (ahead_b - PRIOR[0]))
        w = np.minimum(0.0, ahead_w + step * (x.T @ off - RIDGE * (ahead_w - PRIOR[1])))
        if k > 500 and max(abs(b - last[0]), np.abs(w - last[1]).max()) < 1e-7:
            break
    return b, w


def judge(rows, probability):
    """Rows with the verdict that these probabilities give; what a run may not be called whatever it has is in its own verdict."""
    out = []
    for row, p in zip(rows, probability):
        if row["evidence"]["on_map"] < 0.5:
            p = min(p, 0.2)
        out.append({**row, "probability": p, "verdict": "good" if p >= 0.97 else "failed" if p <= 0.2 else "doubtful"})
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("train")
    parser.add_argument("--test")
    flags = parser.parse_args()
    train = read(flags.train)
    x, right = columns(train), np.array([verdict_runs.is_right(r) for r in train])
    weight = weights(train)
    chance = lambda x, b, w: 1.0 / (1.0 + np.exp(-(b + x @ w)))
    judged = [None] * len(train)
    for part in range(5):
        left_out = np.array([r["seed"] % 5 == part for r in train])  # variants of one log together
        b, w = fit(x[~left_out], right[~left_out], weight[~left_out])
        for k, row in zip(np.flatnonzero(left_out), judge([r for r, o in zip(train, left_out) if o], chance(x[left_out], b, w))):
            judged[k] = row
    print("Each fifth judged by the others:\n")
    verdict_runs.print_table(judged)
    for row in judged:
        wrong = row["verdict"] == "good" and not verdict_runs.is_right(row)
        if wrong or (row["verdict"] != "good" and verdict_runs.is_right(row)):
            print(f"# {row['seed']} {row['world']} {row['sensor']} {row['dirt']} ATE {row['ate_m']:.3f} p {row['probability']:.3f}", file=sys.stderr)
    b, w = fit(x, right, weight)
    if flags.test:
        test = read(flags.test)
        print("\nRuns left out:\n")
        verdict_runs.print_table(judge(test, chance(columns(test), b, w)))
    print(f"\nconstexpr double kConstant = {b:.2f};")
    for (name, kind, scale, _), weight in zip(FEATURES, w):
        if weight < -0.005:
            print(f'    Feature{{"{name}", "{kind}", {scale}, {weight:.2f}}},')


if __name__ == "__main__":
    main()
