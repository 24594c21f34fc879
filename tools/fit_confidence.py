#!/usr/bin/python3
"""Fits the constants of the confidence (src/match/confidence.cpp) and says what they are worth on data left out.

    phasescan bench --sim bench-honesty --count 30000 --seed 7 --method global --out out/fit --features out/fit/sim.csv
    phasescan bench --sim bench-doubt --count 12000 --method global --out out/fit --features out/fit/doubt.csv
    phasescan bench --pairs PAIRS... --method global --out out/fit --features out/fit/real.csv
    tools/fit_confidence.py --sim out/fit/sim.csv out/fit/doubt.csv --real out/fit/real.csv

The constants are fitted on simulated pairs alone: every recorded file is one left out. Prints, as Markdown, recorded files
judged by them (a line is a file), each half of the simulated pairs judged by constants fitted on the other (a line is a data
set), and the constants. The logistic function maximises the likelihood, with a ridge on everything but the constant.
"""
import argparse
import csv
import pathlib

import numpy as np

GIVEN = ["source", "dataset", "class", "id", "method", "right", "usable", "ambiguous", "confidence", "weak_sigma_m", "across_m"]


class Answers:
    """Answers of global with their features, one row each."""

    def __init__(self, names, group, x, right, ambiguous):
        self.names, self.group, self.x, self.right, self.ambiguous = names, group, x, right, ambiguous

    def of(self, keep):
        return Answers(self.names, self.group[keep], self.x[keep], self.right[keep], self.ambiguous[keep])


def read(paths, by):
    """@param by  column that names the groups: `source` (a file of recorded pairs) or `dataset`"""
    names, rows = None, []
    for path in paths:
        with open(path, newline="", encoding="utf-8") as lines:
            table = csv.DictReader(lines)
            found = [n for n in table.fieldnames if n not in GIVEN]
            if names not in (None, found):
                raise SystemExit(f"{path}: other features than in the tables before it")
            names = found
            rows += [(r[by] or r["dataset"], [float(r[n]) for n in names], r["right"] == "1", r["ambiguous"] == "1") for r in table]
    if not rows:
        raise SystemExit(f"{' '.join(paths)}: no answers")
    group, x, right, ambiguous = zip(*rows)
    return Answers(names, np.array(group), np.array(x), np.array(right), np.array(ambiguous))


def probability(beta, x):
    return 1.0 / (1.0 + np.exp(-np.clip(x @ beta, -30.0, 30.0)))


def fit(answers, ridge):
    """Newton's method on the likelihood, less ridge / 2 times the squares of all but the constants."""
    x, y = answers.x, answers.right.astype(float)
    constant = np.ptp(x, axis=0) == 0
    penalty = np.where(constant, 1e-9, ridge)
    beta = np.zeros(x.shape[1])

    def loss(b):
        s = x @ b
        return float(np.sum(np.logaddexp(0.0, s) - y * s) + 0.5 * penalty @ b**2)

    for _ in range(60):
        p = probability(beta, x)
        gradient = x.T @ (y - p) - penalty * beta
        hessian = (x.T * (p * (1.0 - p))) @ x + np.diag(penalty)
        step = np.linalg.solve(hessian, gradient)
        size, before = 1.0, loss(beta)
        while loss(beta + size * step) > before and size > 1e-6:
            size *= 0.5
        beta = beta + size * step
        if np.max(np.abs(step)) < 1e-7:
            break
    return beta


def area_under_roc(p, right):
    positives, negatives = int(right.sum()), int((~right).sum())
    if not positives or not negatives:
        return None
    order = np.argsort(p, kind="stable")
    values, start, count = np.unique(p[order], return_index=True, return_counts=True)
    ranks = np.empty(len(p))
    ranks[order] = np.repeat(start + (count + 1) / 2.0, count)
    return (ranks[right].sum() - positives * (positives + 1) / 2.0) / (positives * negatives)


def calibration_error(p, right):
    bins = np.minimum((p * 10).astype(int), 9)
    return sum(abs(p[bins == b].sum() - right[bins == b].sum()) for b in range(10)) / len(p)


def table(answers, p, threshold):
    usable = (p > threshold) & ~answers.ambiguous
    lines = ["| data set | n | right & usable | right & refused | wrong & refused | wrong & usable | right refused [%] | "
             "wrong & usable [%] | AUC | ECE |", "|---|" + "---:|" * 9]
    groups = [(name, answers.group == name) for name in dict.fromkeys(answers.group)]
    groups.append(("all", np.full(len(p), True)))
    for name, of in groups:
        right, said = answers.right[of], usable[of]
        counts = [int((right & said).sum()), int((right & ~said).sum()), int((~right & ~said).sum()), int((~right & said).sum())]
        auc = area_under_roc(p[of], right)
        lines.append(f"| {name} | {len(right)} | {counts[0]} | {counts[1]} | {counts[2]} | {counts[3]} | "
                     f"{'-' if not right.any() else format(100 * counts[1] / right.sum(), '.1f')} | {100 * counts[3] / len(right):.2f} | "
                     f"{'-' if auc is None else format(auc, '.4f')} | {calibration_error(p[of], right):.4f} |")
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sim", nargs="+", required=True, help="tables of simulated pairs")
    parser.add_argument("--real", nargs="*", default=[], help="tables of recorded pairs")
    parser.add_argument("--threshold", type=float, default=0.9, help="match.min_confidence")
    parser.add_argument("--ridge", type=float, default=0.3)
    parser.add_argument("--out", help="also write the tables to this file")
    args = parser.parse_args()
    sim = read(args.sim, "dataset")
    constants = fit(sim, args.ridge)
    text = []
    if args.real:
        real = read(args.real, "source")
        text.append("Recorded pairs, none of which the constants were fitted on:\n\n" + table(real, probability(constants, real.x), args.threshold))
    even = np.arange(len(sim.right)) % 2 == 0
    p = np.empty(len(sim.right))
    for half in (even, ~even):
        p[half] = probability(fit(sim.of(~half), args.ridge), sim.x[half])
    text.append("Simulated pairs, each half judged by constants fitted on the other:\n\n" + table(sim, p, args.threshold))
    if args.out:
        pathlib.Path(args.out).write_text("\n".join(text), encoding="utf-8")
    print("\n".join(text))
    print("Constants, for src/match/confidence.cpp:\n")
    print("constexpr std::array<double, ConfidenceFeatures::kCount> kCoefficients{\n    " + ", ".join(f"{b:.3f}" for b in constants) + "};")
    print("// " + ", ".join(f"{n} {b:.3f}" for n, b in zip(sim.names, constants)))


if __name__ == "__main__":
    main()
