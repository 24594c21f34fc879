# Shared by scripts/*: run from anywhere, install what is missing (Debian 12 packages only), configure and build.
# Source it: . "$(dirname "$0")/lib/setup.sh"
set -euo pipefail
ROOT="$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)"
cd "$ROOT"

# What a build of everything needs. docs/licences.md says what each library is for.
PACKAGES=(build-essential cmake ninja-build pkg-config ccache git
  libeigen3-dev libfftw3-dev libkissfft-dev libnanoflann-dev libceres-dev libhwy-dev
  libcli11-dev libspdlog-dev libfmt-dev nlohmann-json3-dev libyaml-cpp-dev
  zlib1g-dev liblz4-dev libzstd-dev libbz2-dev libsqlite3-dev libpng-dev libserialport-dev libboost-dev cyclonedds-dev
  python3-dev python3-numpy pybind11-dev)
TEST_PACKAGES=(clang-14 clang-format-14 libclang-rt-14-dev libgtest-dev libgmock-dev libbenchmark-dev librapidcheck-dev
  python3 python3-pytest python3-matplotlib python3-distributed python3-pip python3-setuptools python3-venv python3-wheel mypy python3-pil python3-rosbag librsvg2-bin libfastrtps-dev libfastcdr-dev iproute2 valgrind groff-base zsh fish chromium)
# What scripts/docs makes the site with.
DOC_PACKAGES=(python3 python3-sphinx python3-myst-parser)
command -v npm >/dev/null || TEST_PACKAGES+=(nodejs npm)
# Independent readers of MCAP and ROS 2 messages and a client of the Foxglove protocol, for tests/interop, and what drives Chromium, for tests/browser.
INTEROP_MODULES=(puppeteer-core@22.15.0 @mcap/core@2.2.2 @foxglove/rosmsg@5.0.5 @foxglove/rosmsg2-serialization@3.1.0 @foxglove/wasm-zstd@1.0.1
  @foxglove/rosmsg-msgs-common@3.2.3 @foxglove/ws-protocol@0.8.0 ws@8.23.0)

say() { printf '\n== %s\n' "$*"; }

# install_missing <package>...: apt packages that are not there yet, with sudo only where it is needed.
install_missing() {
  local missing=() package
  for package in "$@"; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return 0
  say "Installing ${missing[*]}"
  local run=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "phasescan: not root and no sudo; install by hand: ${missing[*]}" >&2; exit 3; }
    run=(sudo)
  fi
  "${run[@]}" apt-get update -qq
  "${run[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
}

# install_interop: the npm packages of tests/interop and tests/browser into build/interop, once. Without a network those tests are skipped.
install_interop() {
  local module missing=0
  for module in @mcap/core @foxglove/ws-protocol @foxglove/rosmsg-msgs-common ws puppeteer-core; do
    [ -d "$ROOT/build/interop/node_modules/$module" ] || missing=1
  done
  [ "$missing" = 0 ] && return 0
  say "Installing ${INTEROP_MODULES[*]} into build/interop"
  npm install --silent --no-audit --no-fund --prefix "$ROOT/build/interop" "${INTEROP_MODULES[@]}" ||
    echo "phasescan: npm could not install them; the tests with @mcap/core and Chromium are skipped" >&2
}

# build <preset> [cmake --build options]: configure once, then build.
build() {
  local preset="$1"
  shift
  cmake --preset "$preset" >"$ROOT/build/$preset.configure.log" 2>&1 || { cat "$ROOT/build/$preset.configure.log" >&2; exit 1; }
  cmake --build --preset "$preset" "$@"
}
mkdir -p "$ROOT/build"
