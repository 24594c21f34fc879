"""Reads a log of any readable format, and says what is in it and what is wrong with it: LOG."""
import sys

import numpy as np

import phasescan

log = phasescan.open_log(sys.argv[1], range_max=20.0)
stamps, hits, wheels = [], 0, 0
for entry in log:
    stamps.append(entry.stamp)
    hits += entry.scan.hit_count
    wheels += entry.odometry is not None
print(f"{log.format}: {len(stamps)} scans, {hits} beams with a range, wheel odometry with {wheels} of them")
if len(stamps) > 1:
    print(f"{stamps[-1] - stamps[0]:.1f} s, {1 / np.median(np.diff(stamps)):.1f} scans a second")
for kind, text in log.damages + log.remarks:
    print(f"{kind}: {text}")
sys.exit(0 if stamps else 1)
