#!/usr/bin/env bash
# Installs what is missing, builds everything and passes all tests:
#   asan     memory errors and undefined behaviour, over the fast tests
#   release  the behaviour of the program that users run
#   dev      everything: warnings are errors, checks of style and layering, the report in a browser
# Presets' names as arguments test those alone: scripts/test.sh dev
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

step() {
    echo
    echo "== $* ($((SECONDS / 60)) min $((SECONDS % 60)) s)"
}

test_preset() {
    local preset=$1
    shift
    step "build $preset"
    cmake --preset "$preset"
    cmake --build --preset "$preset" --parallel "$(nproc)"
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
    for preset in "$@"; do test_preset "$preset"; done
    exit
fi
test_preset asan
test_preset release --label-exclude 'style|browser'
test_preset dev
step "done"
