#!/usr/bin/env bash
# check_determinism.sh GCC_BUILD CLANG_BUILD WASM_BUILD: every build, thread count and SIMD width must print the same
# state hashes (tests/determinism). Prints the hashes and what agreed.
set -euo pipefail
here=$(cd "$(dirname "$0")/.." && pwd)
gcc=$1/tests/determinism/state_hashes clang=$2/tests/determinism/state_hashes wasm=$3/tests/determinism/state_hashes.wasm
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

"$gcc" >"$scratch/reference"
cat "$scratch/reference"
[ "$(wc -l <"$scratch/reference")" -ge 24 ] || { echo "expected at least 24 scenes" >&2; exit 1; }

failures=0
compare() {  # NAME KIND COMMAND…: the lines of this kind (demo, scene, model, or all) must equal the reference's
  local name=$1 kind=$2
  shift 2
  grep -E "^(${kind/all/.*})" "$scratch/reference" >"$scratch/expected"
  "$@" >"$scratch/found"
  if diff "$scratch/expected" "$scratch/found" >"$scratch/difference"; then
    echo "equal: $name ($(wc -l <"$scratch/found") lines)"
  else
    echo "DIFFERENT: $name"; cat "$scratch/difference"; failures=$((failures + 1))
  fi
}
compare "gcc, 2 threads" all "$gcc" --threads 2
compare "gcc, SIMD width 4" "scene|model" "$gcc" --scenes --models --width 4
grep -qw avx2 /proc/cpuinfo && compare "gcc, SIMD width 8 (AVX2)" "scene|model" "$gcc" --scenes --models --width 8
grep -qw avx512bw /proc/cpuinfo && compare "gcc, SIMD width 16 (AVX-512), 2 threads" "scene|model" "$gcc" --scenes --models --width 16 --threads 2
compare "clang, 1 thread" all "$clang"
compare "clang, SIMD width 4, 2 threads" "scene|model" "$clang" --scenes --models --width 4 --threads 2
# V8 of Node 20 now and then crashes in its optimising compiler on the largest functions; its other one does not.
compare "WebAssembly under Node" all node --no-warnings --liftoff-only "$here/tests/determinism/run_wasm.mjs" "$wasm"
compare "WebAssembly under Node, 2 threads" scene node --no-warnings --liftoff-only "$here/tests/determinism/run_wasm.mjs" --workers 1 "$wasm" --scenes --threads 2
[ $failures = 0 ] || exit 1
