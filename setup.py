"""Builds the module and the command with CMake for pip; what the package is stands in pyproject.toml."""
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).resolve().parent
VERSION = re.search(r"project\(phasescan VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1]


class CMakeBuild(build_ext):
    """One build for all: the module with everything it needs inside, and the command beside it."""

    def run(self):
        there = os.environ.get("PHASESCAN_BUILD_DIR")  # a build of the same sources with the module and the command
        build = pathlib.Path(there or self.build_temp).resolve()
        if not there:
            self.compile(build)
        made = build / "python" / "phasescan"
        folder = pathlib.Path(self.get_ext_fullpath("phasescan._core")).resolve().parent
        (folder / "bin").mkdir(parents=True, exist_ok=True)
        shutil.copy2(next(made.glob("_core*.so")), self.get_ext_fullpath("phasescan._core"))
        shutil.copy2(build / "bin" / "phasescan", folder / "bin" / "phasescan")

    def compile(self, build):
        build.mkdir(parents=True, exist_ok=True)
        ninja = ["-G", "Ninja"] if shutil.which("ninja") else []
        subprocess.run(["cmake", "-S", ROOT, "-B", build, *ninja, "-DCMAKE_BUILD_TYPE=Release", "-DPHASESCAN_PYTHON=ON", "-DPHASESCAN_BUILD_TESTS=OFF",
                        "-DPHASESCAN_BUILD_BENCH=OFF", "-DPHASESCAN_INSTALL=OFF", f"-DPython_EXECUTABLE={sys.executable}",
                        *shlex.split(os.environ.get("CMAKE_ARGS", ""))], check=True)
        jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL", str(os.cpu_count() or 1))
        subprocess.run(["cmake", "--build", build, "-j", jobs, "--target", "phasescan_python", "phasescan_app"], check=True)


setup(version=VERSION, ext_modules=[Extension("phasescan._core", sources=[])], cmdclass={"build_ext": CMakeBuild})
