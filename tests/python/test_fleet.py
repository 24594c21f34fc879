"""The parts of the fleet: manifests, tasks, the index, groups, tables."""
import math
import sqlite3

import numpy as np
import pytest

import phasescan
from phasescan.fleet import alike, cli, engine, files, groups, joint, manifest, record, tables, ties
from phasescan.fleet.ties import Tie


@pytest.fixture
def place(tmp_path):
    for name in ("b/2.log", "b/1.log", "b/deep/3.log", "b/.hidden", "b/1.log.truth.tum", "c.log", "bag/metadata.yaml", "bag/bag_0.db3"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("x")
    return tmp_path


def names_of(place, text):
    (place / "manifest.txt").write_text(text)
    return [log.name for log in manifest.read_manifest(str(place / "manifest.txt"))]


def test_a_manifest_names_files_globs_and_folders(place):
    assert names_of(place, "c.log\n# no\n\n  b/*.log  \nb\nc.log\nbag\n") == ["c.log", "b/1.log", "b/2.log", "b/deep/3.log", "bag"]
    assert names_of(place, f"{place}/b/[12].log\nnothing.log\nno*.log\n") == ["b/1.log", "b/2.log", "nothing.log", "no*.log"]
    logs = manifest.read_manifest(str(place / "manifest.txt"))
    assert [log.number for log in logs] == [1, 2, 3, 4] and logs[0].folder == "logs/000001-1.log"
    assert logs[0].path == str(place / "b/1.log")


def test_a_manifest_that_cannot_be_read_is_one_line(place, capsys):
    for text, told in ((b"\xff\xfe", "is no text"), (b"# nothing\n", "names no log"), (b"a\0b\n", ":1: is no path")):
        (place / "manifest.txt").write_bytes(text)
        with pytest.raises(manifest.ManifestError, match=told):
            manifest.read_manifest(str(place / "manifest.txt"))
    assert cli.main(["run", str(place / "nothing"), "--out", str(place / "out")]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1 and told.startswith("phasescan: ") and "nothing: cannot be read" in told
    assert not (place / "out").exists()


def test_wrong_usage_of_the_fleet_is_one_line(place, capsys):
    (place / "manifest.txt").write_text("c.log\n")
    (place / "wrong.yaml").write_text("map:\n  no_such_option: 1\n")
    manifest_txt, out = str(place / "manifest.txt"), str(place / "out")
    for wrong, told in ((["run", "x"], "--out"), ([], "what"), (["run", "x", "--out", out, "--bogus"], "--bogus"),
                        (["run", "x", "--out", out, "--workers", "two"], "--workers"),
                        (["run", manifest_txt, "--out", out, "--workers", "0"], "--workers: is 0"),
                        (["run", manifest_txt, "--out", out, "--workers", "-1"], "--workers: is -1"),
                        (["run", manifest_txt, "--out", out, "--config", str(place / "nothing.yaml")], "nothing.yaml: no such file"),
                        (["run", manifest_txt, "--out", out, "--config", str(place / "wrong.yaml")], "wrong.yaml:2: unknown option"),
                        (["run", manifest_txt, "--out", str(place / "c.log")], "c.log: is a file"),
                        (["run", manifest_txt, "--out", str(place / "c.log" / "below")], "below: is a file, or lies in one")):
        try:
            code = cli.main(wrong)
        except SystemExit as stopped:
            code = stopped.code
        error = capsys.readouterr().err
        assert code == 2 and error.count("\n") == 1 and error.startswith("phasescan: ") and told in error, (wrong, error)
    assert not (place / "out").exists() and (place / "c.log").read_text() == "x"


def test_tasks_hold_neighbours_up_to_a_tenth_of_a_share():
    for costs, workers in (([1.0] * 100, 2), ([0.1, 5.0, 0.1, 300.0, 0.1] * 9, 3), ([1.0], 8), ([], 2)):
        chunks = engine.in_chunks(range(len(costs)), costs, workers)
        assert [k for chunk in chunks for k in chunk] == list(range(len(costs)))
        most = min(120.0, sum(costs) / workers / 10)
        assert all(len(chunk) == 1 or sum(costs[k] for k in chunk) <= most + 1e-9 for chunk in chunks)
    assert len(engine.in_chunks(range(100), [1.0] * 100, 2)) == 20


def descriptors(rng, count, near=0.3):
    centres = rng.normal(size=(count // 10, 1, 160))
    block = (centres + near * rng.normal(size=(count // 10, 10, 160))).reshape(-1, 160)
    numbers = np.round(200 * block / np.linalg.norm(block, axis=1, keepdims=True)).astype(np.int8)
    return numbers, rng.integers(0, 256, size=(len(block), 160)).astype(np.uint8)


def test_alike_views_are_those_of_a_slow_search(tmp_path):
    rng = np.random.default_rng(3)
    numbers, turning = descriptors(rng, 300)
    first = np.array([0, 7, 7, *range(14, 300, 7), 300], np.int64)  # one log without a view
    alike.write_arrays(tmp_path, numbers, turning, first)
    index = alike.read_index(tmp_path)
    wide = numbers.astype(np.int64)
    checked = 0
    for log in range(len(first) - 1):
        found = alike.alike_views(index, log)
        for row in range(first[log], first[log + 1]):
            mine = found[found[:, 0] == row - first[log]]
            rows = first[mine[:, 1]] + mine[:, 2]
            assert not ((rows >= first[log]) & (rows < first[log + 1])).any() and all(np.bincount(mine[:, 1]) <= 2)
            distance = ((wide - wide[row]) ** 2).sum(axis=1)
            others = np.delete(np.arange(300), np.arange(first[log], first[log + 1]))
            near = others[distance[others] <= 200 * 200]
            log_of = np.searchsorted(first, near, side="right") - 1
            assert set(rows) <= set(near) and set(mine[:, 1]) == set(log_of)
            assert len(mine) == min(alike.LOOKED, sum(min(2, n) for n in np.bincount(log_of)))
            checked += len(mine)
    assert checked > 100


def test_cells_lose_few_neighbours(tmp_path, monkeypatch):
    numbers, turning = descriptors(np.random.default_rng(4), 6000, 0.6)
    first = np.arange(0, 6001, 5, dtype=np.int64)
    found = {}
    for limit in (20000, 1000):
        monkeypatch.setattr(alike, "BRUTE_FORCE", limit)
        alike.write_arrays(tmp_path / str(limit), numbers, turning, first)
        index = alike.read_index(tmp_path / str(limit))
        assert (len(index.centres) > 0) == (limit == 1000)
        found[limit] = [{(int(i), int(o), int(v)) for i, o, v in alike.alike_views(index, log)[:, :]} for log in range(0, 1200, 100)]
        rows = [index.members(index.numbers[7], 1) for _ in range(2)]
        assert np.array_equal(*rows) and not {5, 6, 7, 8, 9} & set(rows[0].tolist())
    # Of the ten views around a place, five are of another log: those must be found through the cells as well.
    kin = lambda log, triple: (5 * log) // 10 == (5 * triple[1] + triple[2]) // 10
    for log, every, some in zip(range(0, 1200, 100), found[20000], found[1000]):
        wanted = {t for t in every if kin(log, t)}
        assert wanted and len(wanted & some) >= 0.95 * len(wanted)


def test_groups_are_what_ties_hold_together_and_contradictions_are_left_out():
    tie = lambda a, b, x, witnesses=5: Tie(a, b, (x, 0.0, 0.0), witnesses, witnesses)
    made = groups.group_logs(6, [tie(0, 2, 1.0), tie(2, 4, 1.0), tie(1, 3, 0.0), tie(0, 4, 2.1)])
    assert made.groups == [[0, 2, 4], [1, 3], [5]] and made.contradicted == []
    wrong = tie(0, 4, 5.0, 3)
    assert groups.group_logs(6, [wrong, tie(0, 2, 1.0), tie(2, 4, 1.0)]).contradicted == [wrong]
    turned = Tie(0, 2, (2.0, 0.0, math.radians(20)), 3, 3)
    assert groups.group_logs(3, [tie(0, 1, 1.0), tie(1, 2, 1.0), turned]).contradicted == [turned]


def test_a_tie_needs_three_views_half_a_metre_apart():
    from conftest import look_around

    def views(poses):
        return {"poses": np.array(poses), "ranges": np.array([look_around(*p) for p in poses], np.float32)}

    way = [(0.6 * k - 0.9, 0.1 * k, 0.4 * k) for k in range(5)]
    found = ties.tie_of(0, 1, views(way), views([(x, y, t + 0.5) for x, y, t in way]), [(0, 0), (4, 4)])
    assert found is not None and found.witnesses >= 4 and np.allclose(found.T_a_b, 0.0, atol=0.05)
    stop = [(0.01 * k, 0.0, 1.2 * k) for k in range(6)]
    assert ties.tie_of(0, 1, views(stop), views(stop), [(k, k) for k in range(6)]) is None
    assert ties.tie_of(0, 1, views(way[:2]), views(way[:2]), [(0, 0), (1, 1)]) is None
    # Maps that agree at one end alone: all the rest of the way speaks against it.
    other = [(x, y, t) if k < 1 else (x, y + 1.0, t) for k, (x, y, t) in enumerate(way)]
    bent = {"poses": np.array(other), "ranges": views(way)["ranges"]}
    assert ties.tie_of(0, 1, views(way), bent, [(0, 0)]) is None
    # Three agree, but four that must see the same see something else: a place that only looks alike.
    long = [(0.6 * k - 1.6, 0.2 * (k % 2), 0.3 * k) for k in range(7)]
    strange = views(long)
    strange["ranges"][3:] = 1.5 + 0.5 * np.sin(np.arange(360) / 9)
    assert ties.tie_of(0, 1, views(long), views(long), [(0, 0), (2, 2)]) is not None
    assert ties.tie_of(0, 1, views(long), strange, [(0, 0), (2, 2)]) is None


def test_rows_say_how_a_log_failed():
    log = manifest.Log(3, "a.log", "/data/a.log")
    row = record.row_of(log, record.Ended(2, "noise\nphasescan: /data/a.log:7: is odd; expected even\n", "", 0.1, 10.0), None)
    assert row["status"] == "broken" and row["cause"] == "a.log:7: is odd; expected even"
    assert "SIGSEGV" in record.row_of(log, record.Ended(-11, "", "", 0.1, 10.0), None)["cause"]
    summary = {"scans": 5, "path_length_m": 1.5, "loops": {"accepted": 2}, "verdict": "doubtful", "verdict_probability": 0.5,
               "reasons": [{"kind": "gaps", "what": "2 s without a scan"}]}
    row = record.row_of(log, record.Ended(0, "", "", 0.1, 10.0), summary)
    assert row["status"] == "doubtful" and row["cause"] == "gaps: 2 s without a scan" and row["loops"] == 2


def test_a_process_that_takes_too_long_is_ended():
    ended = record.run_command(["/bin/sleep", "30"], 0.2)
    assert ended.code == -9
    assert record.run_command(["/bin/sh", "-c", "echo out; echo phasescan: no >&2; exit 3"], 10.0).text == "phasescan: no\n"


def test_tables_have_the_same_bytes_and_times_apart(tmp_path):
    rows = [{"number": k, "log": f"{k}.log", "status": "done", "folder": f"logs/{k}"} for k in (1, 2, 3)]
    made = [{"logs": ["1.log", "3.log"], "map": "groups/1/map.yaml"}, {"logs": ["2.log"], "map": "logs/2/map.yaml"}]
    for name in "ab":
        tables.write_tables(tmp_path / name, rows, made, [Tie(0, 2, (1.0, 2.0, 0.5), 4, 5)], [], [{}] * 3)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()
    tables.write_tables(tmp_path / "a", rows, made, [], [], [{"cpu_s": 0.5, "peak_mb": 70.0}] * 3)
    base = sqlite3.connect(tmp_path / "a")
    assert base.execute('SELECT log, "group", cpu_s FROM fleet').fetchall() == [("1.log", 1, 0.5), ("2.log", 2, 0.5), ("3.log", 1, 0.5)]


def test_files_appear_whole_or_not_at_all(tmp_path):
    files.write_json(tmp_path / "a.json", {"x": 1})
    with pytest.raises(TypeError):
        files.write_json(tmp_path / "a.json", object())
    assert files.read_json(tmp_path / "a.json") == {"x": 1} and [p.name for p in tmp_path.iterdir()] == ["a.json"]
    assert files.read_json(tmp_path / "none.json") is None


def test_parts_of_a_joint_map_are_told_by_name_or_by_order():
    log = lambda number, path: manifest.Log(number, path, f"/data/{path}")
    settings = record.Settings("/out", "/bin/phasescan")
    three = joint.Group((log(2, "a.log"), log(5, "b.log"), log(7, "c.log")))
    assert joint.joint_command(three, settings, "/w")[1] == "merge" and three.folder == "groups/000002"
    turned = {"inputs": [{"log": "c.log", "folder": "1"}, {"log": "a.log", "folder": "1"}, {"log": "b.log", "folder": "2"}]}
    assert joint._parts(three, turned) == [{"logs": [2, 7], "map": "groups/000002/1/map.yaml"}, {"logs": [5], "map": "groups/000002/2/map.yaml"}]
    alike_names = joint.Group((log(1, "x/a.log"), log(3, "y/a.log")))
    assert joint.joint_command(alike_names, settings, "/w")[1:4] == ["slam", "/data/x/a.log", "/data/y/a.log"]
    assert joint._parts(alike_names, {"inputs": [{"log": "a.log"}, {"log": "a.log"}]}) == [{"logs": [1, 3], "map": "groups/000001/map.yaml"}]
    rows = [{"status": "done"}, {"status": "broken"}]
    assert joint.groups_file([log(1, "a"), log(2, "b")], rows, []) == [{"logs": ["a"], "map": "logs/000001-a/map.yaml"}]
