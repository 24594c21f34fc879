#!/usr/bin/env bash
# Installs a build into a clean place and builds the first example against it, as a user's project would.
# run.sh BUILD_DIR SOURCE_DIR CXX
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
cmake --install "$1" --prefix "$work/prefix" >/dev/null
cmake -S "$2/tests/package/client" -B "$work/build" -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_CXX_COMPILER="$3" \
  -DCMAKE_BUILD_TYPE=Release -DCLIENT_SOURCE="$2/examples/01_match_two_scans.cpp" >/dev/null
cmake --build "$work/build" >/dev/null
"$work/build/client"
"$work/prefix/bin/phasescan" --version
