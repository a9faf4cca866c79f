#!/usr/bin/env bash
# Installs what is missing, builds the program and runs the built-in scene into talus_out/.
# Arguments go to `talus run`: scripts/run.sh my_scene.toml --threads 4
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/install_packages.sh build
cmake --preset release
cmake --build --preset release --target talus --parallel "$(nproc)"
build/release/bin/talus run --force "$@"
