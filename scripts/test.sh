#!/usr/bin/env bash
# Installs what is missing, builds everything and passes all tests:
#   release  the program that users run: physics, validation, speed, the pages in a browser
#   asan     all tests but the longest under the address and undefined-behaviour sanitizers, warnings being errors, and
#            the checks of style and layering
# Presets' names as arguments test those alone: scripts/test.sh dev (as asan, without sanitizers), scripts/test.sh tsan
# (what runs in parallel, under the thread sanitizer).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

step() {
    echo
    echo "== $* ($((SECONDS / 60)) min $((SECONDS % 60)) s)"
}

test_preset() {
    local preset=$1 target=$2
    shift 2
    step "build $preset"
    cmake --preset "$preset"
    cmake --build --preset "$preset" --target "$target" --parallel "$(nproc)"
    step "test $preset"
    ctest --preset "$preset" --parallel "$(nproc)" "$@"
}

step "packages"
scripts/install_packages.sh test
if [[ -f tests/browser/package-lock.json ]]; then
    # The lock file decides what is installed; a copy of it says whether that has been done.
    if ! cmp --silent tests/browser/package-lock.json tests/browser/node_modules/.installed-lock.json; then
        npm ci --prefix tests/browser --no-audit --no-fund
        cp tests/browser/package-lock.json tests/browser/node_modules/.installed-lock.json
    fi
fi

if (($# > 0)); then
    for preset in "$@"; do
        target=all
        if [[ $preset == tsan ]]; then target=thread_tests; fi
        test_preset "$preset" "$target"
    done
    exit
fi
test_preset release physics_tests --label-regex 'physics|threads|validation|performance'
step "test the pages"
ctest --preset release --parallel "$(nproc)" --label-regex browser
test_preset asan all
step "done"
