#!/usr/bin/env python3
"""What a match costs from Python, over the same match in C++: two scans of a simulated office, arrays of 360 ranges.

The C++ side is `match_overhead` of the same build (bench/match_overhead.cpp), which reads the scans that this program writes.
Both take turns; the least of many rounds counts, in CPU time.
"""
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np

import phasescan

ROUNDS, MATCHES = 15, 100


def least(work):
    begin = time.process_time()
    work()
    return (time.process_time() - begin) * 1e3 / MATCHES


def main():
    program = pathlib.Path(phasescan.__file__).resolve().parent.parent.parent / "bin" / "match_overhead"
    drive = phasescan.simulate("office", seed=4, duration_s=30.0)
    ranges = np.array([np.nan_to_num(drive[k].scan.ranges) for k in range(0, MATCHES)], np.float32)
    keywords = {"angle_min": drive[0].scan.angle_min, "angle_increment": drive[0].scan.angle_increment, "range_min": drive[0].scan.range_min,
                "range_max": drive[0].scan.range_max}
    reference = ranges[0].copy()
    python = {"match": [], "match_many": []}
    native = {"match": [], "match_many": []}
    with tempfile.TemporaryDirectory() as folder:
        (pathlib.Path(folder) / "scans").write_bytes(np.array([MATCHES, ranges.shape[1]], np.float64).tobytes() + np.array(list(keywords.values())).tobytes()
                                                      + ranges.tobytes())
        for _ in range(ROUNDS):
            python["match"].append(least(lambda: [phasescan.match(reference, scan, **keywords) for scan in ranges]))
            python["match_many"].append(least(lambda: phasescan.match_many(reference, ranges, **keywords)))
            told = subprocess.run([program, pathlib.Path(folder) / "scans"], check=True, capture_output=True, text=True).stdout.split()
            native["match"].append(float(told[0]))
            native["match_many"].append(float(told[1]))
    for name in python:
        here, there = min(python[name]), min(native[name])
        print(f"{name:<12} Python {here:.4f} ms  C++ {there:.4f} ms  over {100 * (here / there - 1):+.1f} %")
    return 0


if __name__ == "__main__":
    sys.exit(main())
