"""A small fleet, whole: workers that die, broken logs, going on, and the same bytes from any number of workers."""
import json
import os
import pathlib
import signal
import sqlite3
import subprocess
import sys
import time

import pytest

import phasescan

pytest.importorskip("distributed")


def results_of(out):
    return {str(p.relative_to(out)): p.read_bytes() for p in sorted(out.rglob("*")) if p.is_file() and p.name != "cost.json"}


def start(manifest, out, *more):
    return subprocess.Popen([sys.executable, "-m", "phasescan.fleet", "run", manifest, "--out", out, "--no-times", *more], stderr=subprocess.PIPE, text=True)


@pytest.fixture(scope="module")
def fleet(tmp_path_factory):
    """Three logs of a flat, two of an office, and three that are none."""
    place = tmp_path_factory.mktemp("fleet")
    for world, count in (("flat:5000", 3), ("office:5003", 2)):
        for k in range(count):
            phasescan.simulate(world, seed=7 + k, duration_s=45.0).save(place / f"{world.replace(':', '-')}-{k}.jsonl")
    (place / "broken").mkdir()
    (place / "broken" / "cut.jsonl").write_text('{"angle_min": ')
    (place / "broken" / "empty.jsonl").write_text("")
    (place / "manifest.txt").write_text("*.jsonl\nbroken\nbroken/none.jsonl\n")
    process = start(place / "manifest.txt", place / "one", "--workers", "1")
    told = process.communicate(timeout=250)[1]
    assert process.returncode == 0, told
    return place, told


def test_every_log_has_its_row_and_broken_ones_are_named(fleet):
    place, told = fleet
    base = sqlite3.connect(place / "one" / "fleet.sqlite")
    rows = base.execute("SELECT log, status, cause, scans, way_m, loops, version FROM logs ORDER BY number").fetchall()
    assert len(rows) == 8 and [r[0] for r in rows][-3:] == ["broken/cut.jsonl", "broken/empty.jsonl", "broken/none.jsonl"]
    assert all(r[1] != "broken" and r[3] > 200 and r[4] > 5 and r[6] == phasescan.__version__ for r in rows[:5])
    for name, status, cause, *_ in rows[5:]:
        assert status == "broken" and name in cause and f"phasescan: {cause}" in told
    assert base.execute("SELECT count(*) FROM timing WHERE cpu_s IS NOT NULL").fetchone() == (0,)
    page = (place / "one" / "report.html").read_text()
    assert page.count("<tr>") == 1 + 8 + 2 + 1 - 1 or page.count("<td class='t'>broken/") == 3
    assert "dashboard at http" in told
    cost = json.loads((place / "one" / "cost.json").read_text())
    assert cost["workers"] == 1 and set(cost["cpu_s"]) == {"maps", "index", "places", "ties", "joint maps"}
    assert cost["cpu_s"]["maps"] > 0.2 and 0.0 < cost["cpu_s"]["joint maps"] and sum(cost["cpu_s"].values()) < cost["wall_s"] * 2
    assert 0.2 < cost["busy_s"] <= cost["wall_s"]  # one worker


def test_logs_of_one_place_are_one_group_with_a_map(fleet):
    place, _ = fleet
    groups = json.loads((place / "one" / "groups.json").read_text())
    names = [sorted({name.rsplit("-", 1)[0] for name in group["logs"]}) for group in groups]
    assert all(len(kinds) == 1 for kinds in names), groups  # never two places in one
    assert ["flat-5000-0.jsonl", "flat-5000-1.jsonl", "flat-5000-2.jsonl"] in [group["logs"] for group in groups]
    assert sum(len(group["logs"]) for group in groups) == 5
    for group in groups:
        assert phasescan.TrinaryMap.load(place / "one" / group["map"]).cells.any()


def test_going_on_leaves_what_is_done(fleet):
    place, _ = fleet
    before = {p: p.stat().st_mtime_ns for p in (place / "one").rglob("row.json")}
    process = start(place / "manifest.txt", place / "one", "--workers", "1")
    told = process.communicate(timeout=250)[1]
    assert process.returncode == 0 and "8 logs, 8 of them done before" in told
    assert before == {p: p.stat().st_mtime_ns for p in (place / "one").rglob("row.json")}


def test_workers_that_die_change_nothing(fleet):
    place, _ = fleet
    process = start(place / "manifest.txt", place / "three", "--workers", "3")
    killed = 0
    until = time.monotonic() + 60
    while killed < 2 and process.poll() is None and time.monotonic() < until:
        time.sleep(0.5)
        if any((place / "three" / "logs").glob("*/row.json")):
            workers = subprocess.run(["pgrep", "-P", str(process.pid), "-f", "spawn_main"], capture_output=True, text=True).stdout.split()
            for worker in workers[:1]:
                os.kill(int(worker), signal.SIGKILL)
                killed += 1
    told = process.communicate(timeout=250)[1]
    assert process.returncode == 0, told
    assert killed > 0
    assert results_of(place / "three") == results_of(place / "one")
