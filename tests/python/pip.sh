#!/usr/bin/env bash
# pip install . without a network, from a copy of what git tracks, in an environment of its own. pip.sh SOURCE_DIR PYTHON [BUILD_DIR]
# With BUILD_DIR the wheel is packed of that build; without, all is built from nothing.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
mkdir "$work/source"
(cd "$1" && git ls-files -z --cached --others --exclude-standard | tar --null --files-from=- --create) | tar --extract --directory "$work/source"
"$2" -m venv --system-site-packages "$work/venv"
[ -z "${3:-}" ] || export PHASESCAN_BUILD_DIR="$3"
"$work/venv/bin/pip" install --quiet --no-index --no-build-isolation "$work/source"
cd "$work"
ls venv/lib/python3*/site-packages/phasescan-*.dist-info >/dev/null
grep -q "^Tag: cp3.*-linux_" venv/lib/python3*/site-packages/phasescan-*.dist-info/WHEEL
unset PYTHONPATH PHASESCAN_BUILD_DIR
venv/bin/phasescan simulate --world flat --duration 3 --out drive.jsonl
venv/bin/python - <<'PYTHON'
import phasescan
assert "venv" in phasescan.__file__, phasescan.__file__
scans = [entry.scan for entry in phasescan.open_log("drive.jsonl")]
result = phasescan.match(scans[0], scans[5])
assert result.usable, result
print(result)
PYTHON
