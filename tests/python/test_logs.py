import json
import math
import os
import subprocess

import numpy as np
import pytest

import phasescan


def test_a_simulated_drive_has_the_bytes_of_the_command(drive, command, tmp_path):
    drive.save(tmp_path / "mine.jsonl")
    subprocess.run([command, "simulate", "--world", "flat", "--seed", "3", "--duration", "20", "--out", "its.jsonl"], cwd=tmp_path, check=True)
    for ending in ("", ".truth.tum"):
        assert (tmp_path / f"mine.jsonl{ending}").read_bytes() == (tmp_path / f"its.jsonl{ending}").read_bytes()
    assert len(drive) == len(drive.stamps) == len(drive.truth) and drive[-1].stamp == drive.stamps[-1]


def test_a_log_is_an_iterator_of_entries(drive, tmp_path):
    path = tmp_path / "drive.jsonl"
    drive.save(path)
    for name in (path, str(path)):
        reader = phasescan.open_log(name)
        entries = list(reader)
        assert [e.stamp for e in entries] == list(drive.stamps) and entries[3].line == 4
        assert entries[5].scan == drive[5].scan and reader.format == "scan log" and reader.damage_count == 0
    assert list(reader) == []
    near = next(phasescan.open_log(path, range_max=1.0)).scan
    assert near.hit_count < drive[0].scan.hit_count and np.nanmax(near.ranges) <= 1.0
    assert len(list(phasescan.open_log(path, from_s=5.0, to_s=10.0))) < 40
    masked = next(phasescan.open_log(path, mask_deg=[(-90.0, 90.0)])).scan
    assert (masked.points()[:, 0] <= 1e-6).all()


def test_wheels_are_read(tmp_path):
    log = phasescan.simulate("flat", seed=3, duration_s=3.0, odometry=True)
    assert log[5].odometry is not None and phasescan.simulate("flat", seed=3, duration_s=3.0)[5].odometry is None
    x, y, theta = log[5].odometry
    assert math.isfinite(x + y + theta)


def test_what_cannot_be_read_says_where(tmp_path, drive):
    with pytest.raises(phasescan.InputError, match="nothing.log") as caught:
        phasescan.open_log(tmp_path / "nothing.log")
    assert caught.value.file.endswith("nothing.log") and caught.value.reason and caught.value.line == 0
    drive.save(tmp_path / "drive.jsonl")
    lines = (tmp_path / "drive.jsonl").read_text().splitlines()
    lines[3] = lines[3][:50]
    (tmp_path / "drive.jsonl").write_text("\n".join(lines) + "\n")
    reader = phasescan.open_log(tmp_path / "drive.jsonl")
    assert len(list(reader)) == len(drive) - 1 and reader.damage_count == 1 and ":4: " in reader.damages[0][1]
    with pytest.raises(phasescan.InputError, match="drive.jsonl:2: "):
        phasescan.simulate(str(tmp_path / "drive.jsonl"))
    with pytest.raises(ValueError):
        phasescan.simulate("nowhere")


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read anything")
def test_the_system_may_say_no(tmp_path):
    (tmp_path / "a.jsonl").write_text("{}")
    (tmp_path / "a.jsonl").chmod(0)
    with pytest.raises(phasescan.SystemError):
        phasescan.open_log(tmp_path / "a.jsonl")


def test_evaluation_says_what_the_command_says(drive, command, tmp_path):
    drive.save(tmp_path / "drive.jsonl")
    off = drive.truth + np.array([1.0, 2.0, 0.0])
    off[::7, 0] += 0.05
    lines = [f"{t:.9f} {x} {y} 0 0 0 {math.sin(a / 2)} {math.cos(a / 2)}" for t, (x, y, a) in zip(drive.stamps, off)]
    (tmp_path / "off.tum").write_text("\n".join(lines) + "\n")
    mine = phasescan.evaluate(tmp_path / "off.tum", str(tmp_path / "drive.jsonl.truth.tum"))
    told = subprocess.run([command, "eval", "--trajectory", "off.tum", "--reference", "drive.jsonl.truth.tum", "--json"], cwd=tmp_path, check=True,
                          capture_output=True, text=True)
    its = json.loads(told.stdout)
    for kind in ("ate_m", "translation_m", "rotation_deg", "rpe_m", "rpe_deg"):
        for name, value in its[kind].items():
            assert mine[kind][name] == pytest.approx(value, abs=1e-6)
    assert 0.005 < mine["ate_m"]["rmse"] < 0.05
    assert phasescan.evaluate(tmp_path / "off.tum", (drive.stamps, drive.truth), align=False)["ate_m"]["mean"] > 2
    with pytest.raises(ValueError, match="expected one of reference and relations"):
        phasescan.evaluate(tmp_path / "off.tum")
    with pytest.raises(ValueError, match="same clock"):
        phasescan.evaluate((drive.stamps + 1000, drive.truth), (drive.stamps, drive.truth))


def test_recorded_relations(data):
    relations = data / "relations" / "intel.relations"
    if not relations.exists():
        pytest.skip(f"no {relations}")
    result = phasescan.evaluate(([0.0, 1.0], np.zeros((2, 3))), relations=relations)
    assert result["relations"] > 100 and result["answered"] == 0 and result["translation_m"]["mean"] is None
