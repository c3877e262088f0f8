#!/usr/bin/env bash
# fuzz.sh BUILD SECONDS: replays the committed corpus through every fuzz target, then looks for new input for SECONDS
# of processor time in all, shared evenly, as many targets at once as there are processors. What is found stays in BUILD/findings.
set -euo pipefail
if [ "${1-}" = --one ]; then
  build=$2 seconds=$3 here=$4 target=$5
  name=$(basename "$target")
  corpus=$here/tests/fuzz/corpus/${name#fuzz_} log=$build/$name.log stop=$build/$name.stop
  [ -d "$corpus" ] && [ -n "$(ls "$corpus")" ] || { echo "$name: no corpus in tests/fuzz/corpus/${name#fuzz_}" >&2; exit 1; }
  scratch=$(mktemp -d)
  trap 'rm -rf "$scratch" "$stop"' EXIT
  # One process replays and looks on. Its own -max_total_time would begin with the replay, which under the thread
  # sanitizer takes longer than there is for new input: it is told to stop so many seconds after the replay's end.
  rm -f "$stop"
  "$target" -stop_file="$stop" -timeout=60 -report_slow_units=100 -rss_limit_mb=4096 -artifact_prefix="$build/findings/$name-" "$scratch" "$corpus" >"$log" 2>&1 &
  while kill -0 $! 2>/dev/null && ! grep -q INITED "$log"; do sleep 0.2; done
  for ((i = 0; i < 5 * seconds; ++i)); do kill -0 $! 2>/dev/null && sleep 0.2; done
  echo enough >"$stop"
  if ! wait $!; then
    tail -n 40 "$log" >&2
    if grep -q INITED "$log"; then echo "$name: a finding in $build/findings" >&2; else echo "$name: the corpus fails" >&2; fi
    exit 1
  fi
  files=$(ls "$corpus" | wc -l) runs=$(sed -n 's/^Done \([0-9]*\) runs.*/\1/p' "$log")
  new=$((runs - files - 1))  # it begins with an empty input of its own
  [ $new -gt 0 ] || { echo "$name: no new input was tried in $seconds s after a corpus of $files files" >&2; exit 1; }
  echo "$name: corpus of $files files and $new runs of new input in $seconds s without a finding"
  exit
fi
here=$(cd "$(dirname "$0")/.." && pwd)
build=$(cd "$1" && pwd)
targets=("$build"/tests/fuzz_*)
seconds=$((($2 + ${#targets[@]} - 1) / ${#targets[@]}))
mkdir -p "$build/findings"
export UBSAN_OPTIONS=print_stacktrace=1 ASAN_OPTIONS=detect_leaks=1
printf '%s\0' "${targets[@]}" | xargs -0 -P "$(nproc)" -n 1 "$0" --one "$build" "$seconds" "$here"
