#!/usr/bin/env bash
# Builds the page's engine: build/web_engine/talus_engine.js and .wasm, and the program that runs golden scenes with it. Needs
# emscripten (apt-get install emscripten nodejs), and the headers of Highway, fmt, nlohmann-json, toml++ and mustache.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
build=${1:-$root/build/web_engine}
if ! command -v emcc >/dev/null; then
    echo "apps/web_engine/build.sh: emcc is not there; install emscripten" >&2
    exit 2
fi
# Not all of these folders are there.
platform=$({ find /usr/share/emscripten /usr/lib/emscripten "${EMSDK:-/nonexistent}/upstream/emscripten" \
    -path '*cmake/Modules/Platform/Emscripten.cmake' 2>/dev/null || true; } | head -n 1)
if [[ -z $platform ]]; then
    echo "apps/web_engine/build.sh: emscripten's cmake/Modules/Platform/Emscripten.cmake is not there; install emscripten" >&2
    exit 2
fi
# Debian's emscripten does not find the parser that is installed with it.
export NODE_PATH=${NODE_PATH:-/usr/share/nodejs}
cmake -G Ninja -S "$root/apps/web_engine" -B "$build" -DCMAKE_TOOLCHAIN_FILE="$platform" >/dev/null
cmake --build "$build" --parallel "${TALUS_JOBS:-$(nproc)}"
