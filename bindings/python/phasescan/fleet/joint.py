"""Stage 3: one map of the logs of a group, by `phasescan merge` of their states, with no guess."""
from __future__ import annotations

import dataclasses
import os
import pathlib
import shutil
import tempfile
from typing import Any, Sequence

from .files import digest, read_json, write_json
from .manifest import Log
from .record import Settings, run_command

KEPT = ("map.yaml", "map.pgm", "map.png", "trajectory.tum", "summary.json", "report.html")


@dataclasses.dataclass(frozen=True)
class Group:
    """Logs that belong together, in the manifest's order."""

    logs: tuple[Log, ...]

    @property
    def folder(self) -> str:
        """The folder of its results, below DIR."""
        return f"groups/{self.logs[0].number:06d}"


def map_group(group: Group, settings: Settings) -> dict[str, Any]:
    """Maps a group into its folder; what is done already is left.

    Returns
    -------
    dict
        parts: [{"logs": numbers, "map": path below DIR}], what hangs together by the map's own judgement, largest first; error.
    """
    place = pathlib.Path(settings.out) / group.folder
    key = digest([read_json(settings.place(log) / "row.json") for log in group.logs])
    done = read_json(place / "group.json")
    if isinstance(done, dict) and done.get("key") == key and done.get("error") is None:
        return done
    place.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=place.parent, prefix=".work-") as folder:
        ended = run_command(joint_command(group, settings, folder), settings.limit_s * len(group.logs))
        summary = read_json(pathlib.Path(folder) / "summary.json")
        if ended.code not in (0, 1, 4) or summary is None:
            told = [line for line in ended.text.splitlines() if line.startswith("phasescan: ")]
            result: dict[str, Any] = {"key": key, "parts": [], "error": told[-1][len("phasescan: "):] if told else f"the command ended with {ended.code}"}
        else:
            result = {"key": key, "parts": _parts(group, summary), "error": None}
        shutil.rmtree(place, ignore_errors=True)
        os.rename(folder, place)
        os.mkdir(folder)  # what the block takes away
    os.chmod(place, 0o755)
    write_json(place / "cost.json", {"cpu_s": round(ended.cpu_s, 3), "peak_mb": round(ended.peak_mb, 1)})
    write_json(place / "group.json", result)
    return result


def joint_command(group: Group, settings: Settings, folder: str) -> list[str]:
    """What maps the logs of a group together. Merged states tell their logs by name: where two have one, all are read anew, in order."""
    if len(_names(group)) == len(group.logs):
        states = [str(settings.place(log) / "run.state") for log in group.logs]
        return [settings.command, "merge", *states, "--out", folder, "--save", f"{folder}/run.state"]
    logs = [log.path for log in group.logs]
    return [settings.command, "slam", *logs, "--out", folder, "--save", f"{folder}/run.state", "--no-times", *settings.arguments]


def _names(group: Group) -> dict[str, int]:
    return {pathlib.PurePath(log.path).name: log.number for log in group.logs}


def _parts(group: Group, summary: dict[str, Any]) -> list[dict[str, Any]]:
    names = _names(group)
    by_name = len(names) == len(group.logs)
    parts: dict[str, list[int]] = {}
    for log, entry in zip(group.logs, summary["inputs"], strict=True):
        parts.setdefault(entry.get("folder", ""), []).append(names[entry["log"]] if by_name else log.number)
    return [{"logs": sorted(parts[name]), "map": "/".join(filter(None, (group.folder, name, "map.yaml")))} for name in sorted(parts, key=_number)]


def _number(name: str) -> int:
    return int(name) if name else 0


def groups_file(logs: Sequence[Log], rows: Sequence[dict[str, Any]], mapped: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """What groups.json holds: every log that has a map, in one group each, groups by their first log."""
    names = {log.number: log.name for log in logs}
    groups: list[tuple[int, dict[str, Any]]] = []
    seen: set[int] = set()
    for result in mapped:
        for part in result["parts"]:
            if len(part["logs"]) > 1:
                groups.append((part["logs"][0], {"logs": [names[n] for n in part["logs"]], "map": part["map"]}))
                seen.update(part["logs"])
    for log, row in zip(logs, rows):
        if log.number not in seen and row["status"] != "broken":
            groups.append((log.number, {"logs": [log.name], "map": f"{log.folder}/map.yaml"}))
    return [group for _, group in sorted(groups, key=lambda g: g[0])]
