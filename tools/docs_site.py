#!/usr/bin/env python3
"""Lays out what Sphinx makes the site of. docs_site.py COMMAND FOLDER

The pages of docs/ and the README as they are, with links that hold inside the site; and the reference, generated: commands from their --help,
Python from the module, C++ from the public headers, examples side by side.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys

import phasescan

ROOT = pathlib.Path(__file__).resolve().parent.parent
PARTS = {
    "Start": ["start", "install", "coming-from", "troubleshooting", "limits"],
    "Guides": ["match", "slam", "localise", "live", "ros2", "python", "calibrate", "fleet", "simulator", "examples/README"],
    "Concepts": ["concepts", "global", "fft_icp", "slam-method", "slam-limits", "places", "architecture"],
    "Reference": ["reference/commands", "parameters", "reference/python", "reference/headers", "logs", "state-file"],
    "Results": ["RESULTS", "results/matching", "results/honesty", "results/time", "results/slam", "results/localise", "results/live", "results/fleets", "results/files", "results/results-json", "rivals"],
    "Project": ["CONTRIBUTING", "CHANGELOG", "licences"],
}


def linked(text, folder, site_folder="."):
    """The text of a page of `folder`, its links as a page in `site_folder` has them: pages by their place, other files by their name alone."""
    def place(match):
        label, target, anchor = match[1], match[2], match[3] or ""
        if re.match(r"[a-z]+:", target) or not target:
            return match[0]
        path = (folder / target).resolve().relative_to(ROOT).as_posix()
        path = re.sub(r"^(examples/\d\d_\w+)\.(cpp|py)$", r"\1.md", path.removeprefix("docs/"))
        if not path.endswith((".md", ".svg", ".png")) or path.startswith("ros2/"):
            return f"{label[1:-1]} (`{path}`)"
        return f"{label}({os.path.relpath(path, site_folder)}{anchor})"

    return re.sub(r"(!?\[[^\]]*\])\(([^)#\s]*)(#[^)\s]*)?\)", place, text)


def put(target, text):
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(text)


def pages(site):
    for page in sorted((ROOT / "docs").rglob("*.md")):
        place = page.relative_to(ROOT / "docs")
        put(site / place, linked(page.read_text(), page.parent, place.parent))
    for name in ("CHANGELOG.md", "CONTRIBUTING.md", "examples/README.md"):
        put(site / name, linked((ROOT / name).read_text(), (ROOT / name).parent, pathlib.Path(name).parent))
    for picture in [*(ROOT / "docs").glob("*.svg"), *(ROOT / "docs/figures").iterdir()]:
        target = site / picture.relative_to(ROOT / "docs")
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(picture, target)


def index(site):
    text = linked((ROOT / "README.md").read_text(), ROOT)
    trees = [f"```{{toctree}}\n:caption: {part}\n:hidden:\n:maxdepth: 1\n\n" + "\n".join(names) + "\n```\n" for part, names in PARTS.items()]
    put(site / "index.md", text + "\n" + "\n".join(trees))


def commands(site, command):
    def help_of(*words):
        return subprocess.run([command, *words, "--help"], text=True, capture_output=True, check=True).stdout.rstrip()

    listed = help_of()
    names = re.findall(r"^  ([a-z]+) {2,}", listed[listed.index("Commands") if "Commands" in listed else listed.index("Subcommands"):], re.M)
    text = "# Commands\n\nAs `phasescan COMMAND --help` prints it; `phasescan man COMMAND` is the same as a manual page.\n"
    text += f"\n```text\n{listed}\n```\n"
    for name in names:
        text += f"\n## {name}\n\n```text\n{help_of(name)}\n```\n"
    put(site / "reference/commands.md", text)
    return names


PYTHON = {
    "Matching": ["match", "match_many", "Matcher", "Reference", "MatchResult", "MatchAlternative", "MatchResults", "MatchOptions"],
    "Scans, poses, maps": ["Scan", "RangeMeasurement", "Pose2", "Twist2", "TrinaryMap", "plot"],
    "Odometry and SLAM": ["Slam", "ScanUpdate", "SlamResult", "RunVerdict", "SlamState", "SlamOptions", "Odometry", "OdometryUpdate", "OdometryOptions"],
    "Localisation": ["LocalizationMap", "Localizer", "locate", "LocalizationUpdate", "PoseEstimate", "LocalizeOptions"],
    "A sensor plugged in": ["live", "Live", "LiveUpdate"],
    "Logs, simulator, evaluation": ["open_log", "LogReader", "LogEntry", "simulate", "SimulatedLog", "evaluate"],
    "Errors": ["InputError", "OptionError", "StateError", "SystemError"],
}


def python(site):
    """What people use first comes first. Every public name stands in one part."""
    public = {name for name in phasescan.__all__ if name != "__version__"}
    listed = [name for names in PYTHON.values() for name in names]
    if public.symmetric_difference(listed) or len(listed) != len(public):
        sys.exit(f"docs_site: names of the module and of its reference differ: {', '.join(sorted(public.symmetric_difference(listed))) or 'one stands twice'}")
    text = "# Python, name by name\n\n```{eval-rst}\n.. automodule:: phasescan\n```\n"
    for part, names in PYTHON.items():
        entries = "\n".join(f".. {'autofunction' if name[0].islower() else 'autoexception' if name.endswith('Error') else 'autoclass'}:: phasescan.{name}"
                            + ("" if name[0].islower() else "\n   :members:") + "\n" for name in names)
        text += f"\n## {part}\n\n```{{eval-rst}}\n{entries}```\n"
    put(site / "reference/python.md", text)


def headers(site):
    names = sorted(p.relative_to(ROOT / "include").as_posix() for p in (ROOT / "include").rglob("*.hpp"))
    listed = "\n".join(f"headers/{name.removesuffix('.hpp').replace('/', '-')}" for name in names)
    put(site / "reference/headers.md", "# C++, header by header\n\nThe public headers, as they are: what stands there is the documentation.\n\n"
        f"```{{toctree}}\n:maxdepth: 1\n\n{listed}\n```\n")
    for name in names:
        code = (ROOT / "include" / name).read_text()
        put(site / f"reference/headers/{name.removesuffix('.hpp').replace('/', '-')}.md", f"# {name}\n\n````cpp\n{code}````\n")


def examples(site):
    numbers = sorted({p.stem for p in (ROOT / "examples").glob("[0-9]*_*.*")})
    for name in numbers:
        text = f"---\norphan: true\n---\n\n# {name[:2]} {name[3:].replace('_', ' ')}\n"
        for ending, kind in ((".cpp", "cpp"), (".py", "python")):
            path = ROOT / "examples" / f"{name}{ending}"
            if path.exists():
                text += f"\n````{kind}\n{path.read_text()}````\n"
        put(site / f"examples/{name}.md", text)


def main():
    command, site = sys.argv[1], pathlib.Path(sys.argv[2])
    shutil.rmtree(site, ignore_errors=True)
    site.mkdir(parents=True)
    shutil.copy(ROOT / "docs/site/conf.py", site)
    pages(site)
    index(site)
    names = commands(site, command)
    python(site)
    headers(site)
    examples(site)
    print(f"{len(list(site.rglob('*.md')))} pages, {len(names)} commands")


if __name__ == "__main__":
    main()
