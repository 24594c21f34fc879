#!/usr/bin/env python3
"""Maps that are merged with no guess: four drives of one simulated building, and drives of two buildings. Over seeds and sensors.

usage: merge_table.py [--seeds N] [--first-seed K] [--world WORD] [--sensor WORD] [--jobs N] [--json]
WORD picks by a part of the name. $PHASESCAN names another command than build/release/bin/phasescan.
"""
import argparse
import concurrent.futures
import json
import random
import tempfile

from command import call, markdown

SENSORS = ("rplidar-a1-real", "ld06")
WORLDS = ("flat", "office", "building")
LIMIT_M = 0.05  # ATE over all drives
APART_S = 10000  # between the drives, so that every stamp is one of a kind


def positions(truth):
    return [tuple(map(float, words[1:3])) for words in truth]


def shares_way(truth, first):
    """Whether a tenth of a way lies within a metre of another: else a closed door is between them, and nothing can tie them."""
    places = {(round(x), round(y)) for x, y in positions(first)}
    near = sum(any((round(x) + i, round(y) + k) in places for i in (-1, 0, 1) for k in (-1, 0, 1)) for x, y in positions(truth))
    return near >= 0.1 * len(truth)


def simulate(log, world, sensor, seed, first):
    """A drive from a start of its own in what `first` could reach; its truth."""
    for k in range(20):
        call("simulate", "--world", world, "--sensor", sensor, "--seed", seed + 50 * k, "--out", log)
        with open(f"{log}.truth.tum") as lines:
            truth = [line.split() for line in lines]
        if first is None or shares_way(truth, first):
            return truth
    raise RuntimeError(f"{world}: no start in reach of the first")


def drive(folder, name, world, sensor, seed, after_s, first):
    """One drive from a start of its own: its saved run, its stamps moved, and its truth."""
    log = f"{folder}/{name}.jsonl"
    truth = simulate(f"{log}.raw", world, sensor, seed, first)
    with open(f"{log}.raw") as lines, open(log, "w") as out:
        for line in lines:
            scan = json.loads(line)
            scan["stamp"] = round(scan.get("stamp", 0.0) + after_s, 6)  # the first one stands at 0 and is left out
            out.write(json.dumps(scan) + "\n")
    call("slam", log, "--out", f"{folder}/{name}", "--save", f"{folder}/{name}.state", "--no-times")
    return truth


def tum(truth, after_s):
    return "".join(f"{float(words[0]) + after_s:.6f} {' '.join(words[1:])}\n" for words in truth)


def error_of(folder, truth):
    with open(f"{folder}/truth.tum", "w") as f:
        f.write(truth)
    text = call("eval", "--trajectory", f"{folder}/trajectory.tum", "--reference", f"{folder}/truth.tum", "--json").stdout
    return json.loads(text)["ate_m"]["rmse"] if text else None


def merge(folder, names, out, rng):
    """In an order drawn by chance. Of each name the folder that its drive is in ('' where all are on one map)."""
    states = [f"{folder}/{name}.state" for name in names]
    rng.shuffle(states)
    done = call("merge", *states, "--out", out, "--save", f"{out}.state")
    if done.returncode != 0:
        return None
    with open(f"{out}/summary.json") as f:
        summary = json.load(f)
    return {line["state"][:-len(".state")]: line.get("folder", "") for line in summary["inputs"]}


def run_building(job):
    """Four drives of one building, and two of them with two of the next building."""
    world, sensor, seed = job
    rng = random.Random(seed)
    with tempfile.TemporaryDirectory() as folder:
        truth, first = {}, {}
        for k, name in enumerate("abcdxy"):
            building = seed if name in "abcd" else seed + 1000
            way = drive(folder, name, f"{world}:{building}", sensor, 100 * seed + k, APART_S * (k + 1), first.get(building))
            first.setdefault(building, way)
            truth[name] = tum(way, APART_S * (k + 1))
        one = merge(folder, "abcd", f"{folder}/one", rng)
        two = merge(folder, "abxy", f"{folder}/two", rng)
        row = {"world": world, "sensor": sensor, "seed": seed, "one": one, "two": two, "ate_one_m": None, "ate_two_m": []}
        if one and not any(one.values()):
            row["ate_one_m"] = error_of(f"{folder}/one", "".join(truth[n] for n in "abcd"))
        if two:
            for part in sorted(set(filter(None, two.values()))):
                row["ate_two_m"].append(error_of(f"{folder}/two/{part}", "".join(truth[n] for n in sorted(two) if two[n] == part)))
        return row


def run(seeds=10, first_seed=1, world="", sensor="", jobs=2):
    work = [(w, s, seed) for w in WORLDS if world in w for s in SENSORS if s == sensor or not sensor
            for seed in range(first_seed, first_seed + seeds)]
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        return list(pool.map(run_building, work))


def tied_wrongly(row):
    """Drives of two buildings on one map."""
    two = row["two"] or {}
    return bool(two) and any(two[p] == two[q] for p in "ab" for q in "xy")


def table(rows):
    groups = {}
    for row in rows:
        groups.setdefault((row["world"], row["sensor"]), []).append(row)
    lines = []
    for (world, sensor), runs in groups.items():
        errors = [r["ate_one_m"] for r in runs if r["ate_one_m"] is not None]
        good = sum(e <= LIMIT_M for e in errors)
        apart = sum(bool(r["two"]) and len(set(r["two"].values())) == 2 and not tied_wrongly(r) for r in runs)
        within = [e for r in runs for e in r["ate_two_m"] if e is not None]
        lines.append([world, sensor, f"{good} of {len(runs)}", f"{max(errors):.3f}" if errors else "-",
                      ", ".join(str(r["seed"]) for r in runs if r["ate_one_m"] is None), f"{apart} of {len(runs)}",
                      str(sum(tied_wrongly(r) for r in runs)), f"{max(within):.3f}" if within else "-"])
    return ["world", "sensor", f"one map, ATE <= {LIMIT_M} m", "worst ATE [m]", "seeds in pieces", "two buildings: two maps", "tied wrongly",
            "worst ATE of a map [m]"], lines


def print_table(rows):
    header, lines = table(rows)
    print(markdown(header, lines, 2), end="")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("seeds", "first-seed", "jobs"):
        parser.add_argument(f"--{name}", type=int, default={"seeds": 10, "first-seed": 1, "jobs": 2}[name])
    for name in ("world", "sensor"):
        parser.add_argument(f"--{name}", default="", metavar="WORD")
    parser.add_argument("--json", action="store_true")
    flags = parser.parse_args()
    rows = run(flags.seeds, flags.first_seed, flags.world, flags.sensor, flags.jobs)
    if flags.json:
        print(json.dumps(rows, indent=1))
    else:
        print_table(rows)


if __name__ == "__main__":
    main()
