"""The methods of the paper beside the default one, on the same two scans."""
import math
import sys

from room import look_around

import phasescan

truth = (0.25, -0.15, math.radians(40))
before, now = (phasescan.Scan(look_around(*pose), range_max=12.0) for pose in ((0, 0, 0), truth))
errors = {}
for method in ("icp", "ndt", "fft", "fft-icp1", "fft-icp2", "global"):
    result = phasescan.match(before, now, method=method)
    errors[method] = math.hypot(result.pose.x - truth[0], result.pose.y - truth[1])
    print(f"{method:<9} off by {errors[method]:.3f} m, usable: {result.usable!s:<5} {result.ms['total']:.2f} ms")
sys.exit(0 if errors["global"] < 0.02 else 1)
