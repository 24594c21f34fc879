"""Scans of a format of your own: here a line `seconds range range ...` in millimetres, clockwise, 0 for no return."""
import io
import math
import sys

import numpy as np
from room import look_around

import phasescan


def read_own(lines):
    for number, line in enumerate(lines, 1):
        try:
            stamp, *millimetres = map(float, line.split())
        except ValueError:
            raise phasescan.InputError(f"line {number}: expected numbers") from None
        n = len(millimetres)
        yield phasescan.Scan(np.array(millimetres) / 1000, angle_increment=-2 * math.pi / n, range_min=0.15, range_max=12.0, stamp=stamp)


def write_own(poses):
    for k, pose in enumerate(poses):
        ranges = np.roll(look_around(*pose)[::-1], 1)  # clockwise from x forward
        yield f"{0.2 * k} " + " ".join(f"{1000 * r:.0f}" for r in ranges)


poses = [(0.03 * k, 0.01 * k, 0.02 * k) for k in range(20)]
odometry = phasescan.Odometry()
for scan in read_own(io.StringIO("\n".join(write_own(poses)))):
    update = odometry.add(scan)
print(update)
x, y, theta = update.pose
sys.exit(0 if math.hypot(x - poses[-1][0], y - poses[-1][1]) < 0.02 else 1)
