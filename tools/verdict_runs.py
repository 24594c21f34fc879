#!/usr/bin/env python3
"""What the verdict of a run is worth: simulated logs, half of them clean and half dirty, each run through slam and compared with its truth.

usage: verdict_runs.py [--runs N] [--first-seed K] [--jobs N] [--logs FOLDER] [--rows FILE] [--table]
A log follows from its seed alone: sensor, world, way, wheels, and for odd seeds one or two kinds of dirt. --logs keeps them; those that are
there already are used. --rows: a line of JSON per run, with the evidence that the verdict rests on. $PHASESCAN names another command than
build/release/bin/phasescan.
"""
import argparse
import concurrent.futures
import json
import math
import os
import pathlib
import random
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(HERE / "tools"))
import dirty_logs  # noqa: E402
import repeating_worlds  # noqa: E402

COMMAND = os.environ.get("PHASESCAN", str(HERE / "build/release/bin/phasescan"))
SENSORS = {"rplidar-a1": 5.5, "rplidar-a1-real": 5.5, "ydlidar-x4": 7.0, "ydlidar-x4-real": 7.0, "ld06": 10.0, "ld06-real": 10.0,
           "rplidar-c1": 10.0, "rplidar-c1-real": 10.0}  # turns a second
WORLDS = {"flat": 4, "office": 3, "building": 2, "corridor": 1, "hall": 1}  # by share


def call(*words):
    return subprocess.run([COMMAND, *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)


def bursts_lost(scans, chance):
    """What a slow computer loses: before each scan a burst of up to 8 is gone with a probability of 3 to 12 %."""
    share, most, kept, k = chance.uniform(0.03, 0.12), chance.randint(3, 8), [], 0
    while k < len(scans):
        if k > dirty_logs.FIRST and chance.random() < share:
            k += chance.randint(1, most)
        else:
            kept.append(scans[k])
            k += 1
    scans[:] = kept


def long_gaps(scans, chance):
    """Once or twice all scans of 3 to 20 s are gone: the robot drove on, or was carried."""
    for _ in range(chance.randint(1, 2)):
        period = (scans[-1]["stamp"] - scans[0].get("stamp", 0.0)) / (len(scans) - 1)
        n = int(chance.uniform(3.0, 20.0) / period)
        at = chance.randrange(len(scans) // 5, max(len(scans) // 5 + 1, len(scans) - n))
        del scans[at:at + n]


def covered(scans, chance):
    """Once to three times something hangs before the sensor for 1 to 8 s: nothing but a few beams comes back."""
    for _ in range(chance.randint(1, 3)):
        n, at = chance.randint(8, 60), chance.randrange(dirty_logs.FIRST, len(scans))
        for s in scans[at:at + n]:
            s["ranges"] = [r if chance.random() < 0.03 else 0 for r in s["ranges"]]


def noisy(scans, chance):
    """Ranges of a sensor that is worn: 2 to 6 cm of noise, a fifth to a half of the beams missing."""
    sigma, missing = chance.uniform(0.02, 0.06), chance.uniform(0.2, 0.5)
    for s in scans:
        s["ranges"] = [0 if r == 0 or chance.random() < missing else round(max(0.02, r + chance.gauss(0, sigma)), 4) for r in s["ranges"]]


def short_range(scans, chance):
    """Sun or a weak laser: nothing comes back from farther than 1.5 to 3 m."""
    most = chance.uniform(1.5, 3.0)
    for s in scans:
        s["ranges"] = [r if r <= most else 0 for r in s["ranges"]]


def wheels_slip(scans, chance):
    """Wheels that turn on the spot, or slide, for seconds on end; where there are none: nothing."""
    if "odometry" not in scans[0]:
        return
    steps, last = [], None
    for s in scans:
        o = s["odometry"]
        if last is not None:
            c, si = math.cos(last["theta"]), math.sin(last["theta"])
            dx, dy = o["x"] - last["x"], o["y"] - last["y"]
            steps.append([c * dx + si * dy, c * dy - si * dx, o["theta"] - last["theta"]])
        last = o
    kind = chance.choice(("spots", "spots", "scale", "turn"))
    if kind == "spots":
        for _ in range(chance.randint(1, 6)):
            at, n = chance.randrange(len(steps)), chance.randint(3, 40)
            factor, twist = chance.choice((0.0, 0.3, 2.0, -1.0)), chance.gauss(0, 0.03)
            for step in steps[at:at + n]:
                step[0] *= factor
                step[2] += twist
    for step in steps:
        if kind == "scale":
            step[0] *= 1.15
        elif kind == "turn":
            step[2] *= 1.1
    x, y, theta = (scans[0]["odometry"][k] for k in ("x", "y", "theta"))
    for s, (dx, dy, turn) in zip(scans[1:], steps):
        x, y, theta = x + math.cos(theta) * dx - math.sin(theta) * dy, y + math.sin(theta) * dx + math.cos(theta) * dy, theta + turn
        s["odometry"] = {"x": round(x, 5), "y": round(y, 5), "theta": round(theta, 6)}


DIRT = {**{k: (lambda scans, chance, change=change: change(scans, chance)) for k, change in dirty_logs.KINDS.items() if k != "clean"},
        "bursts lost": bursts_lost, "long gaps": long_gaps, "sensor covered": covered, "noisy": noisy, "short range": short_range,
        "wheels slip": wheels_slip}


def spec_of(seed):
    """What a seed stands for."""
    chance = random.Random(7919 * seed + 17)
    spec = {"seed": seed, "clean": seed % 2 == 0, "sensor": chance.choice(list(SENSORS)), "dirt": [],
            "world": chance.choices(list(WORLDS), list(WORLDS.values()))[0], "wheels": chance.random() < 0.5,
            "speed": chance.choice((0.3, 0.5, 0.8)), "turn_rate": chance.choice((45, 90)), "people": chance.choice((0, 0, 0, 1, 3)),
            "scans": int(200 * 4 ** chance.random())}
    if not spec["clean"]:
        kind = chance.choice(["repeats", *["dirt"] * 4])
        if kind == "repeats":
            spec["world"] = chance.choice(list(repeating_worlds.KINDS))
            spec["speed"], spec["scans"] = 0.8, chance.randint(400, 900)
        if kind == "dirt" or chance.random() < 0.3:
            spec["dirt"] = [chance.choice([k for k in DIRT if spec["wheels"] or k != "wheels slip"])]
            if spec["wheels"] and chance.random() < 0.25:
                spec["dirt"] = ["wheels slip"]
        if kind == "dirt" and chance.random() < 0.25:
            spec["dirt"].append(chance.choice(list(DIRT)))
    return spec


def make_log(spec, log):
    """The log and its truth."""
    seed, world, way = spec["seed"], f"{spec['world']}:{spec['seed']}", []
    if spec["world"] in repeating_worlds.KINDS:
        world, path = f"{log}.world.yaml", f"{log}.path.yaml"
        repeating_worlds.make(spec["world"], seed, world, path)
        way = ["--path", path]
    call("simulate", "--world", world, *way, "--sensor", spec["sensor"], "--seed", seed, "--speed", spec["speed"], "--turn-rate", spec["turn_rate"],
         "--people", spec["people"], "--duration", round(spec["scans"] / SENSORS[spec["sensor"]], 1), "--out", log,
         *(["--odometry"] if spec["wheels"] else []))
    if not spec["dirt"]:
        return
    with open(log) as f:
        scans = [json.loads(line) for line in f]
    chance = random.Random(seed)
    for kind in spec["dirt"]:
        DIRT[kind](scans, chance)
    with open(log, "w") as f:
        f.writelines(json.dumps(s) + "\n" for s in scans)


def way_of(truth):
    """Metres of the true way."""
    length, last = 0.0, None
    with open(truth) as f:
        for line in f:
            x, y = map(float, line.split()[1:3])
            if last is None or math.hypot(x - last[0], y - last[1]) >= 0.02:
                length += math.hypot(x - last[0], y - last[1]) if last else 0.0
                last = (x, y)
    return length


def run(seed, logs):
    """One run: what it was, what slam says of it, how far it is off."""
    spec = spec_of(seed)
    with tempfile.TemporaryDirectory() as folder:
        log, out = os.path.join(logs or folder, f"{seed}.jsonl"), os.path.join(folder, "out")
        if not os.path.exists(log):
            make_log(spec, os.path.join(folder, "new.jsonl"))
            os.replace(os.path.join(folder, "new.jsonl.truth.tum"), f"{log}.truth.tum") if logs else None
            log = log if logs else os.path.join(folder, "new.jsonl")
            subprocess.run(["mv", os.path.join(folder, "new.jsonl"), log], check=True) if logs else None
        exit_code = call("slam", log, "--out", out).returncode
        error = call("eval", "--trajectory", f"{out}/trajectory.tum", "--reference", f"{log}.truth.tum", "--json").stdout
        with open(f"{out}/summary.json") as f:
            summary = json.load(f)
        with open(f"{out}/timing.json") as f:
            timing = json.load(f)
        return {**spec, "exit": exit_code, "scans": summary["scans"], "way_m": round(way_of(f"{log}.truth.tum"), 2),
                "ate_m": json.loads(error)["ate_m"]["rmse"] if error else None, "verdict": summary["verdict"],
                "probability": summary["verdict_probability"], "reasons": [r["kind"] for r in summary["reasons"]],
                "cpu_ms": round(timing["cpu_ms_per_scan"] * summary["scans"], 1), "evidence": summary.get("evidence")}


def is_right(row):
    return row["ate_m"] is not None and row["ate_m"] <= max(0.2, 0.01 * row["way_m"])


def is_off(row):
    return row["ate_m"] is None or (row["ate_m"] > 1.0 and row["ate_m"] > 0.01 * row["way_m"])


def run_all(runs, first_seed=1, jobs=1, logs=None, rows_file=None):
    rows = []
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        for row in pool.map(lambda seed: run(seed, logs), range(first_seed, first_seed + runs)):
            rows.append(row)
            if rows_file:
                with open(rows_file, "a") as out:
                    out.write(json.dumps(row) + "\n")
    return rows


def table(rows):
    """Of clean runs, dirty ones and all: how many, and what the verdicts were worth."""
    share = lambda part, whole: f"{sum(part(r) for r in whole)} of {len(whole)}"
    lines = []
    for name, group in (("clean", [r for r in rows if r["clean"]]), ("dirty", [r for r in rows if not r["clean"]]), ("all", rows)):
        good, right, off = [r for r in group if r["verdict"] == "good"], [r for r in group if is_right(r)], [r for r in group if is_off(r)]
        lines.append([name, len(group), len(right), len(off), share(is_right, good), share(lambda r: r["verdict"] == "good", right),
                      share(lambda r: r["verdict"] != "good", off), share(lambda r: r["verdict"] == "failed", off)])
    return ["runs", "number", "right", "off by more than 1 m", "right, of those called good", "called good, of the right", "not called good, of those off",
            "failed, of those off"], lines


def print_table(rows):
    header, lines = table(rows)
    print("| " + " | ".join(header) + " |\n|---|" + "---:|" * (len(header) - 1))
    for line in lines:
        print("| " + " | ".join(map(str, line)) + " |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--first-seed", type=int, default=100001)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--logs")
    parser.add_argument("--rows")
    flags = vars(parser.parse_args())
    flags["rows_file"] = flags.pop("rows")
    print_table(run_all(**flags))


if __name__ == "__main__":
    main()
