"""Matches two scans of a rectangular room taken 0.3 m and 120 degrees apart, with no first guess."""
import math
import sys

from room import look_around

import phasescan

truth = (0.25, -0.15, math.radians(120))
result = phasescan.match(look_around(), look_around(*truth), range_min=0.15, range_max=12.0)
x, y, theta = result.pose
print(f"x {x:.3f} m, y {y:.3f} m, turned {math.degrees(theta):.2f} deg, usable: {'yes' if result.usable else 'no'}")
right = math.hypot(x - truth[0], y - truth[1]) < 0.02 and abs(theta - truth[2]) < math.radians(0.5)
sys.exit(0 if right and result.usable else 1)
