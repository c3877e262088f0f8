#!/usr/bin/env bash
# fuzz.sh BUILD SECONDS: replays the committed corpus through every fuzz target, then looks for new input for SECONDS
# of processor time in all, shared evenly, as many targets at once as there are processors. What is found stays in BUILD/findings.
set -euo pipefail
if [ "${1-}" = --one ]; then
  build=$2 seconds=$3 here=$4 target=$5
  name=$(basename "$target")
  corpus=$here/tests/fuzz/corpus/${name#fuzz_}
  [ -d "$corpus" ] && [ -n "$(ls "$corpus")" ] || { echo "$name: no corpus in tests/fuzz/corpus/${name#fuzz_}" >&2; exit 1; }
  "$target" -runs=0 -report_slow_units=100 -rss_limit_mb=4096 "$corpus" >"$build/$name.log" 2>&1 || { tail -n 40 "$build/$name.log" >&2; echo "$name: the corpus fails" >&2; exit 1; }
  scratch=$(mktemp -d)
  trap 'rm -rf "$scratch"' EXIT
  "$target" -max_total_time="$seconds" -timeout=60 -rss_limit_mb=4096 -artifact_prefix="$build/findings/$name-" "$scratch" "$corpus" >"$build/$name.log" 2>&1 \
    || { tail -n 40 "$build/$name.log" >&2; echo "$name: a finding in $build/findings" >&2; exit 1; }
  echo "$name: corpus of $(ls "$corpus" | wc -l) files and $(sed -n 's/^Done \([0-9]*\) runs.*/\1/p' "$build/$name.log") runs in $seconds s without a finding"
  exit
fi
here=$(cd "$(dirname "$0")/.." && pwd)
build=$(cd "$1" && pwd)
targets=("$build"/tests/fuzz_*)
seconds=$((($2 + ${#targets[@]} - 1) / ${#targets[@]}))
mkdir -p "$build/findings"
export UBSAN_OPTIONS=print_stacktrace=1 ASAN_OPTIONS=detect_leaks=1
printf '%s\0' "${targets[@]}" | xargs -0 -P "$(nproc)" -n 1 "$0" --one "$build" "$seconds" "$here"
