#!/usr/bin/env python3
"""What `phasescan live --ros2` costs beside a host that runs Fast DDS: from saying a scan to hearing its map -> odom, 10 scans a second of
720 beams, and the share of a core. Prints a row.

Usage: print_fast_peer.py PHASESCAN FAST_PEER [SECONDS]
"""
import pathlib
import sys
import tempfile
import time

from fast_host import Hosts, enter_namespace, fail, simulate, transforms


def main():
    enter_namespace()
    seconds = int(sys.argv[3]) if len(sys.argv) > 3 else 120
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        hosts = Hosts(*sys.argv[1:3], folder)
        log = simulate(sys.argv[1], folder, beams=720, seconds=seconds)
        began = time.time()
        live = hosts.live("--port", "ros2:/scan", "--ros2")
        messages = hosts.peer("--seconds", seconds + 3, "--scans", log)
        lines, _ = live.end()
        wall = time.time() - began
        latency = sorted(t["latency_ms"] for t in transforms(messages, "odom") if "latency_ms" in t)
        if len(latency) < 9 * seconds:
            fail(f"{len(latency)} transforms of {10 * seconds} scans came")
        print("| beams | scans | used | map -> odom heard: p50, p99, most [ms] | CPU of live, of one core [%] |")
        print("|---:|---:|---:|---:|---:|")
        print(f"| 720 | {10 * seconds} | {len(lines)} | {latency[len(latency) // 2]:.1f}, {latency[int(0.99 * len(latency))]:.1f}, {latency[-1]:.1f} "
              f"| {100 * live.cpu_s / wall:.1f} |")


if __name__ == "__main__":
    main()
