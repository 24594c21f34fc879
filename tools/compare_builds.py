#!/usr/bin/env python3
"""Whether two builds of the command give the same bytes: the safety rope of every change that is not meant to change answers.

  tools/compare_builds.py OLD NEW [--quick] [--keep FOLDER]

OLD and NEW are `phasescan` commands. All pairs files and logs of $PHASESCAN_DATA, else ../shared/data, are run through
both, and some simulated ones: answers of `match`, trajectories, graphs and maps of `slam`, with odometry and without. What
OLD answers is kept in FOLDER (out/compare), so that it is run once. Exit 1 where anything differs. --quick: fewer logs.
"""
import argparse
import concurrent.futures
import hashlib
import json
import os
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent.parent
DATA = pathlib.Path(os.environ.get("PHASESCAN_DATA", HERE.parent / "shared/data"))
OUTPUTS = ["trajectory.tum", "graph.g2o", "map.pgm", "map.yaml", "map.png"]
METHODS = ["icp", "ndt", "fft", "fft-icp1", "fft-icp2", "fft-mh"]
# World, sensor and what else is asked of `simulate`: people, other shapes of motion, several sizes of place.
SIMULATED = [("flat:3", "rplidar-a1", []), ("office:5", "ld06", ["--odometry"]), ("hall:2", "urg-04lx", ["--odometry"]),
             ("corridor:4", "ydlidar-x4", [])]


def run(command, *arguments):
    done = subprocess.run([command, *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    return done.returncode, done.stdout


def answers(command, pairs, method):
    """The answers of `match` without what may be named otherwise."""
    code, out = run(command, "match", "--pairs", pairs, "--method", method, "--no-times")
    lines = []
    for line in out.decode().splitlines():
        answer = json.loads(line)
        answer.pop("method", None)
        answer.pop("ms", None)
        lines.append(json.dumps(answer, sort_keys=True))
    return [code, hashlib.sha256("\n".join(lines).encode()).hexdigest()]


def runs(command, log, options, folder):
    """Hashes of what `slam` makes of a log."""
    code, _ = run(command, "slam", log, "--out", folder, "--no-times", *options)
    found = [code]
    for name in OUTPUTS:
        path = folder / name
        found.append(hashlib.sha256(path.read_bytes()).hexdigest() if path.exists() else "")
    return found


def jobs(quick, work, old):
    for path in sorted((DATA / "pairs").glob("*.jsonl.gz")):
        for method in (METHODS if not quick else ["fft-mh"]):
            yield f"{path.name} {method}", lambda command, folder, p=path, m=method: answers(command, p, m)
    logs = sorted((DATA / "carmen").glob("*.log.gz")) + sorted((DATA / "lowcost").glob("*.gz"))
    logs += [DATA / "bags/breezy-exp1.mcap", DATA / "bags/hokuyo-demo.bag"]
    if quick:
        logs = [log for log in logs if "corrected" not in log.name and "16m" not in log.name]
    for world, sensor, more in SIMULATED:
        log = work / f"{world.replace(':', '-')}-{sensor}.jsonl"
        if not log.exists():
            run(old, "simulate", "--world", world, "--sensor", sensor, "--path", "tour", "--speed", 0.4, "--duration", 120,
                "--seed", 11, *more, "--out", log)
        logs.append(log)
    for log in logs:
        if not log.exists():
            continue
        settings = [["--odometry", "auto"], ["--odometry", "none"]]
        if not quick:
            settings.append(["--range-max", "6", "--beam-step", "2"])
        for options in settings:
            yield f"{log.name} {' '.join(options)}", lambda command, folder, g=log, o=options: runs(command, g, o, folder)
    bounded = work / "bounded.yaml"
    bounded.write_text("slam: {bounded_memory: true}\n")
    log = DATA / "carmen/fr079-raw.log.gz"
    if log.exists():
        yield "fr079-raw bounded", lambda command, folder: runs(command, log, ["--config", bounded], folder)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--keep", type=pathlib.Path, default=HERE / "out/compare")
    flags = parser.parse_args()
    flags.keep.mkdir(parents=True, exist_ok=True)
    stamp = hashlib.sha256(pathlib.Path(flags.old).read_bytes()).hexdigest()[:16]
    kept_path = flags.keep / f"{stamp}.json"
    kept = json.loads(kept_path.read_text()) if kept_path.exists() else {}
    listed = list(jobs(flags.quick, flags.keep, flags.old))

    def judge(k):
        name, job = listed[k]
        if name not in kept:
            kept[name] = job(flags.old, flags.keep / f"old-{k}")
        return name, kept[name], job(flags.new, flags.keep / f"new-{k}")

    differ = 0
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        for name, old, new in pool.map(judge, range(len(listed))):
            same = old == new
            differ += not same
            parts = "" if same or len(old) < 3 else ": " + ", ".join(n for n, a, b in zip(["exit", *OUTPUTS], old, new) if a != b)
            print(f"{'same  ' if same else 'DIFFER'} {name}{parts}", flush=True)
    kept_path.write_text(json.dumps(kept))
    print(f"{len(listed) - differ} of {len(listed)} the same")
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
