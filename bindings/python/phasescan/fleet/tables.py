"""What came out, as SQLite: fleet.sqlite."""
from __future__ import annotations

import pathlib
import sqlite3
from typing import Any, Sequence

from .files import write_whole
from .ties import Tie

COLUMNS = ("number", "log", "status", "cause", "scans", "way_m", "loops", "closure_m", "probability", "version", "folder")
SCHEMA = """
CREATE TABLE logs (number INTEGER PRIMARY KEY, log TEXT, status TEXT, cause TEXT, scans INTEGER, way_m REAL, loops INTEGER, closure_m REAL,
                   probability REAL, version TEXT, folder TEXT, "group" INTEGER);
CREATE TABLE groups (number INTEGER PRIMARY KEY, logs INTEGER, map TEXT);
CREATE TABLE ties (a INTEGER, b INTEGER, witnesses INTEGER, checked INTEGER, x_m REAL, y_m REAL, theta REAL, contradicted INTEGER);
CREATE TABLE timing (number INTEGER PRIMARY KEY, cpu_s REAL, peak_mb REAL);
CREATE VIEW fleet AS SELECT logs.*, cpu_s, peak_mb FROM logs LEFT JOIN timing USING (number) ORDER BY number;
"""


def write_tables(path: pathlib.Path, rows: Sequence[dict[str, Any]], groups: Sequence[dict[str, Any]], ties: Sequence[Tie], contradicted: Sequence[Tie],
                 costs: Sequence[dict[str, Any]]) -> None:
    """Writes the file anew: the same rows give the same bytes; times stand in table `timing` alone."""
    group_of = {name: number for number, group in enumerate(groups, 1) for name in group["logs"]}

    def write(name: str) -> None:
        base = sqlite3.connect(name, isolation_level=None)
        base.execute("BEGIN")
        for statement in SCHEMA.strip().split(";\n"):
            base.execute(statement)
        base.executemany(f"INSERT INTO logs VALUES ({', '.join('?' * 12)})", [(*(row.get(c) for c in COLUMNS), group_of.get(row["log"])) for row in rows])
        base.executemany("INSERT INTO groups VALUES (?, ?, ?)", [(k, len(g["logs"]), g["map"]) for k, g in enumerate(groups, 1)])
        base.executemany("INSERT INTO ties VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
                         [(t.a + 1, t.b + 1, t.witnesses, t.checked, *t.T_a_b, int(t in contradicted)) for t in ties])
        base.executemany("INSERT INTO timing VALUES (?, ?, ?)", [(row["number"], c.get("cpu_s"), c.get("peak_mb")) for row, c in zip(rows, costs)])
        base.execute("COMMIT")
        base.close()

    write_whole(path, write)
