import copy
import json
import math
import pickle
import subprocess
import threading

import numpy as np
import pytest
from conftest import look_around

import phasescan

TRUTH = (0.25, -0.15, math.radians(120))


def near(pose, truth, metres=0.02, degrees=0.5):
    x, y, theta = pose
    turned = math.remainder(theta - truth[2], 2 * math.pi)
    return math.hypot(x - truth[0], y - truth[1]) < metres and abs(turned) < math.radians(degrees)


def test_two_arrays_give_the_pose_of_the_scan_in_the_reference():
    result = phasescan.match(look_around(), look_around(*TRUTH), range_max=12.0)
    assert result.usable and bool(result) and near(result.pose, TRUTH)
    assert result.T_ref_scan == result.pose and result.status == result.reason == "converged"
    assert result.covariance.shape == (3, 3) and np.allclose(result.covariance, result.covariance.T)
    assert 0.9 < result.confidence <= 1 and not result.ambiguous and result.ms["total"] > 0
    assert "usable" in repr(result)


def test_the_command_answers_the_same(tmp_path, command):
    scans = [phasescan.Scan(look_around(*pose), range_min=0.15, range_max=12.0) for pose in [(0, 0, 0), TRUTH]]
    for name, scan in zip("ab", scans):
        (tmp_path / f"{name}.json").write_text(scan.to_json())
    told = subprocess.run([command, "match", tmp_path / "a.json", tmp_path / "b.json", "--json"], check=True, capture_output=True, text=True)
    answer = json.loads(told.stdout)
    result = phasescan.match(*scans)
    assert answer["pose"] == {"x": result.pose.x, "y": result.pose.y, "theta": result.pose.theta}
    assert np.allclose(np.array(answer["covariance"]).reshape(3, 3), result.covariance)
    assert answer["usable"] == result.usable and answer["reason"] == result.reason


@pytest.mark.parametrize("method", ["global", "icp", "ndt", "fft", "fft-icp1", "fft-icp2"])
def test_every_method_matches_a_small_motion(method):
    result = phasescan.match(look_around(), look_around(0.05, 0.02, 0.03), range_max=12.0, method=method)
    assert near(result.pose, (0.05, 0.02, 0.03), 0.05, 2.0)


def test_angles_of_an_array_are_those_that_are_said():
    before, now = look_around(), look_around(*TRUTH)
    clockwise = phasescan.match(before[::-1], now[::-1], range_max=12.0, angle_increment=-2 * math.pi / 360, angle_min=-2 * math.pi / 360)
    assert near(clockwise.pose, TRUTH)
    turned = phasescan.match(before, now, range_max=12.0, angle_min=0.5)
    c, s = math.cos(0.5), math.sin(0.5)
    assert near(turned.pose, (c * TRUTH[0] - s * TRUTH[1], s * TRUTH[0] + c * TRUTH[1], TRUTH[2]))


def test_missing_beams_are_missing():
    now = look_around(*TRUTH)
    for missing in (np.nan, np.inf, 0.0, -1.0, 13.0):
        holed = now.copy()
        holed[::5] = missing
        scan = phasescan.Scan(holed, range_max=12.0)
        assert scan.hit_count == 288 and np.isnan(scan.ranges[::5]).all()
        assert near(phasescan.match(look_around(), holed, range_max=12.0).pose, TRUTH)


def test_a_hopeless_scan_is_a_status():
    result = phasescan.match(look_around(), np.zeros(360))
    assert not result and result.reason == "no points"


def test_many_scans_give_what_each_gives_alone_on_any_number_of_threads():
    reference, scans = look_around(), np.array([look_around(0.1 * k, 0.05 * k, 0.4 * k) for k in range(5)])
    alone = [phasescan.match(reference, scan, range_max=12.0) for scan in scans]
    for threads in (1, 3):
        many = phasescan.match_many(reference, scans, range_max=12.0, threads=threads)
        assert len(many) == 5 and many.poses.shape == (5, 3) and many.covariances.shape == (5, 3, 3)
        assert np.array_equal(many.poses, np.array([r.pose for r in alone])) and many.usable.all()
        assert many[-1].confidence == alone[-1].confidence == many.confidence[-1]
    with pytest.raises(IndexError):
        many[5]


def test_a_prepared_reference_answers_the_same():
    before, now = phasescan.Scan(look_around(), range_max=12.0), phasescan.Scan(look_around(*TRUTH), range_max=12.0)
    matcher = phasescan.Matcher()
    plain = phasescan.match(before, now)
    assert matcher.match(before, now).pose == plain.pose
    assert matcher.match(matcher.prepare(before), now).pose == plain.pose
    assert phasescan.match(phasescan.Reference(before), now).pose == plain.pose
    assert phasescan.match_many(phasescan.Reference(before), [now])[0].pose == plain.pose
    with pytest.raises(ValueError, match="prepared with other options"):
        phasescan.Matcher(fast=True).match(matcher.prepare(before), now)
    assert phasescan.match(phasescan.Reference(before, candidates=20), now).usable


def test_a_guess_may_be_anything_with_three_numbers():
    before, now = look_around(), look_around(*TRUTH)

    class Pose:
        x, y, theta = TRUTH

    answers = {tuple(phasescan.match(before, now, range_max=12.0, guess=g).pose) for g in (TRUTH, list(TRUTH), np.array(TRUTH), Pose(), phasescan.Pose2(*TRUTH))}
    assert len(answers) == 1 and near(answers.pop(), TRUTH)
    for wrong in ((1, 2), "abc", 5, (1, 2, "x"), (1, 2, math.nan)):
        with pytest.raises(ValueError, match="guess: "):
            phasescan.match(before, now, guess=wrong)


def test_what_is_no_scan_is_refused_by_name():
    good = look_around()
    with pytest.raises(ValueError, match="reference: expected a 1-D array of ranges .* 2 dimensions"):
        phasescan.match(np.ones((3, 3)), good)
    with pytest.raises(ValueError, match="scan: expected a Scan or a 1-D array"):
        phasescan.match(good, object())
    with pytest.raises(ValueError, match="scans: expected an array of shape"):
        phasescan.match_many(good, good)
    with pytest.raises(ValueError, match="angle_increment"):
        phasescan.match(good, good, angle_increment=0.0)
    with pytest.raises(ValueError, match="threads"):
        phasescan.match_many(good, [good], threads=0)


def test_other_threads_run_while_a_match_does():
    scans = np.array([look_around(0.1, 0.1, 0.1)] * 300)
    counted, done = [0], threading.Event()

    def count():
        while not done.is_set():
            counted[0] += 1

    counter = threading.Thread(target=count)
    counter.start()
    before = counted[0]
    phasescan.match_many(look_around(), scans)
    after = counted[0]
    done.set()
    counter.join()
    assert after > before + 100


def test_poses_are_tuples_of_three_that_know_geometry():
    a, b = phasescan.Pose2(1, 2, 0.5), phasescan.Pose2(-0.3, 0.1, 3.0)
    x, y, theta = a * b
    assert np.allclose((a * b * b.inverse()), a) and len(a) == 3 and a[2] == a[-1] == 0.5
    assert math.isclose(x, 1 + math.cos(0.5) * -0.3 - math.sin(0.5) * 0.1)
    assert np.allclose(a.transform([(1.0, 0.0)]), [(1 + math.cos(0.5), 2 + math.sin(0.5))])
    assert pickle.loads(pickle.dumps(a)) == a == copy.deepcopy(a) and hash(a) == hash(phasescan.Pose2(1, 2, 0.5))
    assert eval(repr(a), {"Pose2": phasescan.Pose2}) == a
    with pytest.raises(IndexError):
        a[3]


def test_scans_are_views_and_travel():
    scan = phasescan.Scan(look_around(), range_max=12.0, stamp=1700000000.25, intensities=np.arange(360))
    assert scan.ranges.base is scan and not scan.ranges.flags.writeable and scan.ranges.dtype == np.float32
    assert scan.stamp == 1700000000.25 and scan.stamp_ns == 1700000000250000000 and len(scan) == 360
    other = pickle.loads(pickle.dumps(scan))
    assert other == scan and np.array_equal(other.intensities, scan.intensities)
    assert phasescan.Scan.from_json(scan.to_json()) == scan
    assert scan.points().shape == (360, 2) and math.isclose(math.hypot(*scan.points()[7]), scan.ranges[7], rel_tol=1e-6)
    assert scan.reduced(beam_step=2, range_max=2.0).hit_count < 180
    keep = phasescan.Scan(look_around()).ranges
    assert keep.sum() > 0  # the array keeps its scan
    with pytest.raises(ValueError, match="angles: expected one value for each of 360 beams, got 3"):
        phasescan.Scan(look_around(), angles=[1, 2, 3])
