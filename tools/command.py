"""The command under measurement, recorded data, and tables of what came out. $PHASESCAN and $PHASESCAN_DATA name others."""
import os
import pathlib
import subprocess

HERE = pathlib.Path(__file__).resolve().parent.parent
COMMAND = os.environ.get("PHASESCAN", str(HERE / "build/release/bin/phasescan"))
DATA = pathlib.Path(os.environ.get("PHASESCAN_DATA", HERE.parent / "shared/data"))


def call(*words):
    """What it prints; its messages are dropped."""
    return subprocess.run([COMMAND, *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)


def markdown(header, rows, words=1):
    """@param words  columns from the left that hold words"""
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * words + "---:|" * (len(header) - words)]
    return "\n".join(lines + ["| " + " | ".join(str(c) for c in row) + " |" for row in rows]) + "\n"
