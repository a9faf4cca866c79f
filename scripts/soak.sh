#!/usr/bin/env bash
# Serves the built-in scene to 20 viewers with an edit every second and a restart every five, and says whether memory stays flat and a
# viewer gets its frames.
#   scripts/soak.sh [SECONDS [PARTICLES]]   default: 3600 and 2000; exit code 1: memory grows, or the viewer had less than half
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
cmake --preset release
cmake --build --preset release --parallel "$(nproc)" --target soak
build/release/bin/soak "${1:-3600}" "${2:-2000}"
