#!/usr/bin/env bash
# Installs what is missing, builds the program, runs the built-in scene into talus_out/ and then opens it live in the
# browser until Ctrl-C. Without a terminal, or with CI=true, it stops after the report.
# Arguments go to `talus run`, the scene, --threads, --set and --data to `talus serve` too:
# scripts/run.sh my_scene.toml --threads 4
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/install_packages.sh build
cmake --preset release
cmake --build --preset release --target talus --parallel "$(nproc)"
build/release/bin/talus run --force "$@"
if [[ ! -t 0 || ! -t 1 || ${CI:-} == true ]]; then exit; fi

serve=()
while (($# > 0)); do
    case $1 in
        --threads | --set | --data) serve+=("$1" "${2:-}") && shift ;;
        --threads=* | --set=* | --data=*) serve+=("$1") ;;
        -o | --output | --vary) shift ;;
        -*) ;;
        *) serve+=("$1") ;;
    esac
    shift
done
echo
exec build/release/bin/talus serve "${serve[@]}"
