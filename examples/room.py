"""A room with an alcove, as the examples see it."""
import numpy as np

WALLS = np.array([(-2, -1.5, 3, -1.5), (3, -1.5, 3, 2.5), (3, 2.5, 0, 2.5), (0, 2.5, 0, 1.8), (0, 1.8, -2, 1.8), (-2, 1.8, -2, -1.5)], float)


def look_around(x=0.0, y=0.0, theta=0.0, beams=360):
    """Ranges [m] that a lidar at a pose gives, counter-clockwise from x forward."""
    angle = theta + np.arange(beams) * 2 * np.pi / beams
    dx, dy = np.cos(angle)[:, None], np.sin(angle)[:, None]
    ax, ay, bx, by = WALLS.T
    cross = dx * (by - ay) - dy * (bx - ax)
    with np.errstate(divide="ignore"):
        t = ((ax - x) * (by - ay) - (ay - y) * (bx - ax)) / cross
        s = ((ax - x) * dy - (ay - y) * dx) / cross
    return np.where((t > 0) & (s >= 0) & (s <= 1), t, np.inf).min(axis=1)
