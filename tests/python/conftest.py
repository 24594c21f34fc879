"""What several tests of the Python module share."""
import math
import os
import pathlib

import numpy as np
import pytest

import phasescan

WALLS = np.array([(-2, -1.5, 3, -1.5), (3, -1.5, 3, 2.5), (3, 2.5, 0, 2.5), (0, 2.5, 0, 1.8), (0, 1.8, -2, 1.8), (-2, 1.8, -2, -1.5)], float)


def look_around(x=0.0, y=0.0, theta=0.0, beams=360, walls=WALLS):
    """Ranges [m] of a lidar at a pose in a room with an alcove, counter-clockwise from x forward."""
    angle = theta + np.arange(beams) * 2 * math.pi / beams
    dx, dy = np.cos(angle)[:, None], np.sin(angle)[:, None]
    ax, ay, bx, by = walls.T
    cross = dx * (by - ay) - dy * (bx - ax)
    with np.errstate(divide="ignore"):
        t = ((ax - x) * (by - ay) - (ay - y) * (bx - ax)) / cross
        s = ((ax - x) * dy - (ay - y) * dx) / cross
    return np.where((t > 0) & (s >= 0) & (s <= 1), t, np.inf).min(axis=1)


@pytest.fixture(scope="session")
def drive():
    """A simulated drive of 20 s through a flat."""
    return phasescan.simulate("flat", seed=3, duration_s=20.0)


@pytest.fixture(scope="session")
def command():
    from phasescan.command import find_command
    return find_command()


@pytest.fixture(scope="session")
def data():
    """Recorded logs; a test that wants them is skipped without."""
    root = pathlib.Path(__file__).resolve().parent.parent.parent
    place = pathlib.Path(os.environ.get("PHASESCAN_DATA", root.parent / "shared" / "data"))
    if not place.is_dir():
        pytest.skip(f"no recorded data at {place}")
    return place
