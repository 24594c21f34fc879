"""The type stubs: under mypy --strict, and against the module."""
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
