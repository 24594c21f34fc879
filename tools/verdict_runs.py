#!/usr/bin/env python3
"""What the verdict of a run is worth: simulated logs, half of them clean and half dirty, each run through slam and compared with its truth.

usage: verdict_runs.py [--runs N] [--first-seed K] [--variants N] [--sparse] [--jobs N] [--logs FOLDER] [--rows FILE]
A log follows from its seed alone: sensor, world, way, wheels, and for odd seeds what is wrong with it (KINDS). --logs keeps them; those that are
there already are used. --variants: of each log so many more with other dirt, half of them without its wheels: runs to fit constants on, most of
them hard. --sparse: logs of few scans or few beams instead, most of them clean otherwise. --rows: a line of JSON per run, with the evidence that the verdict rests on; runs that have one are not made again. $PHASESCAN names another command than
build/release/bin/phasescan.
"""
import argparse
import concurrent.futures
import json
import math
import os
import pathlib
import random
import shutil
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(HERE / "tools"))
import dirty_logs  # noqa: E402
import repeating_worlds  # noqa: E402
from command import call, markdown  # noqa: E402

SENSORS = {"rplidar-a1": 5.5, "rplidar-a1-real": 5.5, "ydlidar-x4": 7.0, "ydlidar-x4-real": 7.0, "ld06": 10.0, "ld06-real": 10.0,
           "rplidar-c1": 10.0, "rplidar-c1-real": 10.0}  # turns a second
SPARSE_SENSORS = {"urg-04lx": 10.0, "urg-04lx-real": 10.0, "ydlidar-x4-real": 7.0, "rplidar-a1-real": 5.5, "ld06-real": 10.0, "hall-30m": 10.0}
FIRST_TEST_SEED = 202427  # no constant is fitted on runs from here on, nor is any of them looked at when features are chosen
WORLDS = {"flat": 4, "office": 3, "building": 2, "corridor": 1, "hall": 1}  # by share


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


def low_rate(scans, chance):
    """One scan in 3 to 10 is kept: a log that was thinned out, or a computer that is far too slow."""
    scans[:] = scans[::chance.randint(3, 10)]


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


def every_nth_scan(scans, chance):
    """A log that was thinned out: one scan in 2 to 10 is kept."""
    scans[:] = scans[::chance.randint(2, 10)]


def by_way(scans, chance):
    """A log of a mapping program: a scan at every 0.3 to 0.6 m, and where the robot turned by 0.3 to 0.6 rad."""
    far, turn, kept, last = chance.uniform(0.3, 0.6), chance.uniform(0.3, 0.6), [], None
    for s in scans:
        x, y, theta = s["truth"]
        if last is None or math.hypot(x - last[0], y - last[1]) >= far or abs(math.remainder(theta - last[2], math.tau)) >= turn:
            kept.append(s)
            last = (x, y, theta)
    scans[:] = kept


def few_beams(scans, chance):
    """One beam in 2 to 4 is left: 90 to 250 a scan."""
    keep = chance.randint(2, 4)
    for s in scans:
        s["ranges"] = s["ranges"][::keep]
        s["angle_increment"] *= keep
        if "time_increment" in s:
            s["time_increment"] *= keep


def half_a_view(scans, chance):
    """180 degrees in the middle of the beams."""
    for s in scans:
        kept = min(len(s["ranges"]), round(math.pi / abs(s["angle_increment"])))
        first = (len(s["ranges"]) - kept) // 2
        s["ranges"] = s["ranges"][first:first + kept]
        s["angle_min"] += first * s["angle_increment"]


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
        "bursts lost": bursts_lost, "long gaps": long_gaps, "low rate": low_rate, "sensor covered": covered, "noisy": noisy, "short range": short_range,
        "wheels slip": wheels_slip}
SPARSE = {"every nth scan": every_nth_scan, "by way": by_way, "few beams": few_beams, "half a view": half_a_view}


KINDS = {"clean": "no dirt", "long": "no dirt, 2,000 to 6,000 scans of a building or an office", "repeats": "places that look alike, half of them also dirty",
         "dirt": "one kind of dirt", "several": "two or three kinds of dirt at once", "bare": "a corridor or a hall without wheels, scans lost or short-sighted",
         "rough": "a fast robot without wheels, two or three of: scans lost, low rate, short-sighted, noisy",
         "sparse": "few scans (every second to tenth, or one at every 0.3 to 0.6 m), few beams, half a view; no other dirt",
         "sparse dirty": "the same with one or two kinds of dirt, some in places that look alike or of a fast robot"}
BARE = ["bursts lost", "long gaps", "sensor covered", "short range", "1 % packets lost", "noisy", "low rate"]
ROUGH = ["bursts lost", "long gaps", "low rate", "sensor covered", "short range", "noisy"]


def spec_of(seed):
    """What a seed stands for."""
    chance = random.Random(7919 * seed + 17)
    spec = {"seed": seed, "clean": seed % 2 == 0, "kind": "clean", "sensor": chance.choice(list(SENSORS)), "dirt": [],
            "world": chance.choices(list(WORLDS), list(WORLDS.values()))[0], "wheels": chance.random() < 0.5,
            "speed": chance.choice((0.3, 0.5, 0.8)), "turn_rate": chance.choice((45, 90)), "people": chance.choice((0, 0, 0, 1, 3)),
            "scans": int(200 * 4 ** chance.random())}
    if spec["clean"]:
        if chance.random() < 0.05:
            spec.update(kind="long", world=chance.choice(("building", "office")), speed=0.8, scans=int(2000 * 3 ** chance.random()))
        return spec
    spec["kind"] = kind = chance.choice(["repeats", "repeats", "bare", "several", "rough", "dirt", "dirt"])
    if kind == "repeats":
        spec.update(world=chance.choice(list(repeating_worlds.KINDS)), speed=0.8, scans=chance.randint(400, 900))
        if chance.random() < 0.3:
            spec.update(wheels=False, dirt=chance.sample(ROUGH, chance.randint(1, 2)))
            return spec
    if kind == "bare":
        spec.update(world=chance.choice(("corridor", "corridor", "hall")), wheels=False, dirt=[chance.choice(BARE)])
    if kind == "rough":
        spec.update(wheels=False, speed=chance.choice((0.8, 1.2, 1.5)), turn_rate=chance.choice((90, 180)), people=chance.choice((0, 1, 3)),
                    dirt=chance.sample(ROUGH, chance.randint(2, 3)))
    if kind in ("dirt", "several") or (kind == "repeats" and chance.random() < 0.3):
        kinds = [k for k in DIRT if spec["wheels"] or k != "wheels slip"]
        spec["dirt"] = ["wheels slip"] if spec["wheels"] and chance.random() < 0.25 else [chance.choice(kinds)]
        if kind == "several":
            spec["dirt"] += chance.sample([k for k in kinds if k not in spec["dirt"]], chance.randint(1, 2))
    return spec


def variant_of(spec, variant):
    """The same log with other dirt. Variant 0: as it is."""
    if variant == 0:
        return spec
    chance = random.Random(31 * spec["seed"] + variant)
    return {**spec, "variant": variant, "clean": False, "kind": "repeats" if spec["kind"] == "repeats" else "rough",
            "dirt": chance.sample(ROUGH if chance.random() < 0.6 else list(DIRT), chance.randint(1, 3)),
            "wheels": spec["wheels"] and chance.random() < 0.4}


def sparse_spec_of(seed):
    """What a seed stands for among logs of few scans, or of few beams: every second to tenth scan, one at every 0.3 to 0.6 m, half a view, short sight.
    Three in ten have dirt besides, or are of a place that repeats or of a fast robot: maps that may well be wrong."""
    chance = random.Random(6007 * seed + 29)
    spec = {"seed": seed, "clean": False, "kind": "sparse", "sensor": chance.choice(list(SPARSE_SENSORS)), "dirt": [],
            "world": chance.choices(list(WORLDS), list(WORLDS.values()))[0], "wheels": chance.random() < 0.4, "speed": chance.choice((0.3, 0.5, 0.8)),
            "turn_rate": chance.choice((45, 90)), "people": chance.choice((0, 0, 0, 1, 3)), "scans": int(200 * 4 ** chance.random())}
    beams = chance.choice(([], [], ["few beams"], ["half a view"], ["half a view", "few beams"]))
    if chance.random() < 0.3:
        rough = chance.random()
        if rough < 0.4:
            spec.update(world=chance.choice(list(repeating_worlds.KINDS)), speed=0.8)
        elif rough < 0.7:
            spec.update(speed=chance.choice((1.2, 1.5)), turn_rate=180)
        spec.update(kind="sparse dirty", dirt=chance.sample([k for k in ROUGH if k != "low rate"], chance.randint(1, 2)))
    thin = chance.choice(("every nth scan", "every nth scan", "by way", "by way", "all scans"))
    if thin != "all scans":
        spec["scans"] = int(1.5 * spec["scans"])
    spec["dirt"] += beams + ([thin] if thin != "all scans" else [])
    return spec


def simulate(spec, log):
    """The log without dirt, and its truth."""
    seed, world, way = spec["seed"], f"{spec['world']}:{spec['seed']}", []
    if spec["world"] in repeating_worlds.KINDS:
        world, path = f"{log}.world.yaml", f"{log}.path.yaml"
        repeating_worlds.make(spec["world"], seed, world, path)
        way = ["--path", path]
    call("simulate", "--world", world, *way, "--sensor", spec["sensor"], "--seed", seed, "--speed", spec["speed"], "--turn-rate", spec["turn_rate"],
         "--people", spec["people"], "--duration", round(spec["scans"] / {**SENSORS, **SPARSE_SENSORS}[spec["sensor"]], 1), "--out", log,
         *(["--odometry"] if spec["wheels"] else []))


def soil(spec, clean, log):
    with open(clean) as f:
        scans = [json.loads(line) for line in f]
    if not spec["wheels"]:
        for s in scans:
            s.pop("odometry", None)
    chance = random.Random(spec["seed"] + 1000003 * spec.get("variant", 0))
    with open(f"{clean}.truth.tum") as f:
        for s, line in zip(scans, f):
            t = list(map(float, line.split()))
            s["truth"] = (t[1], t[2], 2.0 * math.atan2(t[6], t[7]))
    for kind in spec["dirt"]:
        {**DIRT, **SPARSE}[kind](scans, chance)
    for s in scans:
        s.pop("truth")
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


def judge(spec, log, truth, out):
    """One run: what it was, what slam says of it, how far it is off."""
    exit_code = call("slam", log, "--out", out).returncode
    error = call("eval", "--trajectory", f"{out}/trajectory.tum", "--reference", truth, "--json").stdout
    with open(f"{out}/summary.json") as f:
        summary = json.load(f)
    with open(f"{out}/timing.json") as f:
        timing = json.load(f)
    return {**spec, "exit": exit_code, "scans": summary["scans"], "way_m": round(way_of(truth), 2),
            "ate_m": json.loads(error)["ate_m"]["rmse"] if error else None, "verdict": summary["verdict"],
            "probability": summary["verdict_probability"], "reasons": [r["kind"] for r in summary["reasons"]],
            "cpu_ms": round(timing["cpu_ms_per_scan"] * summary["scans"], 1), "evidence": summary.get("evidence")}


def run(seed, logs=None, variants=0, sparse=False):
    """The runs of a seed."""
    spec, rows = (sparse_spec_of if sparse else spec_of)(seed), []
    with tempfile.TemporaryDirectory() as folder:
        clean = os.path.join(folder, "clean.jsonl")
        for variant in range(1 + variants):
            one = variant_of(spec, variant)
            log = os.path.join(logs or folder, f"{seed}.{variant}.jsonl")
            if not os.path.exists(log):
                if not os.path.exists(clean):
                    simulate(spec, clean)
                shutil.copy(f"{clean}.truth.tum", f"{log}.truth.tum")
                soil(one, clean, log)
            rows.append(judge(one, log, f"{log}.truth.tum", os.path.join(folder, f"out{variant}")))
    return rows


def is_right(row):
    return row["ate_m"] is not None and row["ate_m"] <= max(0.2, 0.01 * row["way_m"])


def is_off(row):
    return row["ate_m"] is None or (row["ate_m"] > 1.0 and row["ate_m"] > 0.01 * row["way_m"])


def run_all(runs, first_seed=1, jobs=1, logs=None, rows_file=None, variants=0, sparse=False):
    """In the order of the seeds."""
    rows = []
    if rows_file and os.path.exists(rows_file):
        with open(rows_file) as lines:
            rows = [json.loads(line) for line in lines]
    seeds = [s for s in range(first_seed, first_seed + runs) if s not in {r["seed"] for r in rows}]
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        for more in pool.map(lambda seed: run(seed, logs, variants, sparse), seeds):
            rows += more
            if rows_file:
                with open(rows_file, "a") as out:
                    out.writelines(json.dumps(row) + "\n" for row in more)
    return rows


def table(rows):
    """Of runs by kind, of the clean, the dirty and of all that are not sparse: how many, and what the verdicts were worth."""
    share = lambda part, whole: f"{sum(part(r) for r in whole)} of {len(whole)}"
    groups = [(f"{kind}: {what}", [r for r in rows if r["kind"] == kind]) for kind, what in KINDS.items()]
    mixed = [r for r in rows if not r["kind"].startswith("sparse")]
    groups += [("all clean", [r for r in mixed if r["clean"]]), ("all dirty", [r for r in mixed if not r["clean"]]), ("all but sparse", mixed)]
    groups = [(name, group) for name, group in groups if group]
    lines = []
    for name, group in groups:
        good, right, off = [r for r in group if r["verdict"] == "good"], [r for r in group if is_right(r)], [r for r in group if is_off(r)]
        lines.append([name, len(group), len(right), len(off), share(is_right, good), share(lambda r: r["verdict"] == "good", right),
                      share(lambda r: r["verdict"] != "good", off), share(lambda r: r["verdict"] == "failed", off)])
    return ["runs", "number", "right", "off by more than 1 m", "right, of those called good", "called good, of the right", "not called good, of those off",
            "failed, of those off"], lines


def print_table(rows):
    header, lines = table(rows)
    print(markdown(header, lines, 1), end="")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--first-seed", type=int, default=FIRST_TEST_SEED)
    parser.add_argument("--variants", type=int, default=0)
    parser.add_argument("--sparse", action="store_true")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--logs")
    parser.add_argument("--rows")
    flags = vars(parser.parse_args())
    flags["rows_file"] = flags.pop("rows")
    print_table(run_all(**flags))


if __name__ == "__main__":
    main()
