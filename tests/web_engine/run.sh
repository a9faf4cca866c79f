#!/usr/bin/env bash
# Tests the built engine (apps/web_engine/build.sh) in node: the golden scenes have the program's hashes, and a journal made
# with it replays to the same hash.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
cd "$root"
engine=${TALUS_ENGINE:-build/web_engine}
bin=${TALUS_BIN:-build/release/bin}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# Node's own fetch is not for files.
run_node=(node --no-experimental-fetch)

TALUS_PACKS_TO=$work "$bin/test_pack" --gtest_filter='*Golden*' --gtest_brief=1
# The C library's cos, sin and cbrt, with which debris is entrained, are not those of the program: docs/web-engine.md.
differing=entrainment_and_inflow
status=0
for packed in "$work"/*.talus; do
    name=$(basename "$packed" .talus)
    read -r _ motion measured how < <("${run_node[@]}" "$engine/golden.js" "$packed")
    wanted=$(python3 -c 'import json, sys; row = json.load(open("tests/golden/golden_hashes.json"))[sys.argv[1]]; print(row["motion"], row["measurements"])' "$name")
    if [[ "$motion $measured" == "$wanted" ]]; then
        echo "$name: equal bits ($how)"
    elif [[ $name == "$differing" ]]; then
        echo "$name: other bits, as known ($how)"
    else
        echo "$name: motion and measurements $motion $measured, the program has $wanted" >&2
        status=1
    fi
done

web/node_modules/.bin/esbuild web/src/engine/engine.ts --format=esm --log-level=warning --outfile="$work/engine.mjs"
"${run_node[@]}" tests/web_engine/engine_test.mjs "$engine" "$work/built_in_scene.talus" "$work/engine.mjs" "$work/journal.json"
"$bin/talus" replay "$work/journal.json" --scene scenes/sham_tseng/scene.toml
exit "$status"
