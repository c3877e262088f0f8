# Shared by ./play and ./check: says what is done, installs what is missing, builds. Sourced, not run.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
started=$SECONDS
log_folder=build/log
mkdir -p "$log_folder"

say() { printf '\033[1m[%3ds] %s\033[0m\n' $((SECONDS - started)) "$*"; }
fail() { printf '\033[31m[%3ds] failed: %s\033[0m\n' $((SECONDS - started)) "$*" >&2; exit 1; }

# quietly NAME COMMAND…: output to build/log/NAME.log; on failure its last lines and where the rest is.
quietly() {
  local name=$1 log="$log_folder/$1.log"
  shift
  if ! "$@" >"$log" 2>&1; then
    tail -n 40 "$log" >&2
    fail "$name: the command was: $* (whole output: $log)"
  fi
}

# What this script's children have used so far, s; without the processes of a browser, which outlive whoever would count them.
processor_seconds() { awk '{ sub(/.*\) /, ""); printf "%d", ($14 + $15) / '"$(getconf CLK_TCK)"' }' "/proc/$$/stat"; }

as_root() {
  if [ "$(id -u)" = 0 ]; then "$@"
  elif command -v sudo >/dev/null; then sudo "$@"
  else fail "packages are missing and there is neither root nor sudo: please run: apt-get install $*"; fi
}

is_installed() { dpkg-query -W -f '${Status}' "$1" 2>/dev/null | grep -q '^install ok installed'; }
is_known() { [ -n "$(apt-cache madison "$1" 2>/dev/null)" ]; }

# install_packages PACKAGE…: only what is missing, without recommendations.
install_packages() {
  command -v dpkg-query >/dev/null || fail "this script installs packages on Debian and Ubuntu; elsewhere install: $*"
  local missing=() package
  for package in "$@"; do is_installed "$package" || missing+=("$package"); done
  [ ${#missing[@]} = 0 ] && return
  say "installing ${#missing[@]} packages: ${missing[*]}"
  quietly apt-update as_root apt-get update
  quietly apt-install as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "${missing[@]}"
}

# The newest clang whose WebAssembly C++ library this distribution carries.
newest_clang() {
  local version attempt
  for attempt in lists-as-they-are lists-updated; do
    for version in 20 19 18 17 16; do
      if is_known "libc++-$version-dev-wasm32"; then echo $version; return; fi
    done
    [ $attempt = lists-as-they-are ] && quietly apt-update as_root apt-get update >&2
  done
  fail "no clang with a WebAssembly C++ library (libc++-NN-dev-wasm32) in this distribution"
}

build_packages=(g++ cmake ninja-build make pkg-config ca-certificates libboost-dev libcairo2-dev libcli11-dev libgif-dev libssl-dev nlohmann-json3-dev
  libtinygltf-dev)
node_ready() { command -v node >/dev/null && command -v npm >/dev/null && [ "$(node -p 'process.versions.node.split(".")[0]')" -ge 18 ]; }

setup_build() {
  install_packages "${build_packages[@]}"
  if ! node_ready; then install_packages nodejs npm; node_ready || fail "node 18 or newer and npm are needed for the page"; fi
}

jobs=$(nproc)
# Sources to a translation unit: what all of them include is then read a few times only, as long as every processor has
# units enough.
unity=(-DCAROM_UNITY=ON "-DCAROM_UNITY_BATCH=$((jobs < 6 ? 48 / jobs : 8))")

# Whatever runs takes its memory in large pages where the system gives these to who asks, which saves clang a sixth and
# wasm-split a fifth of their processor time (by the C library of 2.35 or newer; an older one does not look).
export GLIBC_TUNABLES=glibc.malloc.hugetlb=1
build() { cmake --build "$1" --parallel "$jobs" "${@:2}"; }  # FOLDER OPTION…

# build_native: the release build in build/release, as few translation units (a cold build is short).
build_native() {
  local extra=()
  command -v ccache >/dev/null && extra+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
  say "configuring build/release"
  quietly configure cmake --preset release "${unity[@]}" "${extra[@]}" "$@"
  say "building with $jobs jobs"
  if [ -t 1 ]; then build build/release || fail "the build"
  else quietly build build build/release; fi
}

# What building for WebAssembly needs, given the version that newest_clang names.
wasm_packages() { echo "clang-$1" "lld-$1" wasi-libc "libc++-$1-dev-wasm32" "libclang-rt-$1-dev-wasm32" binaryen; }

# build_wasm: in build/wasm, the module of the page or what the caller wants.
wasm_targets=(carom_module)
build_wasm() {
  local extra=()
  command -v ccache >/dev/null && extra+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
  say "building for WebAssembly"
  quietly configure-wasm cmake --preset wasm "${unity[@]}" "${extra[@]}"
  quietly build-wasm build build/wasm --target "${wasm_targets[@]}"
}

# build_page: for `carom serve`, in apps/playground/dist.
build_page() {
  say "building the page"
  if [ ! -d apps/playground/node_modules ] || [ apps/playground/package-lock.json -nt apps/playground/node_modules/.package-lock.json ]; then
    quietly npm-ci npm ci --prefix apps/playground --no-audit --no-fund
  fi
  quietly page npm run --prefix apps/playground build
}

# build_web: the page with the engine in it, in out/web, for any web server. The native command draws the demos' pictures.
build_web() {
  [ -x build/release/apps/command/carom ] || build_native -DCAROM_BUILD_TESTS=OFF -DCAROM_BUILD_EXAMPLES=OFF
  # Linking the module takes one processor for a minute: bundling the page and drawing its pictures takes the other.
  build_page &
  local page=$!
  build_wasm
  wait $page || exit 1
  quietly web node apps/playground/build.mjs --web out/web
}
