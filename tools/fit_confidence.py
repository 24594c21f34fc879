#!/usr/bin/python3
"""Fits the constants of the confidence (src/match/confidence.cpp) and says what they are worth on data left out.

    phasescan bench --sim bench-honesty --count 20000 --seed 7 --method fft-mh --out out/fit --features out/fit/sim.csv
    phasescan bench --sim bench-doubt --count 4000 --method fft-mh --out out/fit --features out/fit/doubt.csv
    phasescan bench --pairs PAIRS... --method fft-mh --out out/fit --features out/fit/real.csv
    tools/fit_confidence.py --sim out/fit/sim.csv out/fit/doubt.csv --real out/fit/real.csv

prints, as Markdown: the constants fitted on everything; every recorded file left out of the fit and judged by the rest;
all recorded files judged by constants fitted on simulated pairs alone; and what the program that wrote the tables said
itself. A line is a file of recorded pairs, or a data set of simulated ones. The logistic function maximises the
likelihood, with a ridge on everything but the constant.
"""
import argparse
import csv
import pathlib

import numpy as np

GIVEN = ["source", "dataset", "class", "id", "method", "right", "usable", "ambiguous", "confidence", "weak_sigma_m", "across_m"]


class Answers:
    """Answers of fft-mh with their features, one row each."""

    def __init__(self, names, group, x, right, usable, ambiguous, confidence):
        self.names, self.group, self.x, self.right = names, group, x, right
        self.usable, self.ambiguous, self.confidence = usable, ambiguous, confidence

    def of(self, keep):
        return Answers(self.names, self.group[keep], self.x[keep], self.right[keep], self.usable[keep], self.ambiguous[keep],
                       self.confidence[keep])


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
            rows += [(r[by] or r["dataset"], [float(r[n]) for n in names], r["right"] == "1", r["usable"] == "1", r["ambiguous"] == "1",
                      float(r["confidence"])) for r in table]
    if not rows:
        raise SystemExit(f"{' '.join(paths)}: no answers")
    group, x, right, usable, ambiguous, confidence = zip(*rows)
    return Answers(names, np.array(group), np.array(x), np.array(right), np.array(usable), np.array(ambiguous), np.array(confidence))


def probability(beta, x):
    return 1.0 / (1.0 + np.exp(-np.clip(x @ beta, -30.0, 30.0)))


def fit(parts, ridge):
    """Newton's method on the likelihood of [(answers, weight)], less ridge / 2 times the squares of all but the constants."""
    x = np.concatenate([a.x for a, _ in parts])
    y = np.concatenate([a.right for a, _ in parts]).astype(float)
    w = np.concatenate([np.full(len(a.right), weight) for a, weight in parts])
    constant = np.ptp(x, axis=0) == 0
    penalty = np.where(constant, 1e-9, ridge)
    beta = np.zeros(x.shape[1])

    def loss(b):
        s = x @ b
        return float(w @ (np.logaddexp(0.0, s) - y * s) + 0.5 * penalty @ b**2)

    for _ in range(60):
        p = probability(beta, x)
        gradient = x.T @ (w * (y - p)) - penalty * beta
        hessian = (x.T * (w * p * (1.0 - p))) @ x + np.diag(penalty)
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


def table(answers, p, usable, total):
    lines = ["| data set | n | right & usable | right & refused | wrong & refused | wrong & usable | right refused [%] | "
             "wrong & usable [%] | AUC | ECE |", "|---|" + "---:|" * 9]
    groups = [(name, answers.group == name) for name in dict.fromkeys(answers.group)]
    if total:
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
    parser.add_argument("--real-weight", type=float, default=1.0, help="weight of a recorded pair against a simulated one")
    parser.add_argument("--out", help="also write the tables to this file")
    args = parser.parse_args()
    sim = read(args.sim, "dataset")
    real = read(args.real, "source") if args.real else None
    text = []

    def judged(title, answers, p, usable=None):
        said = (p > args.threshold) & ~answers.ambiguous if usable is None else usable
        text.append(f"{title}\n\n{table(answers, p, said, True)}")

    everything = fit([(sim, 1.0)] + ([(real, args.real_weight)] if real else []), args.ridge)
    if real:
        p = np.empty(len(real.right))
        for name in dict.fromkeys(real.group):
            left_out = real.group == name
            p[left_out] = probability(fit([(sim, 1.0), (real.of(~left_out), args.real_weight)], args.ridge), real.x[left_out])
        judged("Recorded pairs, each file judged by constants fitted without it (on simulated pairs and the other files):", real, p)
        judged("Recorded pairs, judged by constants fitted on simulated pairs alone:", real, probability(fit([(sim, 1.0)], args.ridge), real.x))
        judged("Recorded pairs, as the program that made the table says itself:", real, real.confidence, real.usable)
    even = np.arange(len(sim.right)) % 2 == 0
    p = np.empty(len(sim.right))
    for half in (even, ~even):
        p[half] = probability(fit([(sim.of(~half), 1.0)] + ([(real, args.real_weight)] if real else []), args.ridge), sim.x[half])
    judged("Simulated pairs, each half judged by constants fitted without it:", sim, p)
    if args.out:
        pathlib.Path(args.out).write_text("\n".join(text), encoding="utf-8")
    print("\n".join(text))
    print("Constants fitted on everything, for src/match/confidence.cpp:\n")
    print("constexpr std::array<double, ConfidenceFeatures::kCount> kCoefficients{\n    " + ", ".join(f"{b:.3f}" for b in everything) + "};")
    print("// " + ", ".join(f"{n} {b:.3f}" for n, b in zip(sim.names, everything)))


if __name__ == "__main__":
    main()
