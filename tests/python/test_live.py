import threading
import time

import pytest

import phasescan


def test_a_simulated_sensor_gives_poses_as_they_come():
    with phasescan.live(demo=True) as sensor:
        for update in sensor:
            assert update.status in ("initialising", "ok", "degraded") and update.latency_ms >= 0
            if update.update.scan >= 8:
                break
        assert "simulated" in sensor.messages[0] and "running" in repr(sensor)
        assert update.pose == update.update.pose and update.covariance.shape == (3, 3)
    assert "ended" in repr(sensor) and sensor.map().cells.size > 0
    assert len(list(sensor)) < 20  # what was waiting, then the end


def test_a_log_at_its_pace_ends(tmp_path):
    phasescan.simulate("flat", seed=2, duration_s=1.5).save(tmp_path / "log.jsonl")
    began = time.monotonic()
    updates = list(phasescan.live(replay=str(tmp_path / "log.jsonl")))
    assert len(updates) >= 5 and time.monotonic() - began > 1.0
    assert [u.update.scan for u in updates] == list(range(len(updates)))


def test_other_threads_run_while_it_waits():
    turns = []
    counter = threading.Thread(target=lambda: turns.extend(time.sleep(0.01) or k for k in range(20)))
    with phasescan.live(demo=True) as sensor:
        counter.start()
        next(sensor), next(sensor), next(sensor)
    counter.join()
    assert len(turns) == 20


def test_nothing_plugged_in_is_one_line(tmp_path, monkeypatch):
    monkeypatch.setenv("PHASESCAN_PORTS", "")
    with pytest.raises((phasescan.SystemError, ValueError)):
        next(phasescan.live(str(tmp_path / "no-such-device")))
    with pytest.raises(phasescan.OptionError):
        phasescan.live("auto", batch_node=3)
    with pytest.raises(ValueError, match="expected one of demo and replay"):
        phasescan.live(demo=True, replay="x")
