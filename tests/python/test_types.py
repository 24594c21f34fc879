"""The type stubs: under mypy --strict, and against the module."""
import ast
import inspect
import pathlib
import subprocess
import sys

import pytest

import phasescan

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
CACHE = pathlib.Path(phasescan.__file__).parent.parent / "mypy-cache"


def test_the_types_hold_under_mypy_strict(tmp_path):
    pytest.importorskip("mypy")
    used = tmp_path / "used.py"
    used.write_text("import numpy as np\nimport phasescan\n\n"
                    "result = phasescan.match(np.ones(360), [1.0] * 360, guess=(0, 0, 0), fast=True)\n"
                    "x, y, theta = result.pose\nz: float = x + result.pose.theta\n"
                    "for entry in phasescan.open_log('a.log'):\n    update = phasescan.Slam().add(entry, laser='a')\n")
    folder = pathlib.Path(phasescan.__file__).parent
    told = subprocess.run([sys.executable, "-m", "mypy", "--config-file", ROOT / "pyproject.toml", "--cache-dir", CACHE, folder, used], cwd=tmp_path,
                          capture_output=True, text=True, env={"MYPYPATH": str(folder.parent), "PATH": "/usr/bin:/bin"})
    assert told.returncode == 0, told.stdout + told.stderr
    used.write_text("import phasescan\nphasescan.match(3, None)\n")
    told = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--cache-dir", CACHE, used], cwd=tmp_path, capture_output=True, text=True,
                          env={"MYPYPATH": str(folder.parent), "PATH": "/usr/bin:/bin"})
    assert told.returncode == 1 and "arg-type" in told.stdout


def test_the_stubs_are_of_the_module(tmp_path):
    pytest.importorskip("mypy.stubtest")
    (tmp_path / "allow.txt").write_text(r"phasescan\._core\..*\.__init__" + "\n" + r"phasescan\._core\._.*" + "\n"
                                        r"phasescan\._core\..*\.__(array|hash|eq|iter|getitem)__" + "\n")
    folder = pathlib.Path(phasescan.__file__).parent
    told = subprocess.run([sys.executable, "-m", "mypy.stubtest", "phasescan._core", "--ignore-positional-only", "--concise", "--allowlist", tmp_path / "allow.txt",
                           "--ignore-unused-allowlist"], cwd=tmp_path, capture_output=True, text=True,
                          env={"PYTHONPATH": str(folder.parent), "MYPYPATH": str(folder.parent), "PATH": "/usr/bin:/bin"})
    missing = [line for line in told.stdout.splitlines() if "is not present" in line]
    assert not missing, "\n".join(missing)


def test_help_shows_the_arguments_that_the_stubs_have():
    stubs = ast.parse((pathlib.Path(phasescan.__file__).parent / "_core.pyi").read_text())
    functions = {item.name: item.args for item in stubs.body if isinstance(item, ast.FunctionDef)}
    assert set(functions) == {"match", "match_many", "locate", "open_log", "live", "simulate", "evaluate"}
    for name, args in functions.items():
        shown = inspect.signature(getattr(phasescan, name)).parameters.values()
        kinds = inspect.Parameter
        assert [p.name for p in shown if p.kind == kinds.POSITIONAL_OR_KEYWORD] == [a.arg for a in args.args], name
        assert [p.name for p in shown if p.kind == kinds.KEYWORD_ONLY] == [a.arg for a in args.kwonlyargs], name
        assert [p.name for p in shown if p.kind == kinds.VAR_KEYWORD] == ([args.kwarg.arg] if args.kwarg else []), name
        required = [p.name for p in shown if p.default is kinds.empty and p.kind != kinds.VAR_KEYWORD]
        assert required == [a.arg for a in args.args[:len(args.args) - len(args.defaults)]], name
    # As the contract has it.
    match = inspect.signature(phasescan.match).parameters
    assert (match["angle_min"].default, match["range_min"].default, match["range_max"].default, match["guess"].default, match["method"].default) == (
        0.0, 0.0, None, None, "global")
    assert "--" not in phasescan.match.__doc__.splitlines()[:3]
