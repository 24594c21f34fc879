#!/usr/bin/env python3
"""What lost scans cost: logs of which bursts of messages are gone, against the same logs whole.

usage: burst_table.py [--seeds N] [--log WORD] [--jobs N] [--json]
Recorded logs with relations: before each scan a burst of 3 to 7 is lost with a probability of 5 %; errors over the relations that both runs answer.
Simulated drives without wheels: bursts of 1 to 8, 12 %. $PHASESCAN names another command than build/release/bin/phasescan; recorded logs are looked
for in $PHASESCAN_DATA, else ../shared/data.
"""
import argparse
import concurrent.futures
import json
import math
import pathlib
import random
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(HERE / "tools"))
import tum  # noqa: E402
from command import DATA, call, markdown  # noqa: E402

# Name, relations, where the laser is on the base: scan logs keep no mounting.
RECORDED = [("intel-raw", "intel-checked", 0.0), ("fr079-raw", "fr079", 0.04)]
OPTIONS = [["--odometry", "none"], ["--odometry", "none", "--range-max", "6"], ["--range-max", "6"]]
SIMULATED = ["building", "corridor"]


def lose(whole, lossy, share, least, most, seed):
    """Line numbers of the scans that stay."""
    chance, kept, k = random.Random(seed), [], 0
    lines = pathlib.Path(whole).read_text().splitlines(keepends=True)
    while k < len(lines):
        if chance.random() < share:
            k += chance.randint(least, most)
        else:
            kept.append(k)
            k += 1
    pathlib.Path(lossy).write_text("".join(lines[k] for k in kept))
    return kept


def errors(trajectory, relations, mount):
    """(metres, degrees) of each relation that is answered, by its two stamps."""
    poses = {}
    for stamp, pose in tum.read_tum(trajectory):
        poses.setdefault(round(stamp, 4), pose)
    out = {}
    for line in open(relations):
        w = list(map(float, line.split()))
        key = (round(w[0], 4), round(w[1], 4))
        if key[0] not in poses or key[1] not in poses:
            continue
        (ax, ay, at), (bx, by, bt) = ((x + mount * math.cos(t), y + mount * math.sin(t), t) for x, y, t in (poses[k] for k in key))
        c, s = math.cos(at), math.sin(at)
        out[key] = (math.hypot(c * (bx - ax) + s * (by - ay) - w[2], c * (by - ay) - s * (bx - ax) - w[3]),
                    abs(math.degrees(math.remainder(bt - at - w[7], math.tau))))
    return out


def recorded_row(job):
    name, relations, mount, options, seed, log, whole = job
    with tempfile.TemporaryDirectory() as folder:
        lossy, out = f"{folder}/log.jsonl", f"{folder}/out"
        lose(log, lossy, 0.05, 3, 7, seed)
        call("slam", lossy, "--out", out, "--no-times", *options)
        found = errors(f"{out}/trajectory.tum", DATA / f"carmen/{relations}.relations", mount)
        summary = json.loads(pathlib.Path(f"{out}/summary.json").read_text())
    both = [k for k in found if k in whole]
    mean = lambda e, i: sum(e[k][i] for k in both) / len(both)
    return {"log": name, "options": options, "seed": seed, "relations": len(both), "mean_m": mean(found, 0), "mean_whole_m": mean(whole, 0),
            "mean_deg": mean(found, 1), "mean_whole_deg": mean(whole, 1), "largest_m": max(found[k][0] for k in both),
            "largest_deg": max(found[k][1] for k in both), "pieces": summary["map"]["pieces"], "verdict": summary["verdict"]}


def recorded(seeds, jobs, word):
    rows = []
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        for name, relations, mount in RECORDED:
            source, truth = DATA / f"carmen/{name}.log.gz", DATA / f"carmen/{relations}.relations"
            if word not in name or not (source.exists() and truth.exists()):
                continue
            log = f"{folder}/{name}.jsonl"
            call("convert", source, log)
            for options in OPTIONS:
                call("slam", log, "--out", f"{folder}/whole", "--no-times", *options)
                whole = errors(f"{folder}/whole/trajectory.tum", truth, mount)
                rows += pool.map(recorded_row, [(name, relations, mount, options, seed, log, whole) for seed in range(1, seeds + 1)])
    return rows


def simulated_row(job):
    world, seed = job
    with tempfile.TemporaryDirectory() as folder:
        whole, lossy, out = f"{folder}/whole.jsonl", f"{folder}/log.jsonl", f"{folder}/out"
        call("simulate", "--world", f"{world}:{seed}", "--sensor", "rplidar-a1-real", "--seed", seed, "--out", whole)
        lose(whole, lossy, 0.12, 1, 8, seed)
        call("slam", lossy, "--out", out, "--no-times", "--odometry", "none")
        truth, found = dict(tum.read_tum(f"{whole}.truth.tum")), tum.read_tum(f"{out}/trajectory.tum")
        ate = json.loads(call("eval", "--trajectory", f"{out}/trajectory.tum", "--reference", f"{whole}.truth.tum", "--json").stdout)
        first = found[0][1][2] - truth[found[0][0]][2]
        turns = [math.degrees(math.remainder(p[2] - truth[t][2] - first, math.tau)) for t, p in found if t in truth]
        heading = math.sqrt(sum(e * e for e in turns) / len(turns))
        summary = json.loads(pathlib.Path(f"{out}/summary.json").read_text())
    return {"log": world, "options": ["--odometry", "none"], "seed": seed, "ate_m": ate["ate_m"]["rmse"], "heading_deg": heading,
            "pieces": summary["map"]["pieces"], "verdict": summary["verdict"]}


def run(seeds=10, jobs=1, word=""):
    rows = recorded(seeds, jobs, word)
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        rows += pool.map(simulated_row, [(w, seed) for w in SIMULATED if word in w for seed in range(1, seeds + 1)])
    return rows


def table(rows):
    groups = {}
    for r in rows:
        groups.setdefault((r["log"], " ".join(r["options"])), []).append(r)
    lines = []
    for (log, options), runs in groups.items():
        good, torn = sum(r["verdict"] == "good" for r in runs), sum(r["pieces"] > 1 for r in runs)
        if "ate_m" in runs[0]:
            trusted = [r for r in runs if r["verdict"] == "good"] or runs
            lines.append([log, options, len(runs), "-", "-", f"{max(r['ate_m'] for r in trusted):.3f} (ATE)",
                          f"{max(r['heading_deg'] for r in trusted):.1f} (RMS)", torn, good])
            continue
        ratio = lambda a, b: [r[a] / r[b] for r in runs]
        m, deg = ratio("mean_m", "mean_whole_m"), ratio("mean_deg", "mean_whole_deg")
        lines.append([log, options, len(runs), f"{sum(m) / len(m):.2f}, {max(m):.2f}", f"{sum(deg) / len(deg):.2f}, {max(deg):.2f}",
                      f"{max(r['largest_m'] for r in runs):.3f}", f"{max(r['largest_deg'] for r in runs):.1f}", torn, good])
    return ["log", "options", "seeds", "mean error, times that without losses: mean, worst", "of the rotation", "largest [m]", "largest [deg]",
            "torn", "called good"], lines


def print_table(rows):
    header, lines = table(rows)
    print(markdown(header, lines, 2), end="")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--log", default="", help="a part of the name of a log or a world")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--json", action="store_true")
    flags = parser.parse_args()
    rows = run(flags.seeds, flags.jobs, flags.log)
    if flags.json:
        return print(json.dumps(rows, indent=1))
    print_table(rows)


if __name__ == "__main__":
    main()
