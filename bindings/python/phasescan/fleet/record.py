"""Stage 1: a map, a state, a verdict and a summary of one log, by the command in a process of its own.

A log that makes the command fail, or ends it, is a row that says so; the worker goes on.
"""
from __future__ import annotations

import dataclasses
import io
import json
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import time
from typing import IO, Any, Collection, Sequence

import numpy as np

from .._core import __version__, _places
from .files import digest, read_json, write_json, write_whole
from .manifest import Log

KEPT = ("map.yaml", "map.pgm", "map.png", "trajectory.tum", "summary.json", "report.html", "run.state")


@dataclasses.dataclass(frozen=True)
class Settings:
    """What is the same for all logs of a run."""

    out: str
    command: str
    arguments: tuple[str, ...] = ()
    limit_s: float = 3600.0

    def place(self, log: Log) -> pathlib.Path:
        """The folder of a log's results."""
        return pathlib.Path(self.out) / log.folder


@dataclasses.dataclass
class Ended:
    """How a process ended, and what it took."""

    code: int
    text: str    # the end of what it said on standard error
    output: str  # and of what it printed
    cpu_s: float
    peak_mb: float


# A program whose worker is killed would go on with nobody to take its results.
_ENDS_WITH_US = ("setpriv", "--pdeathsig", "KILL") if shutil.which("setpriv") else ()


def run_command(arguments: Sequence[str], limit_s: float) -> Ended:
    """Runs a program to its end, or to its limit, and counts its CPU time and memory."""
    with tempfile.TemporaryFile() as told, tempfile.TemporaryFile() as printed:
        process = subprocess.Popen([*_ENDS_WITH_US, *arguments], stdin=subprocess.DEVNULL, stdout=printed, stderr=told)
        until = time.monotonic() + limit_s
        pause = 0.002
        try:
            while True:
                pid, status, used = os.wait4(process.pid, os.WNOHANG)
                if pid:
                    break
                if time.monotonic() > until:
                    process.kill()
                    _, status, used = os.wait4(process.pid, 0)
                    break
                time.sleep(pause)
                pause = min(pause * 1.5, 0.05)
        except BaseException:
            process.kill()
            process.wait()
            raise
        process.returncode = os.waitstatus_to_exitcode(status)
        text, output = _end_of(told), _end_of(printed)
    return Ended(process.returncode, text, output, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024)


def _end_of(file: IO[bytes]) -> str:
    file.seek(0, io.SEEK_END)
    file.seek(max(0, file.tell() - 20000))
    return file.read().decode(errors="replace")


def key_of(log: Log, settings: Settings) -> str:
    """By which a log that is done is known again: its bytes' size and time, the build, the arguments."""
    paths = sorted(p for p in pathlib.Path(log.path).rglob("*")) if os.path.isdir(log.path) else [pathlib.Path(log.path)]
    facts = []
    for path in paths:
        try:
            stat = path.stat()
            facts.append([path.name, stat.st_size, stat.st_mtime_ns])
        except OSError:
            facts.append([path.name, -1, -1])
    return digest([log.name, facts, __version__, list(settings.arguments)])


def finished_row(log: Log, settings: Settings) -> dict[str, Any] | None:
    """The row of a log that is done; None where it is not, or its file, the build or the arguments have changed."""
    row = read_json(settings.place(log) / "row.json")
    return row if isinstance(row, dict) and row.get("key") == key_of(log, settings) else None


def map_log(log: Log, settings: Settings) -> None:
    """Maps one log into its folder, row.json last; what is done already is left."""
    if finished_row(log, settings) is not None:
        return
    place = settings.place(log)
    place.parent.mkdir(parents=True, exist_ok=True)
    key = key_of(log, settings)
    with tempfile.TemporaryDirectory(dir=place.parent, prefix=".work-") as folder:
        work = pathlib.Path(folder)
        ended = run_command([settings.command, "slam", log.path, "--out", str(work), "--save", str(work / "run.state"), "--no-times", *settings.arguments],
                            settings.limit_s)
        row = row_of(log, ended, read_json(work / "summary.json"))
        row["key"] = key
        if row["status"] != "broken":
            closing = run_command([settings.command, "eval", "--trajectory", str(work / "trajectory.tum"), "--closure", log.path, "--json"], settings.limit_s)
            ended.cpu_s += closing.cpu_s
            row["closure_m"] = _closure(closing.output)
            _keep_views(work)
        place.mkdir(exist_ok=True)
        (place / "row.json").unlink(missing_ok=True)
        for name in (*KEPT, "views.npz"):
            if (work / name).exists():
                os.replace(work / name, place / name)
            else:
                (place / name).unlink(missing_ok=True)
    write_json(place / "cost.json", {"cpu_s": round(ended.cpu_s, 3), "peak_mb": round(ended.peak_mb, 1)})
    write_json(place / "row.json", row)


def row_of(log: Log, ended: Ended, summary: dict[str, Any] | None) -> dict[str, Any]:
    """What is told of a log, without times."""
    row: dict[str, Any] = {"number": log.number, "log": log.name, "status": "broken", "cause": _cause(log, ended), "scans": None, "way_m": None, "loops": None,
                           "closure_m": None, "probability": None, "version": __version__}
    if summary is None or ended.code not in (0, 1, 4):
        return row
    reasons = summary.get("reasons") or []
    row["status"] = summary.get("verdict", "done")
    row["probability"] = summary.get("verdict_probability")
    row["scans"] = summary["scans"]
    row["way_m"] = summary["path_length_m"]
    row["loops"] = summary["loops"]["accepted"]
    if reasons:
        row["cause"] = f"{reasons[0]['kind']}: {reasons[0]['what']}"
    elif ended.code == 0:
        row["cause"] = None
    return row


def _cause(log: Log, ended: Ended) -> str:
    """The last thing that the command said, or how it ended. Its own folders stand in no row."""
    said = [line[len("phasescan: "):] for line in ended.text.splitlines() if line.startswith("phasescan: ")]
    if ended.code < 0:
        what = signal.Signals(-ended.code).name
        return f"{log.name}: the command was ended by {what}" + (", it took too long or too much" if what == "SIGKILL" else "")
    text = said[-1] if said else f"{log.name}: the command ended with {ended.code}"
    return text.replace(log.path, log.name)


def _closure(text: str) -> float | None:
    """Median distance by which the trajectory is off where the robot came back; None where it did not."""
    try:
        median: float | None = json.loads(text)["translation_m"]["median"]
    except (ValueError, KeyError, TypeError):
        return None
    return median


def _keep_views(work: pathlib.Path) -> None:
    """What stage 2 compares. A state without a map has none."""
    views = _places.session_views(str(work / "run.state"))
    write_whole(work / "views.npz", lambda name: np.savez(name, **views))


def remove_others(out: str, kind: str, mark: str, own: Collection[str]) -> None:
    """Takes away what is of an earlier run or of a worker that died: folders of OUT/KIND that hold `mark`, but for `own`."""
    base = pathlib.Path(out) / kind
    for place in sorted(base.iterdir()) if base.is_dir() else ():
        if place.name.startswith(".work-") or place.name not in own and (place / mark).exists():
            shutil.rmtree(place, ignore_errors=True)
