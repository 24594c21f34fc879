"""The command line: ``python3 -m phasescan.fleet run MANIFEST --out DIR``."""
from __future__ import annotations

import argparse
import os
import pathlib
import subprocess
import sys
from typing import NoReturn, Sequence

from ..command import find_command
from .manifest import ManifestError, read_manifest
from .record import Settings

DONE, NOT_READABLE, SYSTEM, INTERRUPTED = 0, 2, 3, 130


class _Parser(argparse.ArgumentParser):
    """Wrong usage is one line, as of `phasescan`."""

    def error(self, message: str) -> NoReturn:
        self.exit(NOT_READABLE, f"phasescan: {message}; expected what `{self.prog} --help` says\n")


def parser() -> argparse.ArgumentParser:
    """What the command takes."""
    top = _Parser(prog="python3 -m phasescan.fleet", description="A map of each log, which logs share a place, a map of those that do.")
    commands = top.add_subparsers(dest="what", required=True)
    run = commands.add_parser("run", help="all of it; what is done already is left as it is")
    run.add_argument("manifest", metavar="MANIFEST", help="a text file with a log, a glob or a folder a line; names are relative to it")
    run.add_argument("--out", required=True, metavar="DIR", help="fleet.sqlite, report.html, groups.json, a folder for each log and group")
    where = run.add_mutually_exclusive_group()
    where.add_argument("--scheduler", metavar="ADDRESS", help="a Dask scheduler that runs, tcp://HOST:8786; its workers see the same files")
    where.add_argument("--workers", type=int, metavar="N", help="processes here; one a core unless given")
    run.add_argument("--config", metavar="FILE.yaml", help="options of `phasescan slam`, for all logs")
    run.add_argument("--odometry", choices=("auto", "none"), default="auto", help="as of `phasescan slam`")
    run.add_argument("--log-limit", type=float, default=3600.0, metavar="S", help="a log that takes longer is broken [s]")
    run.add_argument("--no-times", action="store_true", help="leave CPU times and memory out: the same bytes always")
    return top


def settings_of(flags: argparse.Namespace) -> Settings:
    """What is the same for all logs."""
    arguments = ["--odometry", flags.odometry]
    if flags.config:
        arguments += ["--config", str(pathlib.Path(flags.config).resolve())]
    return Settings(str(pathlib.Path(flags.out).resolve()), find_command(), tuple(arguments), flags.log_limit)


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command line. Returns its exit code."""
    flags = parser().parse_args(arguments)
    if flags.workers is not None and flags.workers < 1:
        return _fail(f"--workers: is {flags.workers}; expected 1 or more", NOT_READABLE)
    try:
        logs = read_manifest(flags.manifest)
    except ManifestError as error:
        return _fail(str(error), NOT_READABLE)
    try:
        settings = settings_of(flags)
        if flags.config and (refusal := _refusal_of(settings.command, flags.config)):
            return _fail(refusal, NOT_READABLE)
        try:
            os.makedirs(settings.out, exist_ok=True)
        except (FileExistsError, NotADirectoryError):
            return _fail(f"{flags.out}: is a file, or lies in one; expected a folder", NOT_READABLE)
        from .engine import open_engine, progress  # Dask takes a second to load
        from .run import run_fleet

        with open_engine(flags.scheduler, flags.workers or os.cpu_count() or 1, progress()) as engine:
            rows, errors = run_fleet(logs, settings, engine, not flags.no_times)
    except ModuleNotFoundError as error:
        return _fail(f"{error.name} is missing; expected Debian's python3-distributed", SYSTEM)
    except OSError as error:
        return _fail(str(error), SYSTEM)
    except KeyboardInterrupt:
        return _fail("stopped; what was done is kept, and the next run goes on from it", INTERRUPTED)
    broken = [row for row in rows if row["status"] == "broken"]
    for line in [row["cause"] for row in broken] + errors:
        print(f"phasescan: {line}", file=sys.stderr)
    print(f"{len(rows)} logs, {len(broken)} of them broken; open {settings.out}/report.html", file=sys.stderr)
    return DONE


def _refusal_of(command: str, config: str) -> str:
    """What the command has against a file of options; else nothing. Asked once, where each log would break on it."""
    told = subprocess.run([command, "config", "--dump", "--config", config], capture_output=True, text=True, check=False)
    return told.stderr.strip().removeprefix("phasescan: ") if told.returncode != DONE else ""


def _fail(text: str, code: int) -> int:
    print(f"phasescan: {text}", file=sys.stderr)
    return code
