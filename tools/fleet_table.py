#!/usr/bin/env python3
"""What scripts/fleet_results prints: fleets of simulated logs against their truth.

Two logs of a world belong together where the true ways pass within 2 m of each other; logs of one world hang together through others.
Precision: share of the pairs in one group that are of one world. Recall: share of the logs with such a neighbour that are in a group
with one of their world. Joint maps: ATE of each group's trajectory over all its logs in one frame, against the world's.
"""
import hashlib
import json
import pathlib
import random
import resource
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import threading
import time

import numpy as np

import phasescan
from phasescan.fleet import alike

SEED, SCANS_S, NEAR_M = 5000, 55.0, 2.0


def make_logs(folder, kinds, each):
    folder.mkdir(exist_ok=True)
    for world, kind in enumerate(kinds):
        for k in range(each):
            path = folder / f"{world:03d}-{k}.jsonl"
            if not path.exists():
                phasescan.simulate(f"{kind}:{SEED + world}", seed=1000 * world + k + 7, duration_s=SCANS_S).save(path)


def world_of(name):
    return int(pathlib.PurePath(name).name[:3])


def truth_of(path):
    return np.loadtxt(f"{path}.truth.tum")


def with_neighbour(paths):
    """Of each log whether the true way of another of its world passes within 2 m."""
    ways = [truth_of(p)[::5, 1:3] for p in paths]
    worlds = [world_of(p) for p in paths]
    near = [False] * len(paths)
    for a in range(len(paths)):
        for b in range(a):
            if worlds[a] == worlds[b] and not (near[a] and near[b]):
                if np.linalg.norm(ways[a][:, None] - ways[b][None], axis=2).min() <= NEAR_M:
                    near[a] = near[b] = True
    return near


def run(manifest, out, workers, *more):
    """Runs a fleet. Returns wall time and CPU time of all processes [s]."""
    begin, before = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
    told = subprocess.run([sys.executable, "-m", "phasescan.fleet", "run", manifest, "--out", out, "--workers", str(workers), *more], capture_output=True, text=True)
    if told.returncode:
        sys.exit(told.stderr)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.monotonic() - begin, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def results_digest(out):
    """Of all result files but those with times."""
    total = hashlib.sha256()
    for path in sorted(out.rglob("*")):
        if path.is_file() and path.name != "cost.json":
            total.update(str(path.relative_to(out)).encode() + b"\0" + path.read_bytes())
    return total.hexdigest()[:16]


def groups_table(paths, out):
    groups = json.loads((out / "groups.json").read_text())
    right = pairs = 0
    tied = set()
    for group in groups:
        worlds = [world_of(name) for name in group["logs"]]
        for a in range(len(worlds)):
            for b in range(a):
                pairs += 1
                right += worlds[a] == worlds[b]
                if worlds[a] == worlds[b]:
                    tied.update((group["logs"][a], group["logs"][b]))
    near = with_neighbour(paths)
    asked = [f"logs/{p.name}" for p, n in zip(paths, near) if n]
    found = sum(name in tied for name in asked)
    print(f"| pairs in one group that are of one world | {right} of {pairs} ({100 * right / max(pairs, 1):.2f} %) |")
    print(f"| logs that pass within {NEAR_M:g} m of another of their world: tied to one | {found} of {len(asked)} ({100 * found / max(len(asked), 1):.1f} %) |")
    return groups


def joint_table(folder, out, groups):
    errors, many = [], 0
    for group in (g for g in groups if len(g["logs"]) > 1):
        many += 1
        estimate = np.loadtxt(out / group["map"].replace("map.yaml", "trajectory.tum"))
        summary = json.loads((out / group["map"].replace("map.yaml", "summary.json")).read_text())
        truth = np.concatenate([truth_of(folder / entry["log"]) for entry in summary["inputs"]])
        if len(estimate) != len(truth):
            sys.exit(f"{group['map']}: {len(estimate)} poses of {len(truth)} scans")
        stamps = np.arange(len(truth), dtype=float)  # drives overlap in time: poses pair by their number
        pose = lambda t: np.column_stack([t[:, 1], t[:, 2], 2 * np.arctan2(t[:, 6], t[:, 7])])
        errors.append(phasescan.evaluate((stamps, pose(estimate)), (stamps, pose(truth)))["ate_m"]["rmse"])
    if errors:
        print(f"| ATE of the {many} joint maps: median, 90 %, worst | {np.median(errors):.3f}, {np.quantile(errors, 0.9):.3f}, {max(errors):.3f} m;"
              f" {sum(e > 0.08 for e in errors)} above 0.08 m |")


def stage_costs(out):
    base = sqlite3.connect(out / "fleet.sqlite")
    return base.execute("SELECT sum(cpu_s) FROM timing").fetchone()[0]


def kill_workers(process, times, chance):
    """Kills workers of a cluster at random moments: children of the run's process that are Dask's."""
    killed = 0
    while process.poll() is None and killed < times:
        time.sleep(chance.uniform(1.0, 3.0))
        told = subprocess.run(["pgrep", "-f", "--parent", str(process.pid), "spawn_main"], capture_output=True, text=True).stdout.split()
        if len(told) > 2:
            try:
                subprocess.run(["kill", "-KILL", chance.choice(told)], check=False, capture_output=True)
                killed += 1
            except OSError:
                pass
    return killed


def killed_run(work, manifest, clean_digest_of):
    """6 workers, three of them killed, 5 % of the logs broken: the same results of the others, the broken ones named."""
    chance = random.Random(1)
    out = work / "killed"
    process = subprocess.Popen([sys.executable, "-m", "phasescan.fleet", "run", manifest, "--out", out, "--workers", "6", "--no-times"], stderr=subprocess.PIPE, text=True)
    killed = []
    killer = threading.Thread(target=lambda: killed.append(kill_workers(process, 3, chance)))
    killer.start()
    told = process.communicate()[1]
    killer.join()
    named = sum(line.startswith("phasescan: broken/") for line in told.splitlines())
    same = results_digest(out) == clean_digest_of
    print(f"| 6 workers, {killed[0]} killed, broken logs among the others: named | {named}; results {'the same bytes' if same else 'DIFFER'} as of 2 workers |")


def break_logs(folder, paths):
    """A broken log for each twenty: cut in the first line, other bytes, empty, none there."""
    folder.mkdir(exist_ok=True)
    names = []
    for k in range(max(1, len(paths) // 20)):
        path = folder / f"{k:03d}.jsonl"
        path.write_bytes([b'{"angle_min": ', bytes(range(256)), b"", b""][k % 4])
        if k % 4 == 3:
            path.unlink()
        names.append(f"broken/{k:03d}.jsonl")
    return names


def index_table():
    """Stage 2 against the number of views: descriptors that are drawn around those of simulated places."""
    print("\n| views | index, s | a query, ms | peak of one process, MB |\n|---|---|---|---|")
    for count in (10_000, 100_000, 1_000_000):
        told = subprocess.run([sys.executable, __file__, "--index", str(count)], capture_output=True, text=True, check=True).stdout.split()
        print(f"| {count:,} | {float(told[0]):.1f} | {float(told[1]):.2f} | {float(told[2]):.0f} |", flush=True)


def index_once(count):
    random_numbers = np.random.default_rng(1)
    with tempfile.TemporaryDirectory() as folder:
        place = pathlib.Path(folder)
        numbers, turning = np.empty((count, 160), np.int8), np.empty((count, 160), np.uint8)
        for k in range(0, count, 10_000):  # a hundred views near each of many places
            centre = random_numbers.normal(size=(100, 1, 160))
            block = (centre + 0.4 * random_numbers.normal(size=(100, 100, 160))).reshape(-1, 160)
            numbers[k:k + 10_000] = np.round(200 * block / np.linalg.norm(block, axis=1, keepdims=True))
            turning[k:k + 10_000] = random_numbers.integers(0, 256, size=(10_000, 160))
        begin = time.process_time()
        alike.write_arrays(place, numbers, turning, np.arange(0, count + 1, 50, dtype=np.int64))
        built = time.process_time() - begin
        del numbers, turning
        index = alike.read_index(place)
        begin = time.process_time()
        for log in range(10):
            alike.alike_views(index, log * (count // 500))
        asked = (time.process_time() - begin) / 500 * 1e3
        print(built, asked, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)


def fleet_table(title, work, kinds, each, whole):
    folder = work / "logs"
    make_logs(folder, kinds, each)
    paths = sorted(folder.glob("*.jsonl"))
    (work / "manifest.txt").write_text("logs/*.jsonl\n")
    print(f"\n{title}: {len(paths)} logs of {len(kinds)} worlds\n\n| what | |\n|---|---|", flush=True)
    wall, cpu = run(work / "manifest.txt", work / "two", 2)
    ours = stage_costs(work / "two")
    joint = sum(json.loads(p.read_text())["cpu_s"] for p in (work / "two" / "groups").glob("*/cost.json"))
    base = sqlite3.connect(work / "two" / "fleet.sqlite")
    print(f"| in | {base.execute('SELECT count(*) FROM logs WHERE status != ?', ['broken']).fetchone()[0]} of {len(paths)} |")
    print(f"| wall time with 2 workers; CPU of stage 1, of joint maps, of all else (stage 2, Python, Dask) | {wall:.0f} s; {ours:.0f}, {joint:.0f}, {cpu - ours - joint:.0f} s |")
    groups = groups_table(paths, work / "two")
    joint_table(folder, work / "two", groups)
    if whole:
        same_bytes_table(work, paths)


def same_bytes_table(work, paths):
    """Other numbers of workers, and workers that die, on a part of the logs."""
    part = paths[:: max(1, len(paths) // 60)]
    names = [f"logs/{p.name}" for p in part] + break_logs(work / "broken", part)
    (work / "part.txt").write_text("\n".join(names) + "\n")
    digests, walls = {}, {}
    for workers in (1, 2, 4, 6):
        walls[workers], _ = run(work / "part.txt", work / f"part{workers}", workers, "--no-times")
        digests[workers] = results_digest(work / f"part{workers}")
    same = len(set(digests.values())) == 1
    print(f"| {len(names)} of the logs, {len(names) - len(part)} broken, with 1, 2, 4, 6 workers | {'the same bytes' if same else 'DIFFERENT BYTES'}; "
          + ", ".join(f"{walls[w]:.0f} s" for w in walls) + f"; efficiency 1 to 2: {walls[1] / walls[2] / 2:.2f} |", flush=True)
    killed_run(work, work / "part.txt", digests[2])
    shutil.rmtree(work / "part6")


def main():
    if sys.argv[1] == "--index":
        return index_once(int(sys.argv[2]))
    worlds, each = int(sys.argv[1]), int(sys.argv[2])
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        (work / "small").mkdir()
        (work / "large").mkdir()
        fleet_table("Flats and offices", work / "small", ["flat", "office"] * (worlds // 2), each, True)
        fleet_table("Buildings", work / "large", ["building"] * max(1, worlds // 10), each, False)
    index_table()


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    main()
