#!/usr/bin/env python3
"""Fits the logistic function of src/match/confidence.cpp.

Reads tables of features (tab separated: dataset, class, id, right 0/1, features..., rest ignored), prints coefficients and,
for every data set, what usable answers at the threshold would be worth.

  fit_confidence.py --features K TRAIN.tsv... [--leave-out REAL.tsv] [--check CHECK.tsv...]

With --leave-out, every data set of that table is judged by coefficients fitted on TRAIN and its other data sets; the
coefficients printed are fitted on all of them.
"""
import argparse
import collections
import math


def read(paths, count):
    rows = []
    for path in paths:
        with open(path, encoding="utf-8") as lines:
            for line in lines:
                cells = line.rstrip("\n").split("\t")
                rows.append((cells[0], cells[1], int(cells[3]), [float(v) for v in cells[4:4 + count]], float(cells[4 + count]), cells[5 + count] == "1"))
    return rows


def solve(matrix, vector):
    n = len(vector)
    m = [row[:] + [vector[i]] for i, row in enumerate(matrix)]
    for i in range(n):
        p = max(range(i, n), key=lambda r: abs(m[r][i]))
        m[i], m[p] = m[p], m[i]
        for r in range(i + 1, n):
            f = m[r][i] / m[i][i]
            if f:
                for c in range(i, n + 1):
                    m[r][c] -= f * m[i][c]
    x = [0.0] * n
    for i in reversed(range(n)):
        x[i] = (m[i][n] - sum(m[i][c] * x[c] for c in range(i + 1, n))) / m[i][i]
    return x


def probability(coefficients, features):
    return 1.0 / (1.0 + math.exp(-max(-30.0, min(30.0, sum(a * b for a, b in zip(coefficients, features))))))


def fit(rows, count, weight_of, ridge=0.3, steps=12):
    """Maximum likelihood by iteratively reweighted least squares, ridge on everything but the constant."""
    beta = [0.0] * count
    for _ in range(steps):
        hessian = [[ridge if i == j and i > 0 else 1e-9 if i == j else 0.0 for j in range(count)] for i in range(count)]
        gradient = [-ridge * beta[i] if i > 0 else 0.0 for i in range(count)]
        for row in rows:
            w = weight_of(row)
            p = probability(beta, row[3])
            d, q = w * (row[2] - p), w * p * (1 - p)
            x = row[3]
            for i in range(count):
                gradient[i] += d * x[i]
                qi = q * x[i]
                hi = hessian[i]
                for j in range(i + 1):
                    hi[j] += qi * x[j]
        for i in range(count):
            for j in range(i):
                hessian[j][i] = hessian[i][j]
        beta = [b + s for b, s in zip(beta, solve(hessian, gradient))]
    return beta


def auc(scored):
    scored = sorted(scored)
    rank_sum, positives = 0.0, 0
    for k, (_, right) in enumerate(scored):
        if right:
            rank_sum += k + 1
            positives += 1
    negatives = len(scored) - positives
    return (rank_sum - positives * (positives + 1) / 2) / (positives * negatives) if positives and negatives else 1.0


def report(judged, threshold):
    sets = collections.OrderedDict()
    for row, p in judged:
        sets.setdefault(row[0], []).append((row, p))
    print(f"{'data set':22s} {'n':>6s} {'right':>6s} {'wrong&usable %':>15s} {'right refused %':>16s} {'ECE':>6s} {'AUC':>6s}")
    for name, members in list(sets.items()) + [("ALL", judged)]:
        usable = [p > threshold and not row[5] for row, p in members]
        wrong = sum(u and not row[2] for u, (row, _) in zip(usable, members))
        right = sum(row[2] for row, _ in members)
        refused = sum(not u and row[2] for u, (row, _) in zip(usable, members))
        bins = collections.defaultdict(lambda: [0.0, 0.0])
        for row, p in members:
            bins[min(9, int(p * 10))][0] += p
            bins[min(9, int(p * 10))][1] += row[2]
        ece = sum(abs(a - b) for a, b in bins.values()) / len(members)
        print(f"{name:22s} {len(members):6d} {right:6d} {100 * wrong / len(members):15.2f} {100 * refused / max(right, 1):16.2f} "
              f"{ece:6.3f} {auc([(p, row[2]) for row, p in members]):6.3f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("train", nargs="+")
    parser.add_argument("--features", type=int, required=True)
    parser.add_argument("--check", nargs="*", default=[])
    parser.add_argument("--threshold", type=float, default=0.9)
    parser.add_argument("--leave-out", nargs="*", default=[])
    args = parser.parse_args()
    train = read(args.train, args.features)
    real = read(args.leave_out, args.features)
    beta = fit(train + real, args.features, lambda row: 1.0)
    print("coefficients {" + ", ".join(f"{b:.3f}" for b in beta) + "}")
    report([(row, probability(beta, row[3])) for row in train], args.threshold)
    if real:
        print("each data set left out of the fit:")
        judged = []
        for name in sorted({row[0] for row in real}):
            without = fit(train + [row for row in real if row[0] != name], args.features, lambda row: 1.0)
            judged += [(row, probability(without, row[3])) for row in real if row[0] == name]
        report(judged, args.threshold)
    if args.check:
        print("checked on:")
        report([(row, probability(beta, row[3])) for row in read(args.check, args.features)], args.threshold)


if __name__ == "__main__":
    main()
