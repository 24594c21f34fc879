"""Trajectories in TUM format: time x y z qx qy qz qw."""
import math


def read_tum(path):
    """(time, (x, y, theta)) of each line."""
    rows = ([float(w) for w in line.split()] for line in open(path))
    return [(r[0], (r[1], r[2], 2 * math.atan2(r[6], r[7]))) for r in rows]
