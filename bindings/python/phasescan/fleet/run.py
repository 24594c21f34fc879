"""A fleet from its manifest to its tables: the three stages, what is done already left as it is."""
from __future__ import annotations

import dataclasses
import functools
import os
import pathlib
from typing import Any, Sequence

import numpy as np

from .alike import alike_views, read_index, write_index
from .engine import Engine, cpu_time, in_chunks
from .files import digest, read_json, write_json, write_text
from .groups import Grouping, group_logs
from .joint import Group, groups_file, map_group
from .manifest import Log
from .record import Settings, finished_row, map_log, remove_others
from .report import format_report
from .tables import write_tables
from .ties import Tie, tie_of, witnesses_of

SECONDS_A_MB = 3.0     # of CPU for a log, from its size, to cut tasks by; what is off only makes tasks uneven
LEAST_SECONDS = 0.2
SECONDS_A_QUERY = 0.3  # of a log in stage 2


def run_fleet(logs: Sequence[Log], settings: Settings, engine: Engine, times: bool = True) -> tuple[list[dict[str, Any]], list[str]]:
    """All stages. Returns the rows, in the manifest's order, and what went wrong with groups, a line each."""
    rows = map_logs(logs, settings, engine)
    ties = find_ties(logs, rows, settings, engine)
    grouping = group_logs(len(logs), ties)
    groups = [Group(tuple(logs[k] for k in members)) for members in grouping.groups if len(members) > 1]
    mapped = engine.map("joint maps", functools.partial(map_group, settings=settings), groups)
    remove_others(settings.out, "logs", "row.json", _names(logs))
    remove_others(settings.out, "groups", "group.json", _names(groups))
    errors = [f"{group.folder}: {result['error']}" for group, result in zip(groups, mapped) if result["error"]]
    errors += [f"the tie of {logs[t.a].name} and {logs[t.b].name} contradicts others and was left out" for t in grouping.contradicted]
    write_results(logs, rows, ties, grouping, mapped, errors, settings, times)
    write_json(pathlib.Path(settings.out) / "cost.json", engine.cost())
    return rows, errors


def _names(places: Sequence[Log | Group]) -> set[str]:
    return {pathlib.PurePath(place.folder).name for place in places}


def map_logs(logs: Sequence[Log], settings: Settings, engine: Engine) -> list[dict[str, Any]]:
    """Stage 1: those that are not done. Returns all rows."""
    remove_others(settings.out, "logs", "row.json", _names(logs))
    waiting = [log for log in logs if finished_row(log, settings) is None]
    costs = [max(LEAST_SECONDS, SECONDS_A_MB * _size(log.path) / 1e6) for log in waiting]
    chunks = in_chunks(waiting, costs, engine.workers)
    engine.say(f"{len(logs)} logs, {len(logs) - len(waiting)} of them done before, {len(chunks)} tasks on {engine.workers} workers")
    engine.map("maps", functools.partial(_map_chunk, settings=settings), chunks)
    rows = []
    for log in logs:
        row = finished_row(log, settings) or {"number": log.number, "log": log.name, "status": "broken", "cause": f"{log.name}: changed while it was read"}
        rows.append({"scans": None, "way_m": None, "loops": None, "closure_m": None, "probability": None, "version": "", **row, "folder": log.folder})
    return rows


def _map_chunk(chunk: Sequence[Log], settings: Settings) -> None:
    for log in chunk:
        map_log(log, settings)


def _size(path: str) -> int:
    try:
        return sum(p.stat().st_size for p in pathlib.Path(path).rglob("*")) if os.path.isdir(path) else os.path.getsize(path)
    except OSError:
        return 0


def find_ties(logs: Sequence[Log], rows: Sequence[dict[str, Any]], settings: Settings, engine: Engine) -> list[Tie]:
    """Stage 2. What it found is kept until a log changes."""
    kept = pathlib.Path(settings.out) / "ties.json"
    key = digest([row.get("key") for row in rows])
    done = read_json(kept)
    if isinstance(done, dict) and done.get("key") == key:
        return [Tie(t["a"], t["b"], (t["T_a_b"][0], t["T_a_b"][1], t["T_a_b"][2]), t["witnesses"], t["checked"]) for t in done["ties"]]
    placed = [k for k, row in enumerate(rows) if row["status"] != "broken"]  # places in the index are numbers of this list
    folders = [str(settings.place(logs[k])) for k in placed]
    index, begin = pathlib.Path(settings.out) / "index", cpu_time()
    views = write_index(index, [load_views(folder) for folder in folders])
    engine.count("index", cpu_time() - begin)
    engine.say(f"{views} views of {len(placed)} logs in one index")
    queries = in_chunks(range(len(placed)), [SECONDS_A_QUERY] * len(placed), engine.workers)
    found = engine.map("places", functools.partial(_query_chunk, folders=folders, index=str(index)), queries)
    pairs: dict[tuple[int, int], set[tuple[int, int]]] = {}
    for a, b, i, j in (w for chunk in found for w in chunk):
        pairs.setdefault((a, b), set()).add((i, j))
    asked = [(a, b, sorted(views)) for (a, b), views in sorted(pairs.items())]
    checks = in_chunks(asked, [0.02] * len(asked), engine.workers)
    tied = engine.map("ties", functools.partial(_check_chunk, folders=folders), checks)
    ties = [dataclasses.replace(tie, a=placed[tie.a], b=placed[tie.b]) for chunk in tied for tie in chunk]
    write_json(kept, {"key": key, "ties": [dataclasses.asdict(tie) for tie in ties]})
    return ties


@functools.lru_cache(maxsize=400)
def load_views(folder: str) -> dict[str, Any]:
    """What stage 1 kept of a log for stage 2."""
    with np.load(pathlib.Path(folder) / "views.npz") as file:
        return {name: file[name] for name in file.files}


def _query_chunk(queries: Sequence[int], folders: Sequence[str], index: str) -> list[tuple[int, int, int, int]]:
    """Witnesses of some logs, as (a, b, view of a, view of b) with a < b."""
    places = read_index(pathlib.Path(index))
    out = []
    for log in queries:
        alike = alike_views(places, log)
        others = {int(k): load_views(folders[int(k)]) for k in np.unique(alike[:, 1])}
        for i, other, j in witnesses_of(load_views(folders[log]), others, alike):
            out.append((log, other, i, j) if log < other else (other, log, j, i))
    return out


def _check_chunk(asked: Sequence[tuple[int, int, list[tuple[int, int]]]], folders: Sequence[str]) -> list[Tie]:
    ties = []
    for a, b, pairs in asked:
        tie = tie_of(a, b, load_views(folders[a]), load_views(folders[b]), pairs)
        if tie is not None:
            ties.append(tie)
    return ties


def write_results(logs: Sequence[Log], rows: Sequence[dict[str, Any]], ties: Sequence[Tie], grouping: Grouping, mapped: Sequence[dict[str, Any]],
                  errors: Sequence[str], settings: Settings, times: bool) -> None:
    """fleet.sqlite, groups.json, report.html."""
    out = pathlib.Path(settings.out)
    costs = [(read_json(settings.place(log) / "cost.json") or {}) if times else {} for log in logs]
    groups = groups_file(logs, rows, mapped)
    write_json(out / "groups.json", groups)
    write_tables(out / "fleet.sqlite", rows, groups, ties, grouping.contradicted, costs)
    write_text(out / "report.html", format_report(rows, groups, errors, costs))
