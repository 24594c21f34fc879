#!/usr/bin/env bash
# Installs a build into a clean place and uses each component as a user's project would: found by CMake, by pkg-config, and
# added as a folder. run.sh BUILD_DIR SOURCE_DIR CXX
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
clients="$2/tests/package/clients"
configure() { cmake --no-warn-unused-cli -G Ninja -S "$clients" -B "$1" -DCMAKE_CXX_COMPILER="$cxx" -DCMAKE_BUILD_TYPE=Release "${@:2}" > "$1.log" || { cat "$1.log"; exit 1; }; }
cxx="$3"
cmake --install "$1" --prefix "$work/prefix" > /dev/null

# What a component does not need may be missing.
declare -A spare=([match]="Ceres SQLite3 PNG yaml-cpp ZLIB BZip2 fmt nlohmann_json" [fft_icp]="Ceres SQLite3 PNG yaml-cpp ZLIB BZip2 fmt nlohmann_json"
  [slam]="SQLite3 PNG yaml-cpp fmt nlohmann_json" [localize]="SQLite3 PNG yaml-cpp fmt nlohmann_json" [io]="Ceres PNG nlohmann_json" [live]="PNG nlohmann_json" [phasescan]="PNG nlohmann_json")
for component in match fft_icp slam localize io live phasescan; do
  missing=()
  for package in ${spare[$component]}; do missing+=("-DCMAKE_DISABLE_FIND_PACKAGE_$package=ON"); done
  configure "$work/$component" -DCOMPONENT=$component -DCMAKE_PREFIX_PATH="$work/prefix" "${missing[@]}"
  cmake --build "$work/$component" > /dev/null
  "$work/$component/client"
  echo "found by CMake: $component"
done

export PKG_CONFIG_PATH="$(dirname "$(find "$work/prefix" -name phasescan-match.pc)")"
for component in match fft_icp slam localize io live; do
  # shellcheck disable=SC2046  # flags are words
  "$cxx" -std=c++20 "$clients/$component.cpp" -o "$work/client" $(pkg-config --cflags --libs "phasescan-$component")
  "$work/client"
  echo "found by pkg-config: $component"
done

missing=()
for package in ${spare[match]}; do missing+=("-DCMAKE_DISABLE_FIND_PACKAGE_$package=ON"); done
launcher="$(command -v ccache || true)"
configure "$work/folder" -DCOMPONENT=match -DPHASESCAN_FOLDER="$2" -DCMAKE_CXX_COMPILER_LAUNCHER="$launcher" "${missing[@]}"
cmake --build "$work/folder" > /dev/null
"$work/folder/client"
if cmake --install "$work/folder" --prefix "$work/nothing" > /dev/null && [ -e "$work/nothing/include" ]; then
  echo "added as a folder, phasescan installs itself"; exit 1
fi
echo "added as a folder: match"
"$work/prefix/bin/phasescan" --version
