"""The README's Python: one scan against another; many scans against one that was prepared."""
import math
import sys

import numpy as np
from room import look_around

import phasescan


def where_am_i(before, now):
    match = phasescan.match(before, now, range_min=0.15, range_max=6.0)
    if not match.usable:
        raise RuntimeError(f"lost: {match.reason}")
    return match.pose  # p_before = R(theta) p_now + (x, y)


before = look_around()
x, y, theta = where_am_i(before, look_around(0.2, 0.1, 0.5))
print(f"x {x:.3f} m, y {y:.3f} m, turned {math.degrees(theta):.2f} deg")

# Many scans against one: what is prepared of the reference is prepared once; the rows of an array are scans.
reference = phasescan.Reference(phasescan.Scan(before, range_min=0.15, range_max=6.0))
poses = [(0.05 * k, 0.02 * k, 0.3 * k) for k in range(8)]
results = phasescan.match_many(reference, np.array([look_around(*pose) for pose in poses]), range_min=0.15, range_max=6.0)
print(results)
off = np.abs(results.poses[:, :2] - np.array(poses)[:, :2]).max()
sys.exit(0 if math.hypot(x - 0.2, y - 0.1) < 0.02 and off < 0.02 and results.usable.all() else 1)
