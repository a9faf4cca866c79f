#!/usr/bin/env bash
# Tests the built engine (apps/web_engine/build.sh) in node: the golden scenes have the program's hashes, and a journal made
# with it replays to the same hash. Then the npm package that has it: in node, its types, and its examples in a browser.
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
status=0
for packed in "$work"/*.talus; do
    name=$(basename "$packed" .talus)
    read -r _ motion measured how < <("${run_node[@]}" "$engine/golden.js" "$packed")
    wanted=$(python3 -c 'import json, sys; row = json.load(open("tests/golden/golden_hashes.json"))[sys.argv[1]]; print(row["motion"], row["measurements"])' "$name")
    if [[ "$motion $measured" == "$wanted" ]]; then
        echo "$name: equal bits ($how)"
    else
        echo "$name: motion and measurements $motion $measured, the program has $wanted" >&2
        status=1
    fi
done

web/node_modules/.bin/esbuild web/src/engine/engine.ts --format=esm --log-level=warning --outfile="$work/engine.mjs"
"${run_node[@]}" tests/web_engine/engine_test.mjs "$engine" "$work/built_in_scene.talus" "$work/engine.mjs" "$work/journal.json"
"$bin/talus" replay "$work/journal.json" --scene scenes/sham_tseng/scene.toml

web/engine_package/pack.sh "$engine" "$work/packed" >/dev/null
package=$work/npm/node_modules/talus-engine
mkdir -p "$package"
tar --extract --gzip --strip-components=1 --directory "$package" --file "$work"/packed/talus-engine-*.tgz
node tests/web_engine/package_test.mjs "$work/npm" "$work/built_in_scene.talus" web/engine_package/README.md
cp tests/web_engine/package_types.mts "$work/npm"
(cd "$work/npm" && "$root/web/node_modules/.bin/tsc" --noEmit --strict --target es2022 --module nodenext --moduleResolution nodenext \
    --lib es2022,dom package_types.mts)
echo "its types are those of its functions"
seen=0
node tests/browser/engine_package_test.mjs "$engine/examples" "$package" "$work/built_in_scene.talus" || seen=$?
((seen == 0 || seen == 77)) || status=1 # 77: no browser, as it says
exit "$status"
