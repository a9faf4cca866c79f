#!/usr/bin/env bash
# Looks for inputs that the parsers and the live session do not survive, with libFuzzer under the address and
# undefined-behaviour sanitizers. Needs clang with its libraries (Debian: clang).
#   scripts/fuzz.sh [SECONDS] [TARGET...]   SECONDS in all (default: 600), shared by the targets (default: all of tests/fuzz)
# What it finds is written to build/fuzz/found/TARGET and ends the target; exit code 1. `build/fuzz/bin/fuzz_TARGET FILE` repeats it.
# Put the file into tests/fuzz/corpus/TARGET with the repair: then every test run looks at it.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

seconds=${1:-600}
if ! [[ $seconds =~ ^[1-9][0-9]*$ ]]; then
    echo "scripts/fuzz.sh: SECONDS = $seconds: must be a whole number above 0" >&2
    exit 2
fi
shift || true
targets=("$@")
if ((${#targets[@]} == 0)); then
    for folder in tests/fuzz/corpus/*/; do targets+=("$(basename "$folder")"); done
fi

cmake --preset fuzz
cmake --build --preset fuzz --parallel "$(nproc)" --target "${targets[@]/#/fuzz_}"

each=$(((seconds + ${#targets[@]} - 1) / ${#targets[@]}))
failed=()
for target in "${targets[@]}"; do
    grown=build/fuzz/corpus/$target found=build/fuzz/found/$target
    mkdir -p "$grown" "$found"
    echo "== $target: $each s"
    # A leak of a library at exit is none of ours to find here; 20 s are endless for 64 KiB.
    ASAN_OPTIONS=detect_leaks=0 "build/fuzz/bin/fuzz_$target" -max_total_time="$each" -max_len=65536 -timeout=20 \
        -rss_limit_mb=4096 -print_final_stats=1 -artifact_prefix="$found/" "$grown" "tests/fuzz/corpus/$target" \
        2>"$found/log" || failed+=("$target")
    grep -E "^stat::number_of_executed_units|ERROR|SUMMARY|does not hold" "$found/log" || true
done
if ((${#failed[@]} > 0)); then
    echo "found something: ${failed[*]}; see build/fuzz/found/*/log" >&2
    exit 1
fi
