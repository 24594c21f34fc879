import math

import numpy as np
import pytest

import phasescan


@pytest.fixture(scope="module")
def known(drive):
    """The map of a drive, and where its frame stands in the world."""
    slam = phasescan.Slam()
    for entry in drive:
        slam.add(entry)
    state = slam.checkpoint()
    return slam.finish().map, state, phasescan.Pose2(*drive.truth[0])


def off(known, update, truth):
    pose = known[2] * update.pose
    return math.hypot(pose.x - truth[0], pose.y - truth[1])


def test_a_robot_is_found_and_followed(drive, known):
    localizer = phasescan.Localizer(phasescan.LocalizationMap.from_grid(known[0]))
    updates = [localizer.add(drive[k]) for k in range(40, 80)]
    found = [k for k, u in enumerate(updates) if u.usable]
    assert len(found) > 20 and updates[-1].status == "ok" and bool(updates[-1])
    assert all(off(known, updates[k], drive.truth[40 + k]) < 0.1 for k in found)
    last = updates[-1]
    assert last.covariance.shape == (3, 3) and last.hypotheses[0].pose == last.hypotheses[0].T_map_base == last.T_map_base == last.pose
    assert 0.9 < last.confidence <= 1 and "ok at" in repr(last) and last.scan == 39
    localizer.initialize_globally()
    assert off(known, localizer.add(drive[80]), drive.truth[80]) < 0.2


def test_a_pose_may_be_given(drive, known):
    localizer = phasescan.Localizer(phasescan.LocalizationMap.from_grid(known[0]), min_confidence=0.5)
    assert localizer.options["localize"]["min_confidence"] == 0.5
    where = known[2].inverse() * phasescan.Pose2(*drive.truth[30])
    localizer.initialize(where, np.diag([0.01, 0.01, 0.001]))
    assert off(known, localizer.add(drive[30]), drive.truth[30]) < 0.1
    with pytest.raises(ValueError, match="pose: "):
        localizer.initialize((1, 2), np.eye(3))


def test_one_scan_by_itself_and_a_map_of_a_state(drive, known):
    place = phasescan.LocalizationMap.from_state(known[1])
    assert place.free_area_m2 > 5 and place.views > 10 and place.memory_bytes > 1000 and "m2 free" in repr(place)
    found = [phasescan.locate(place, drive[k]) for k in range(20, 100, 20)]
    right = [off(known, u, drive.truth[k]) < 0.1 for u, k in zip(found, range(20, 100, 20)) if u.status == "ok"]
    assert right and all(right)


def test_options_and_maps_that_are_none(known):
    with pytest.raises(phasescan.OptionError, match="did you mean 'min_confidence'"):
        phasescan.Localizer(phasescan.LocalizationMap.from_grid(known[0]), min_confidance=0.5)
    with pytest.raises(ValueError):
        phasescan.LocalizationMap.from_grid(phasescan.TrinaryMap([[0, 0], [0, 0]]))
