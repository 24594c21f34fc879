#!/usr/bin/env python3
"""Makes docs/figures/slam-map.svg: a simulated flat, mapped without odometry, as report.html shows it.

  tools/slam_figure.py [COMMAND]      COMMAND: build/release/bin/phasescan
"""
import pathlib
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent.parent


def main():
    command = sys.argv[1] if len(sys.argv) > 1 else HERE / "build/release/bin/phasescan"
    with tempfile.TemporaryDirectory() as folder:
        log = pathlib.Path(folder, "flat.jsonl")
        subprocess.run([command, "simulate", "--world", "flat", "--sensor", "rplidar-a1", "--path", "tour", "--speed", "0.3", "--duration", "120",
                        "--seed", "3", "--out", log], check=True)
        subprocess.run([command, "slam", log, "--out", folder, "--no-times"], check=True)
        report = pathlib.Path(folder, "report.html").read_text()
    figure = re.search(r"<svg.*?</svg>", report, re.DOTALL)[0]
    (HERE / "docs/figures/slam-map.svg").write_text(figure + "\n")


if __name__ == "__main__":
    main()
