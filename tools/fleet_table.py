#!/usr/bin/env python3
"""What scripts/fleet_results prints: fleets of simulated logs against their truth, recorded ones, workers that die, and a growing index.

Each part is a table of its own: FOLDER/fleet-PART.md. What is counted how: tools/fleet_truth.py.
"""
import argparse
import json
import os
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

from fleet_truth import group_lines, groups_of, joint_lines, make_logs, results_digest
from phasescan.fleet import alike

PARTS = ("simulated", "buildings", "workers", "recorded", "index")
RECORDED = ("carmen/intel-raw.log.gz", "carmen/intel-corrected.log.gz", "carmen/fr079-raw.log.gz", "carmen/freiburg-079-corrected.log.gz",
            "lowcost/rplidar-a1-14m.log.gz", "lowcost/rplidar-a1-16m.log.gz")


def fleet(manifest, out, workers, *more):
    command = [sys.executable, "-m", "phasescan.fleet", "run", str(manifest), "--out", str(out), "--workers", str(workers), *more]
    return subprocess.Popen(command, stderr=subprocess.PIPE, text=True)


def idle_s():
    """Of all cores since the machine began."""
    words = pathlib.Path("/proc/stat").read_text().split("\n", 1)[0].split()
    return (int(words[4]) + int(words[5])) / os.sysconf("SC_CLK_TCK")


def run(manifest, out, workers, *more):
    """Runs a fleet. Returns its cost.json with CPU time of all its processes, and how long cores had nothing to do."""
    before, idle = resource.getrusage(resource.RUSAGE_CHILDREN), idle_s()
    process = fleet(manifest, out, workers, *more)
    told = process.communicate()[1]
    if process.returncode:
        sys.exit(told)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cost = json.loads((out / "cost.json").read_text())
    cost["all_cpu_s"] = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    cost["idle_s"] = idle_s() - idle
    return cost


def cost_lines(cost):
    cpu = {name: cost["cpu_s"].get(name, 0.0) for name in ("maps", "index", "places", "ties", "joint maps")}
    ours = sum(cpu.values())
    second = cpu["index"] + cpu["places"] + cpu["ties"]
    yield f"| CPU of stage 1, stage 2, stage 3 | {cpu['maps']:.0f}, {second:.0f}, {cpu['joint maps']:.0f} s |"
    yield f"| stage 2 against stage 1 | {second / cpu['maps']:.2f} |"
    yield (f"| of the CPU time of all its processes, in our code (the rest: Dask, starting Python) | {100 * ours / cost['all_cpu_s']:.1f} % of {cost['all_cpu_s']:.0f} s |")
    yield (f"| of the time of both cores that other programs left, in our code | {100 * ours / (cost['all_cpu_s'] + cost['idle_s']):.1f} % |"
           f"\n| wall time with {cost['workers']} workers, {os.cpu_count()} cores, other programs beside them or not | {cost['wall_s']:.0f} s |")


def simulated(work, kinds, each):
    paths = make_logs(work / "logs", kinds, each)
    (work / "manifest.txt").write_text("logs/*.jsonl\n")
    cost = run(work / "manifest.txt", work / "out", 2)
    rows = sqlite3.connect(work / "out" / "fleet.sqlite").execute("SELECT status, count(*) FROM logs GROUP BY status ORDER BY status").fetchall()
    yield f"| {len(paths)} logs of {len(kinds)} worlds | |\n|---|---|"
    yield f"| logs by status | {', '.join(f'{status}: {count}' for status, count in rows)} |"
    groups = groups_of(work / "out")
    yield f"| groups of more than one log | {sum(len(names) > 1 for names, _ in groups)} |"
    yield from group_lines(paths, groups)
    yield from joint_lines(work / "logs", work / "out", groups)
    yield from cost_lines(cost)


def kill_workers(process, times, chance, killed):
    """Kills workers of a cluster at random moments: children of the run's process that are Dask's."""
    while process.poll() is None and len(killed) < times:
        time.sleep(chance.uniform(1.0, 3.0))
        told = subprocess.run(["pgrep", "-f", "--parent", str(process.pid), "spawn_main"], capture_output=True, text=True).stdout.split()
        if len(told) > 2:
            worker = chance.choice(told)
            if subprocess.run(["kill", "-KILL", worker], check=False, capture_output=True).returncode == 0:
                killed.append(worker)


def break_logs(folder, count):
    """Broken logs: cut in the first line, other bytes, empty, none there."""
    folder.mkdir(exist_ok=True)
    names = []
    for k in range(count):
        path = folder / f"{k:03d}.jsonl"
        path.write_bytes([b'{"angle_min": ', bytes(range(256)), b"", b""][k % 4])
        if k % 4 == 3:
            path.unlink()
        names.append(f"broken/{k:03d}.jsonl")
    return names


def busy_share(cost):
    """Of the time of all workers, from the beginning of a run to its end, what they had a task for."""
    return cost["busy_s"] / cost["wall_s"] / cost["workers"]


def efficiency(one, other):
    """Of workers against one, where each has a core: the same work, and the share of their time that goes into it."""
    return sum(one["cpu_s"].values()) / busy_share(one) * busy_share(other) / sum(other["cpu_s"].values())


def workers(work, kinds, each):
    """1, 2, 4, 6 workers, then six of which three are killed: the same bytes, broken logs among the others."""
    paths = make_logs(work / "logs", kinds, each)
    broken = break_logs(work / "broken", max(1, len(paths) // 19))
    (work / "manifest.txt").write_text("\n".join([f"logs/{p.name}" for p in paths] + broken) + "\n")
    yield f"| {len(paths)} logs and {len(broken)} broken ones | wall, s | CPU in our code, s | workers had a task | results |\n|---|---|---|---|---|"
    digests, costs = {}, {}
    for count in (1, 2, 4, 6):
        costs[count] = run(work / "manifest.txt", work / f"out{count}", count, "--no-times")
        digests[count] = results_digest(work / f"out{count}")
        same = "" if count == 1 else "the same bytes" if digests[count] == digests[1] else "OTHER BYTES"
        yield f"| {count} worker{'s' if count > 1 else ''} | {costs[count]['wall_s']:.1f} | {sum(costs[count]['cpu_s'].values()):.1f} | {100 * busy_share(costs[count]):.1f} % | {same} |"
        if count != 1:
            shutil.rmtree(work / f"out{count}")
    killed = []
    begin = time.monotonic()
    process = fleet(work / "manifest.txt", work / "killed", 6, "--no-times")
    killer = threading.Thread(target=kill_workers, args=(process, 3, random.Random(1), killed))
    killer.start()
    told = process.communicate()[1]
    killer.join()
    named = sum(line.startswith("phasescan: broken/") for line in told.splitlines())
    same = process.returncode == 0 and results_digest(work / "killed") == digests[1]
    yield f"| 6 workers, {len(killed)} of them killed | {time.monotonic() - begin:.1f} | | | {'the same bytes' if same else 'OTHER BYTES'}; {named} of {len(broken)} broken logs named |"
    yield (f"\nEfficiency of 2 workers against 1: {costs[1]['wall_s'] / costs[2]['wall_s'] / 2:.2f} by wall time, which other programs change; "
           f"{efficiency(costs[1], costs[2]):.2f} by CPU time and by how long workers had a task.")


def recorded(work, data):
    there = [data / name for name in RECORDED if (data / name).exists()]
    if len(there) < len(RECORDED):
        return
    (work / "manifest.txt").write_text("".join(f"{path}\n" for path in there))
    run(work / "manifest.txt", work / "out", 2)
    base = sqlite3.connect(work / "out" / "fleet.sqlite")
    yield "| log | scans | status | group |\n|---|---|---|---|"
    for log, scans, status, group in base.execute('SELECT log, scans, status, "group" FROM logs ORDER BY number'):
        yield f"| {pathlib.PurePath(log).name} | {scans} | {status} | {group} |"


def index():
    """Stage 2 against the number of views: descriptors that are drawn around those of simulated places."""
    yield "| views | index, s | a query, ms | peak of one process, MB |\n|---|---|---|---|"
    for count in (10_000, 100_000, 1_000_000):
        told = subprocess.run([sys.executable, __file__, "--views", str(count)], capture_output=True, text=True, check=True).stdout.split()
        yield f"| {count:,} | {float(told[0]):.1f} | {float(told[1]):.2f} | {float(told[2]):.0f} |"


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
        made = alike.read_index(place)
        begin = time.process_time()
        for log in range(10):
            alike.alike_views(made, log * (count // 500))
        asked = (time.process_time() - begin) / 500 * 1e3
        print(built, asked, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)


def lines_of(part, flags, work):
    kinds = ["flat", "office"] * (flags.worlds // 2)
    if part == "simulated":
        return simulated(work, kinds, flags.each)
    if part == "buildings":
        return simulated(work, ["building"] * max(1, flags.worlds // 10), flags.each)
    if part == "workers":
        return workers(work, kinds[:max(2, flags.worlds // 10)], flags.each)
    return recorded(work, pathlib.Path(flags.data).resolve()) if part == "recorded" else index()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"of {', '.join(PARTS)}; all unless given")
    parser.add_argument("--worlds", type=int, default=100)
    parser.add_argument("--each", type=int, default=10, help="logs of a world")
    parser.add_argument("--data", default=os.environ.get("PHASESCAN_DATA", "../shared/data"))
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/bench"))
    parser.add_argument("--keep", type=pathlib.Path, help="a folder for logs and results; else they are removed")
    parser.add_argument("--views", type=int, help=argparse.SUPPRESS)
    flags = parser.parse_args()
    if flags.views:
        return index_once(flags.views)
    if unknown := set(flags.parts) - set(PARTS):
        parser.error(f"{', '.join(sorted(unknown))}: expected of {', '.join(PARTS)}")
    flags.out.mkdir(parents=True, exist_ok=True)
    for part in flags.parts or PARTS:
        with tempfile.TemporaryDirectory() as folder:
            work = (flags.keep or pathlib.Path(folder)) / part
            work.mkdir(parents=True, exist_ok=True)
            lines = []
            for line in lines_of(part, flags, work):
                print(line, flush=True)
                lines.append(line)
        if lines:
            (flags.out / f"fleet-{part}.md").write_text("\n".join(lines) + "\n")
        print(flush=True)


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    main()
