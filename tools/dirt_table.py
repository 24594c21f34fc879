#!/usr/bin/env python3
"""How far a finished map is off where a log is dirty: kinds of tools/dirty_logs.py by sensor, world and wheels, over seeds.

usage: dirt_table.py [--seeds N] [--first-seed K] [--kind WORD] [--sensor WORD] [--world WORD] [--wheels yes|no] [--jobs N] [--json]
WORD picks by a part of the name. $PHASESCAN names another command than build/release/bin/phasescan.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(HERE / "tools"))
import dirty_logs  # noqa: E402
from command import call, markdown  # noqa: E402

SENSORS = ("rplidar-a1", "rplidar-a1-real", "ld06", "ld06-real")
WORLDS = ("flat", "office")


def limit(kind, wheels):
    """ATE that a run may have [m]."""
    return 0.03 if wheels or "own" in kind or kind == "clean" else 0.05


def run_log(job):
    """All kinds over one simulated log."""
    sensor, world, wheels, seed, kinds = job
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        clean, dirty, out = (os.path.join(folder, n) for n in ("clean.jsonl", "dirty.jsonl", "run"))
        call("simulate", "--world", f"{world}:{seed}", "--sensor", sensor, "--seed", seed, "--out", clean, *(["--odometry"] if wheels else []))
        for kind in kinds:
            dirty_logs.make(clean, dirty, kind, seed)
            call("slam", dirty, "--out", out, "--no-times")
            error = call("eval", "--trajectory", f"{out}/trajectory.tum", "--reference", f"{clean}.truth.tum", "--json").stdout
            with open(f"{out}/summary.json") as f:
                summary = json.load(f)
            rows.append({"kind": kind, "sensor": sensor, "world": world, "wheels": wheels, "seed": seed, "scans": summary["scans"],
                         "left_out": summary["map"]["scans_left_out"], "verdict": summary.get("verdict"),
                         "ate_m": json.loads(error)["ate_m"]["rmse"] if error else None})
    return rows


def run(seeds=10, first_seed=1, kind="", sensor="", world="", wheels="", jobs=2):
    kinds = [k for k in dirty_logs.KINDS if kind in k]
    work = [(s, w, o, seed, kinds) for s in SENSORS if s == sensor or not sensor for w in WORLDS if world in w for o in (True, False)
            if wheels in ("", "yes" if o else "no") for seed in range(first_seed, first_seed + seeds)]
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        return [row for rows in pool.map(run_log, work) for row in rows]


def table(rows):
    """Of each kind, sensor, world and use of wheels: worst and median error, and how many runs are over the limit."""
    groups = {}
    for r in rows:
        groups.setdefault((r["kind"], r["sensor"], r["world"], r["wheels"]), []).append(r)
    lines = []
    for (kind, sensor, world, wheels), runs in sorted(groups.items(), key=lambda g: list(dirty_logs.KINDS).index(g[0][0])):
        errors = sorted(99.0 if r["ate_m"] is None else r["ate_m"] for r in runs)
        over = sum(e > limit(kind, wheels) for e in errors)
        lines.append([kind, sensor, world, "yes" if wheels else "no", f"{errors[-1]:.3f}", f"{errors[len(errors) // 2]:.3f}", f"{over} of {len(errors)}",
                      ", ".join(str(r["seed"]) for r in runs if r["ate_m"] is None or r["ate_m"] > limit(kind, wheels)),
                      f"{sum(r['left_out'] for r in runs) / len(runs):.0f}"])
    return ["kind", "sensor", "world", "wheels", "worst ATE [m]", "median", "over the limit", "seeds over", "left out"], lines


def print_table(rows):
    header, lines = table(rows)
    print(markdown(header, lines, 4), end="")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    for name in ("kind", "sensor", "world", "wheels"):
        parser.add_argument(f"--{name}", default="")
    parser.add_argument("--json", action="store_true")
    flags = vars(parser.parse_args())
    as_json = flags.pop("json")
    rows = run(**flags)
    if as_json:
        return print(json.dumps(rows, indent=1))
    print_table(rows)


if __name__ == "__main__":
    main()
