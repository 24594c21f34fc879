"""One build that all mutants share, and what differs from it for one of them.

The libraries are built shared and without optimisation beyond -O1, once. A mutant compiles only the objects that see the
changed file, from a folder of its own that stands before the source tree, and links only the libraries and test programs
that hold such an object. The source tree and the build are never touched, so several mutants can be made at the same time.
"""
import json
import os
import pathlib
import re
import shlex
import subprocess

from .entries import ROOT

# Kernels once, for the baseline CPU: what mutants change is the same for every target. NDEBUG as in a release build.
FLAGS = ["-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_CXX_FLAGS_RELEASE=-O1 -DNDEBUG", "-DCMAKE_CXX_FLAGS=-DHWY_COMPILE_ONLY_STATIC",
         "-DBUILD_SHARED_LIBS=ON", "-DCMAKE_EXE_LINKER_FLAGS=-Wl,--enable-new-dtags", "-DCMAKE_SHARED_LINKER_FLAGS=-Wl,--enable-new-dtags",
         "-DCMAKE_LINK_DEPENDS_NO_SHARED=ON", "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON", "-DPHASESCAN_BUILD_BENCH=OFF"]


class BuildFailed(Exception):
    """A mutant that does not compile or link: no mutant."""


class Build:
    def __init__(self, folder: pathlib.Path, programs, jobs):
        self.folder = folder
        run = lambda *command: subprocess.run(command, check=True, cwd=ROOT, stdout=subprocess.DEVNULL)  # noqa: E731
        if not (folder / "build.ninja").exists():
            run("cmake", "-S", str(ROOT), "-B", str(folder), "-G", "Ninja", *FLAGS)
        subprocess.run(["ninja", "-C", str(folder), f"-j{jobs}", *programs], check=True)
        self.commands = {}
        for entry in json.loads((folder / "compile_commands.json").read_text()):
            command = shlex.split(entry["command"])
            self.commands[command[command.index("-o") + 1]] = command
        self.objects_of = self.read_links(programs)  # {target: [objects]}
        wanted = {o for objects in self.objects_of.values() for o in objects}
        self.dependents = {}  # {source or header below ROOT: {objects}}
        for output, files in self.read_deps():
            for file in files if output in wanted else []:
                self.dependents.setdefault(file, set()).add(output)

    def ninja(self, *arguments):
        return subprocess.run(["ninja", "-C", str(self.folder), *arguments], check=True, capture_output=True, text=True).stdout

    def read_links(self, programs):
        """The test programs asked for and all shared libraries of ours, each with its objects."""
        found = {}
        text = (self.folder / "build.ninja").read_text().replace("$\n", " ")
        for target, inputs in re.findall(r"^build (\S+)[^:\n]*: CXX_(?:SHARED_LIBRARY|EXECUTABLE)_LINKER\S* ([^|\n]*)", text, re.M):
            if re.search(r"\.so(\.\d+)*$", target) or pathlib.Path(target).name in programs:
                found[target] = [word for word in inputs.split() if word.endswith(".o")]
        return found

    def read_deps(self):
        output, files = None, []
        for line in self.ninja("-t", "deps").splitlines():
            if line.startswith(" "):
                path = os.path.normpath(self.folder / line.strip())
                if path.startswith(str(ROOT)):
                    files.append(os.path.relpath(path, ROOT))
            elif ":" in line:
                output, files = line.split(":")[0], []
            elif output:
                yield output, files
        if output:
            yield output, files

    def compile(self, obj, overlay, out):
        command = self.commands[obj]
        while "ccache" in command[0]:
            command = command[1:]
        command = [word for word in command if word not in ("-Werror", "-MD")]
        made = [command[0], "-w", "-iquote", f"{overlay}/src", "-iquote", f"{overlay}/include", "-iquote", f"{overlay}/tests"]
        words = iter(command[1:])
        for word in words:
            if word in ("-MT", "-MF"):
                next(words)
            elif word == "-o":
                next(words)
                made += ["-o", str(out)]
            elif word == "-c":
                source = next(words)
                own = overlay / os.path.relpath(source, ROOT)
                made += ["-c", str(own if own.exists() else source)]
            else:
                # The overlay stands before every folder of the source tree, <...> of a public header too.
                if word.startswith("-I" + str(ROOT)):
                    made.append("-I" + str(overlay / os.path.relpath(word[2:], ROOT)))
                made.append(word)
        out.parent.mkdir(parents=True, exist_ok=True)
        self.call(made)

    def call(self, command):
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True)
        if done.returncode:
            raise BuildFailed("\n".join(line for line in done.stderr.splitlines() if "error" in line)[:600] or done.stderr[-600:])

    def make(self, file, text, work: pathlib.Path):
        """Compiles and links what a changed file reaches. Returns {target: path} of what was made; empty where the objects
        are the same bytes as without the change."""
        overlay = work / "overlay"
        (overlay / file).parent.mkdir(parents=True, exist_ok=True)
        (overlay / file).write_text(text)
        objects = {}
        for obj in sorted(self.dependents.get(file, ())):
            out = work / "objects" / obj
            self.compile(obj, overlay, out)
            if out.read_bytes() != (self.folder / obj).read_bytes():
                objects[obj] = str(out)
        made = {}
        for target, parts in self.objects_of.items():
            if not any(part in objects for part in parts):
                continue
            link = self.ninja("-t", "commands", "-s", target).strip().splitlines()[-1]
            link = shlex.split(re.sub(r"^:\s*&&\s*", "", link).split(" && ")[0])
            soname = next((word.split(",")[2] for word in link if word.startswith("-Wl,-soname,")), pathlib.Path(target).name)
            out = work / "linked" / soname
            out.parent.mkdir(parents=True, exist_ok=True)
            link = [objects.get(word, word) for word in link]
            link[link.index("-o") + 1] = str(out)
            self.call(link)
            made[target] = out
        return made
