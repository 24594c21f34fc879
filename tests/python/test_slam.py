import json
import pickle
import subprocess

import numpy as np
import pytest

import phasescan


def run_of(entries, **options):
    slam = phasescan.Slam(**options)
    for entry in entries:
        slam.add(entry)
    return slam


def test_odometry_follows_the_drive(drive):
    odometry = phasescan.Odometry()
    updates = [odometry.add(entry) for entry in drive]
    assert all(u.tracked for u in updates) and updates[-1].status == "ok"
    error = phasescan.evaluate((drive.stamps, np.array([u.pose for u in updates])), (drive.stamps, drive.truth))
    assert error["pairs"] == len(drive) and error["ate_m"]["rmse"] < 0.05
    assert updates[-1].covariance.shape == (3, 3) and updates[-1].twist.vx > -1 and "ok" in repr(updates[-1])


def test_odometry_takes_scans_arrays_and_measurements_alike(drive):
    ways = [lambda e: (e,), lambda e: (e.measurement,), lambda e: (e.scan,), lambda e: (phasescan.RangeMeasurement(e.scan),)]
    ends = set()
    for way in ways:
        odometry = phasescan.Odometry()
        for entry in list(drive)[:20]:
            update = odometry.add(*way(entry))
        ends.add(tuple(update.pose))
    assert len(ends) == 1
    mounted = phasescan.Odometry()
    for entry in list(drive)[:20]:
        update = mounted.add(entry, T_base_laser=(0.1, 0.0, np.pi))
    assert tuple(update.pose) not in ends


def test_slam_gives_poses_and_a_map(drive):
    slam = run_of(drive)
    grown = slam.map()
    result = slam.finish()
    assert len(result) == len(drive) == len(result.status) and result.poses.shape == (len(drive), 3)
    assert phasescan.evaluate(result, (drive.stamps, drive.truth))["ate_m"]["rmse"] < 0.05
    cells = result.map.cells
    assert cells.shape == (result.map.height, result.map.width) and set(np.unique(cells)) == {-1, 0, 100}
    assert grown.cells.size > 0 and result.pieces == 1 and not result.left_out.any() and result.on_map.all()
    assert len(result.keyframe_poses) == len(result.keyframe_scans) > 3 and result.edges[0]["loop"] is False
    assert "keyframes" in repr(result) and result.loops["accepted"] >= 0 and result.parts == []
    with pytest.raises(RuntimeError, match="finished"):
        slam.add(drive[0])


def test_a_run_says_how_far_it_can_be_trusted(drive, command, tmp_path):
    drive.save(tmp_path / "drive.jsonl")
    subprocess.run([command, "slam", "drive.jsonl", "--out", "out"], cwd=tmp_path, check=True, capture_output=True)
    told = json.loads((tmp_path / "out" / "summary.json").read_text())
    result = run_of(phasescan.open_log(tmp_path / "drive.jsonl")).finish()
    verdict = result.verdict
    assert verdict.verdict == str(verdict) == told["verdict"] == "good" and verdict == "good" and verdict != "failed"
    assert verdict.probability == pytest.approx(told["verdict_probability"], abs=1e-3) and verdict.probability >= 0.95
    assert verdict.evidence["scans"] == len(drive) and "good" in repr(verdict) and "SlamResult good" in repr(result)
    assert [f["kind"] for f in result.findings] == [r["kind"] for r in told["reasons"]]


def test_a_run_that_nothing_ties_is_not_called_good(drive):
    slam = phasescan.Slam()
    other = phasescan.simulate("office", seed=8, duration_s=15.0)
    for entry in drive:
        slam.add(entry)
    slam.begin_session()
    for entry in other:
        slam.add(entry)
    result = slam.finish()
    assert result.verdict == "doubtful" and result.verdict.probability < 0.95
    assert result.findings[0]["kind"] == "pieces" and "SlamResult doubtful" in repr(result)
    assert [part.verdict.verdict for part in result.parts] == ["good", "good"]


def test_the_map_outlives_its_run(drive):
    grid = run_of(list(drive)[:10]).finish().map
    assert (grid.cells == 100).any()


def test_the_command_makes_the_same_trajectory(drive, command, tmp_path):
    drive.save(tmp_path / "drive.jsonl")
    subprocess.run([command, "slam", "drive.jsonl", "--out", "out"], cwd=tmp_path, check=True, capture_output=True)
    result = run_of(phasescan.open_log(tmp_path / "drive.jsonl")).finish()
    result.write_tum(tmp_path / "mine.tum")
    assert (tmp_path / "mine.tum").read_bytes() == (tmp_path / "out" / "trajectory.tum").read_bytes()
    assert np.array_equal(phasescan.TrinaryMap.load(tmp_path / "out" / "map.yaml").cells, result.map.cells)


def test_work_beside_the_scans_changes_nothing(drive):
    assert np.array_equal(run_of(drive).finish().poses, run_of(drive, threads=2).finish().poses)
    assert len(run_of(drive, schedule="latest", threads=2).finish()) == len(drive)


def test_a_run_goes_on_from_its_state(drive, tmp_path):
    entries = list(drive)
    whole = run_of(entries).finish()
    begun = run_of(entries[:40], keyframe_distance_m=0.25).checkpoint()
    begun.save(tmp_path / "run.state")
    for state in (begun, phasescan.SlamState.load(tmp_path / "run.state"), pickle.loads(pickle.dumps(begun))):
        slam = phasescan.Slam(state=state)
        assert slam.scans == state.scans == 40 and slam.options == begun.options
        for entry in entries[40:]:
            slam.add(entry)
        assert np.array_equal(slam.finish().poses, whole.poses)
    assert begun.summary["scans"] == 40 and begun.summary["pieces"] == 1


def test_the_command_goes_on_from_a_state_of_python(drive, command, tmp_path):
    drive.save(tmp_path / "drive.jsonl")
    run_of(list(drive)[:40]).checkpoint().save(tmp_path / "run.state")
    told = subprocess.run([command, "info", "run.state", "--json"], cwd=tmp_path, check=True, capture_output=True, text=True)
    assert json.loads(told.stdout)["scans"] == 40


def test_what_is_no_state_is_refused(tmp_path):
    (tmp_path / "no.state").write_bytes(b"something else")
    with pytest.raises(phasescan.StateError, match="no.state"):
        phasescan.SlamState.load(tmp_path / "no.state")
    with pytest.raises(ValueError, match="state: expected a SlamState, got dict"):
        phasescan.Slam(state={})
    with pytest.raises(ValueError, match="schedule: is 'now'"):
        phasescan.Slam(schedule="now")


def test_prediction_goes_on_as_at_the_last_scan(drive):
    slam = phasescan.Slam()
    for entry in list(drive)[:60]:
        update = slam.add(entry)
    ahead = slam.predict(update.stamp + 0.1)
    assert np.hypot(ahead.x - update.pose.x, ahead.y - update.pose.y) < 0.1
    assert slam.predict(update.stamp + 100) is None


def test_maps_are_files_and_travel(drive, tmp_path):
    grid = run_of(list(drive)[:10]).finish().map
    grid.save(tmp_path / "map.yaml")
    again = phasescan.TrinaryMap.load(tmp_path / "map.yaml")
    assert np.array_equal(again.cells, grid.cells) and again.resolution_m == grid.resolution_m
    assert np.array_equal(pickle.loads(pickle.dumps(grid)).cells, grid.cells)
    assert np.array_equal(phasescan.TrinaryMap(grid.cells, grid.resolution_m, grid.origin).cells, grid.cells)
    assert grid.to_png().startswith(b"\x89PNG") and not grid.cells.flags.writeable
    with pytest.raises(ValueError, match="cells: has a 7"):
        phasescan.TrinaryMap([[7]])
    with pytest.raises(ValueError, match="ending in .yaml"):
        grid.save(tmp_path / "map.pgm")
