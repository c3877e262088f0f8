#!/usr/bin/env bash
# check_determinism.sh GCC_BUILD CLANG_BUILD WASM_BUILD: every build, thread count and SIMD width must print the same
# state hashes (tests/determinism). Prints the hashes and what agreed.
set -euo pipefail
here=$(cd "$(dirname "$0")/.." && pwd)
gcc=$1/tests/determinism/state_hashes clang=$2/tests/determinism/state_hashes wasm=$3/tests/determinism/state_hashes.wasm
for program in "$gcc" "$clang" "$wasm"; do [ -f "$program" ] || { echo "not built: $program" >&2; exit 1; }; done
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

names=() kinds=()
start() {  # NAME KIND THREADS COMMAND…: the lines of this kind (demo, scene, model, or all) must equal the reference's
  while [ $(($(jobs -rp | wc -l) * $3)) -gt $(($(nproc) - $3)) ] && [ -n "$(jobs -rp)" ]; do wait -n || true; done  # one that fails is seen by what it printed
  "${@:4}" >"$scratch/${#names[@]}" &
  names+=("$1") kinds+=("$2")
}
# Every compiler, width and number of threads is there, not every one of their combinations. V8 of Node 20 now and then
# crashes in its optimising compiler on the largest functions; its other one does not, and takes the longest of all: it
# goes first, and half as far, what needs two processors last.
node=(node --no-warnings --liftoff-only "$here/tests/determinism/run_wasm.mjs")
start "WebAssembly under Node, demos" "demo [^ ]+ 300 " 1 "${node[@]}" "$wasm" --demos --demo-steps 300
start "gcc, 1 thread" all 1 "$gcc"
reference=$scratch/1
start "clang, SIMD width 4" all 1 "$clang" --width 4
start "gcc, SIMD width 4" "scene|model" 1 "$gcc" --scenes --models --width 4
start "WebAssembly under Node, models" model 1 "${node[@]}" "$wasm" --models
start "WebAssembly under Node, 2 threads" scene 2 "${node[@]}" --workers 1 "$wasm" --scenes --threads 2
grep -qw avx2 /proc/cpuinfo && start "gcc, SIMD width 8 (AVX2), 2 threads" all 2 "$gcc" --width 8 --threads 2
grep -qw avx2 /proc/cpuinfo && start "clang, SIMD width 8 (AVX2), 2 threads" "scene|model" 2 "$clang" --scenes --models --width 8 --threads 2
grep -qw avx512bw /proc/cpuinfo && start "clang, SIMD width 16 (AVX-512), 2 threads" "scene|model" 2 "$clang" --scenes --models --width 16 --threads 2
wait || true

cat "$reference"
[ "$(wc -l <"$reference")" -ge 24 ] || { echo "expected at least 24 scenes" >&2; exit 1; }
failures=0
for i in "${!names[@]}"; do
  [ "$scratch/$i" = "$reference" ] && continue
  grep -E "^(${kinds[i]/all/.*})" "$reference" >"$scratch/expected"
  if diff "$scratch/expected" "$scratch/$i" >"$scratch/difference"; then
    echo "equal: ${names[i]} ($(wc -l <"$scratch/$i") lines)"
  else
    echo "DIFFERENT: ${names[i]}"; cat "$scratch/difference"; failures=$((failures + 1))
  fi
done
[ $failures = 0 ]
