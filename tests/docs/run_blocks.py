#!/usr/bin/env python3
"""Runs the code of the documents. run_blocks.py SOURCE COMMAND PYTHON_FOLDER [PAGE...]

Each page runs in an empty folder of its own, its blocks in order: `sh` and `bash` with the command phasescan, `python` in one
interpreter, `yaml` as a file of options, or of a sensor. The lines of `cpp` must stand in an example, in their order; that is built and
run by a test of its own. Comments before a block change that:
  <!-- before: COMMANDS -->    shell commands that a reader does not see
  <!-- exit N -->              the next block ends with this exit code
  <!-- not run: REASON -->     the next block needs what a test has not (a sensor, ROS, root, minutes)
Whatever is run or not, and in the text too: a command and its flags must be those that `phasescan COMMAND --help` knows, and
links must lead to files and headings that are there.
"""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

# A comment of those above, or a block of code.
PART = re.compile(r"^<!-- *(before|exit|not run)\b:?\s*(.*?)\s*-->$|^```(\w*)\n(.*?)^```$", re.M | re.S)
LIMIT_S = 120
# What stands for something, in a line of usage.
PLACEHOLDER = re.compile(r"^[A-Z]{3,}$|\.\.\.")

INTERPRETER = """
import json, sys, traceback
names = {"__name__": "__main__"}
for line in sys.stdin:
    try:
        exec(compile(json.loads(line), "block", "exec"), names)
        print("\\0ok", flush=True)
    except BaseException:
        print("\\0" + json.dumps(traceback.format_exc()), flush=True)
"""


class Python:
    """One interpreter for the Python of a page."""

    def __init__(self, folder, environment):
        self.folder, self.environment, self.process = folder, environment, None

    def run(self, code):
        """None, or what went wrong."""
        if not self.process:
            self.process = subprocess.Popen([sys.executable, "-c", INTERPRETER], cwd=self.folder, env=self.environment, text=True,
                                            stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.process.stdin.write(json.dumps(code) + "\n")
        self.process.stdin.flush()
        for line in self.process.stdout:
            if line.startswith("\0"):
                return None if line[1:].strip() == "ok" else json.loads(line[1:])
        return "the interpreter ended"

    def close(self):
        if self.process:
            self.process.stdin.close()
            self.process.wait()


def shell(code, folder, environment, expected=0):
    try:
        done = subprocess.run(["bash", "-eu", "-o", "pipefail", "-c", code], cwd=folder, env=environment, text=True, capture_output=True,
                              timeout=LIMIT_S)
    except subprocess.TimeoutExpired:
        return f"not done in {LIMIT_S} s"
    return None if done.returncode == expected else f"exit {done.returncode}, expected {expected}\n{done.stdout[-800:]}{done.stderr[-800:]}"


def plain(code):
    """The lines without indentation, blank lines and comments behind them."""
    lines = (re.sub(r"\s*//.*$", "", line).strip() for line in code.splitlines())
    return [line for line in lines if line]


def stands_in(lines, example):
    """Whether the lines stand in the example, in their order."""
    rest = iter(example)
    return all(line in rest for line in lines)


def flags_of(command, known):
    """The flags of a command by its --help; None for a command that is none."""
    if command not in known:
        done = subprocess.run([known["phasescan"], *command.split(), "--help"], text=True, capture_output=True)
        known[command] = set(re.findall(r"--[a-z][a-z0-9-]*", done.stdout)) | {"--help"} if done.returncode == 0 else None
    return known[command]


def wrong_flags(text, known):
    """Commands and flags that do not exist, in code of any kind."""
    wrong = []
    for words in re.findall(r"(?:^|[\s`(])phasescan ([^\n`|;&#]*)", text.replace("\\\n", " "), re.M):
        command, *rest = words.split() or [""]
        if not re.fullmatch(r"[a-z]+", command) or known is None:
            continue
        if rest and command == "bench" and re.fullmatch("[a-z]+", rest[0]):
            command += " " + rest[0]
        flags = flags_of(command, known)
        if flags is None:
            wrong.append(f"there is no command `phasescan {command}`")
            continue
        wrong += [f"`phasescan {command}` has no {flag}" for flag in re.findall(r"(?:^|[\s\[(])(--[a-z][a-z0-9-]*)", " ".join(rest))
                  if flag not in flags]
    return wrong


def dead_links(path, text):
    """Links to files that are not there, and to headings that a page has not."""
    dead = []
    for target, anchor in re.findall(r"\]\(([^)#\s]*)(?:#([^)\s]*))?\)", text):
        page = path.parent / target if target else path
        if re.match(r"[a-z]+:", target):
            continue
        headings = re.findall(r"^#+ (.*)$", page.read_text(), re.M) if page.suffix == ".md" and page.exists() else []
        names = {re.sub(r"[^\w -]", "", heading).strip().lower().replace(" ", "-") for heading in headings}
        if not page.exists() or (anchor and anchor not in names):
            dead.append(f"{path}: the link to {target}{'#' + anchor if anchor else ''} leads nowhere")
    return dead


def run_block(kind, code, marks, page):
    if kind in ("sh", "bash"):
        return shell(code, page["folder"], page["environment"], int(marks.get("exit", 0)))
    if kind == "python":
        return page["python"].run(code)
    if kind == "yaml":
        (page["folder"] / "block.yaml").write_text(code)
        reads = "simulate --duration 1 --out of-block.jsonl --sensor" if code.startswith("like:") else "config --dump --config"
        return shell(f"phasescan {reads} block.yaml", page["folder"], page["environment"])
    if kind == "cpp":
        return None if any(stands_in(plain(code), example) for example in page["examples"]) else "stands in no example"
    return None  # text, json and the like: to be read


def check_page(path, page):
    """(blocks run, blocks not run, [what is wrong])."""
    text = path.read_text()
    run = left = 0
    parts = list(PART.finditer(text))
    code = [*re.findall(r"`[^`\n]+`", text), *(p[4] for p in parts if p[4])]
    wrong = dead_links(path, text) + [f"{path}: {w}" for w in wrong_flags("\n".join(code), page["known"])]
    marks = {}
    for part in parts:
        place = f"{path}:{text.count(chr(10), 0, part.start()) + 1}"
        name, value, kind, code = part.groups()
        if name == "before":
            trouble = shell(value, page["folder"], page["environment"])
            wrong += [f"{place}: {trouble}"] if trouble else []
            continue
        if name:
            marks[name] = value
            continue
        if not kind:
            wrong.append(f"{place}: a block without a language (text, for what is only read)")
        if "not run" in marks:
            left += 1
            wrong += [f"{place}: not run, and no reason"] if len(marks["not run"]) < 8 else []
        else:
            trouble = run_block(kind, code, marks, page)
            run += kind in ("sh", "bash", "python", "yaml", "cpp")
            wrong += [f"{place}: {trouble}"] if trouble else []
        marks = {}
    return run, left, wrong


def main():
    source, command, modules = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3]
    pages = [pathlib.Path(p) for p in sys.argv[4:]] or [source / "README.md", source / "CONTRIBUTING.md", source / "examples/README.md", *sorted((source / "docs").rglob("*.md"))]
    examples = [plain(p.read_text()) for p in sorted((source / "examples").glob("*.cpp"))]
    wrong = []
    known = {"phasescan": str(command)}
    for path in pages:
        with tempfile.TemporaryDirectory() as folder:
            environment = {**os.environ, "PATH": f"{command.parent}:{pathlib.Path(sys.executable).parent}:{os.environ['PATH']}", "PYTHONPATH": modules, "MPLBACKEND": "Agg",
                           "PYTHONDONTWRITEBYTECODE": "1", "SOURCE": str(source.resolve()), "NO_COLOR": "1"}
            page = {"folder": pathlib.Path(folder), "environment": environment, "known": known, "examples": examples,
                    "python": Python(folder, environment)}
            run, left, found = check_page(path, page)
            page["python"].close()
        print(f"{path.name}: {run} blocks run, {left} not", flush=True)
        wrong += found
    for line in wrong:
        print(line, file=sys.stderr)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
