#!/usr/bin/env python3
"""The functions that users' programs link: every one that a public header declares and a library defines.

    tools/public_symbols.py --check LIBRARIES   each name of the list is defined by a shared library in that folder
    tools/public_symbols.py --headers           the list names what the headers declare now (needs clang 14 and the libraries' headers)
    tools/public_symbols.py --write             writes the list from the headers

The list, tools/public_symbols.txt, is of the major version in CMakeLists.txt. From version 1.0 on a name may only be added
to it: a program that was linked before must still start. Names of C++'s binary interface (Itanium), sorted.
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
LIST = ROOT / "tools" / "public_symbols.txt"
FUNCTIONS = {"FunctionDecl", "CXXMethodDecl", "CXXConstructorDecl", "CXXDestructorDecl", "CXXConversionDecl"}


def is_linked(declaration: dict) -> bool:
    """True for a function whose body stands in a library."""
    if declaration.get("isImplicit") or declaration.get("explicitlyDeleted") or declaration.get("explicitlyDefaulted"):
        return False
    if declaration.get("inline") or declaration.get("constexpr") or declaration.get("pure"):
        return False
    return not any(part.get("kind") == "CompoundStmt" for part in declaration.get("inner", []))


def linked_names(node: dict, found: set[str]) -> None:
    kind = node.get("kind")
    if kind in FUNCTIONS:
        if is_linked(node) and "mangledName" in node:
            found.add(node["mangledName"])
        return
    if kind in ("NamespaceDecl", "CXXRecordDecl", "LinkageSpecDecl"):
        for part in node.get("inner", []):
            linked_names(part, found)


def declared() -> set[str]:
    """What the public headers declare. Templates are compiled by those who use them."""
    with tempfile.NamedTemporaryFile("w", suffix=".cpp") as source:
        source.write("#include <phasescan/phasescan.hpp>\n")
        source.flush()
        eigen = subprocess.run(["pkg-config", "--cflags", "eigen3"], capture_output=True, text=True, check=True).stdout.split()
        text = subprocess.run(
            ["clang++-14", "-std=c++20", "-fsyntax-only", f"-I{ROOT}/include", *eigen, "-Xclang", "-ast-dump=json", "-Xclang",
             "-ast-dump-filter=phasescan", source.name], capture_output=True, text=True, check=True).stdout
    names: set[str] = set()
    decoder, at = json.JSONDecoder(), 0
    while at < len(text):
        node, at = decoder.raw_decode(text, at)
        linked_names(node, names)
        while at < len(text) and text[at].isspace():
            at += 1
    return names


def exported(folder: pathlib.Path) -> set[str]:
    libraries = sorted(folder.glob("libphasescan_*.so"))
    if not libraries:
        sys.exit(f"{folder} has no shared library of phasescan; expected a build with -DBUILD_SHARED_LIBS=ON")
    names = set()
    for library in libraries:
        lines = subprocess.run(["nm", "-D", "--defined-only", library], capture_output=True, text=True, check=True).stdout
        names |= {line.split()[-1] for line in lines.splitlines()}
    return names


def listed() -> set[str]:
    return set(LIST.read_text().split())


def report(title: str, names: set[str]) -> None:
    plain = subprocess.run(["c++filt"], input="\n".join(sorted(names)), capture_output=True, text=True, check=True).stdout
    print(f"{title}:\n{plain}", file=sys.stderr)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--check", type=pathlib.Path, metavar="LIBRARIES")
    what.add_argument("--headers", action="store_true")
    what.add_argument("--write", action="store_true")
    options = parser.parse_args()
    if options.write:
        LIST.write_text("\n".join(sorted(declared())) + "\n")
        return 0
    if options.check:
        missing = listed() - exported(options.check)
        if missing:
            report("Listed in tools/public_symbols.txt and not in the libraries", missing)
        return 1 if missing else 0
    now, before = declared(), listed()
    if now - before:
        report("Declared and not listed (tools/public_symbols.py --write)", now - before)
    if before - now:
        report("Listed and no longer declared (programs that were linked before would not start)", before - now)
    return 1 if now != before else 0


if __name__ == "__main__":
    sys.exit(main())
