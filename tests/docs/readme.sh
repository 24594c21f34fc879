#!/usr/bin/env bash
# What the documents say is what the project does. readme.sh SOURCE_DIR COMMAND
set -euo pipefail
fail() { echo "$1" >&2; exit 1; }

# The README's C++ stands, line for line, in an example that is built and run.
sed -n '/^```cpp$/,/^```$/p' "$1/README.md" | sed '1d;$d' >"${TMPDIR:-/tmp}/readme-cpp.$$"
trap 'rm -f "${TMPDIR:-/tmp}/readme-cpp.$$"' EXIT
[ -s "${TMPDIR:-/tmp}/readme-cpp.$$" ] || fail "README.md has no C++"
python3 - "${TMPDIR:-/tmp}/readme-cpp.$$" "$1/examples/02_where_am_i.cpp" <<'PYTHON' || fail "README.md and examples/02_where_am_i.cpp differ"
import sys
sys.exit(0 if open(sys.argv[1]).read() in open(sys.argv[2]).read() else 1)
PYTHON

# Its Python too, but for the blank lines that Python's style asks for, and that of docs/python.md is the same.
python3 - "$1" <<'PYTHON' || fail "the Python of README.md, docs/python.md and examples/02_where_am_i.py differ"
import pathlib, re, sys
root = pathlib.Path(sys.argv[1])
lines = lambda text: [line for line in text.splitlines() if line]
shown = [re.search("^```python\n(.*?)^```$", (root / name).read_text(), re.M | re.S)[1] for name in ("README.md", "docs/python.md")]
run = "\n".join(lines((root / "examples/02_where_am_i.py").read_text()))
sys.exit(0 if shown[0] == shown[1] and "\n".join(lines(shown[0])) in run else 1)
PYTHON

# docs/parameters.md is what `config --dump` prints.
"$1/scripts/parameters" "$2" | cmp -s - "$1/docs/parameters.md" || fail "docs/parameters.md is out of date: run scripts/parameters >docs/parameters.md"

# The ten numbers are the same in README and docs/RESULTS.md, and each stands in the table that it is said to be of.
/usr/bin/env python3 - "$1" <<'PYTHON' || fail "the ten numbers of README.md, docs/RESULTS.md and the tables differ"
import pathlib, re, sys
root = pathlib.Path(sys.argv[1])
rows_of = lambda page: re.search(r"^\| ten numbers.*\n\|[-:|]+\n((?:\|.*\n)+)", (root / page).read_text(), re.M)[1].splitlines()
shown, whole = rows_of("README.md"), rows_of("docs/RESULTS.md")
wrong = [] if len(shown) == 10 and all(w.startswith(s) for s, w in zip(shown, whole, strict=True)) else ["the rows differ"]
for row in whole:
    value, table = row.split(" | ")[1], (root / "docs" / re.search(r"\]\((.*?)\) \|$", row)[1]).read_text()
    number = re.match(r"[\d.]+", value)[0]
    share = re.match(r"(\d+) of (\d+)", value)
    number = f"{100 * int(share[1]) / int(share[2]):.1f}" if share else number
    digits = len(number.partition(".")[2])
    found = {f"{float(n):.{digits}f}" for n in re.findall(r"(?<![\d.])\d+\.?\d*(?![\d.])", table)}
    wrong += [] if number in found else [f"{value} is not in the table"]
print("\n".join(wrong), file=sys.stderr)
sys.exit(1 if wrong else 0)
PYTHON
