#!/usr/bin/env bash
# Packs talus-engine-<version>.tgz for npm: the engine that apps/web_engine/build.sh has built, with types and examples.
#   web/engine_package/pack.sh ENGINE_FOLDER OUTPUT_FOLDER
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
web=$(dirname "$here")
engine=${1:?the folder of talus_engine.js and talus_engine.wasm}
output=${2:?the folder for the package}
for file in talus_engine.js talus_engine.wasm; do
    if [[ ! -s $engine/$file ]]; then
        echo "web/engine_package/pack.sh: $engine/$file is not there; apps/web_engine/build.sh builds it" >&2
        exit 2
    fi
done
if [[ ! -x $web/node_modules/.bin/esbuild ]]; then npm ci --prefix "$web" --no-audit --no-fund; fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cp "$here/package.json" "$here/README.md" "$web/../LICENSE" "$engine/talus_engine.js" "$engine/talus_engine.wasm" "$work"
mkdir -p "$work/examples/three" "$work/examples/cesium"
cp "$here"/examples/three/index.html "$work/examples/three"
cp "$here"/examples/cesium/{index.html,main.js,package.json} "$work/examples/cesium"
for part in index worker; do
    "$web/node_modules/.bin/esbuild" "$here/src/$part.ts" --bundle --format=esm --target=es2022 --external:./talus_engine.js \
        --log-level=warning --outfile="$work/$part.js"
done
"$web/node_modules/.bin/tsc" --project "$here" --outDir "$work/types"
cp "$here/src/talus_engine.d.ts" "$work/types/engine_package/src"
# Node's way of looking for modules wants whole names of files.
find "$work/types" -name '*.d.ts' -exec perl -pi -e 's{((?:from |import\()")(\.[^"]+?)(?<!\.js)"}{$1$2.js"}g' {} +
mkdir -p "$output"
(cd "$work" && npm pack --silent --pack-destination "$(cd "$OLDPWD" && cd "$output" && pwd)")
