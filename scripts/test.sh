#!/usr/bin/env bash
# Installs what is missing, builds the program that users run and passes its tests, the pages in a browser among them.
# Names as arguments ask for something else, one after the other:
#   scripts/test.sh release   the same as without arguments
#   scripts/test.sh asan      what reads foreign data, indexes arrays or is shared by threads, under the address and
#                             undefined-behaviour sanitizers
#   scripts/test.sh tsan      what runs in parallel, under the thread sanitizer
#   scripts/test.sh style     format, clang-tidy, layers, files; with TALUS_CHANGED_SINCE=<revision> clang-tidy looks only
#                             at the modules that have changed since
#   scripts/test.sh publish   the engine of published twins, such twins in Chromium and Firefox, and the npm package talus-engine;
#                             installs emscripten, Cesium and Firefox
#   scripts/test.sh qgis      the plugin for QGIS, in QGIS without a window; installs QGIS
#   scripts/test.sh dev       all tests with assertions, every file compiled by itself
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

step() {
    echo
    echo "== $* ($((SECONDS / 60)) min $((SECONDS % 60)) s)"
}

build_and_test() {
    local preset=$1
    step "build $preset"
    cmake --preset "$preset"
    cmake --build --preset "$preset" --parallel "$(nproc)"
    step "test $preset"
    run_tests "$preset" --label-exclude 'style|browser'
    if [[ $preset == release || $preset == dev ]]; then
        # A browser on a busy machine can be late for a click: what fails is tried once more, and both tries are printed.
        step "pages $preset"
        run_tests "$preset" --label-regex browser --repeat until-pass:2
    fi
}

run_tests() {
    local preset=$1 status=0
    shift
    ctest --preset "$preset" --parallel "$(nproc)" "$@" || status=$?
    if ((status != 0)); then
        tell_failures "build/$preset/Testing/Temporary"
        exit "$status"
    fi
}

# What the failed tests said, once more at the end: where only the end of a log is kept, nothing else says why.
tell_failures() {
    step "failed"
    cut -d: -f2- "$1/LastTestsFailed.log" | while IFS= read -r name; do
        echo "-- $name"
        awk -v name="$name" 'index($0, " Testing: " name) && $NF == name { inside = 1 }
                             inside; /^<end of output>/ { inside = 0 }' "$1/LastTest.log" | tail -n 30 | cut -c1-400
    done | tail -n 200
}

install_browser_tests() {
    # The lock file decides what is installed; a copy of it says whether that has been done.
    if ! cmp --silent tests/browser/package-lock.json tests/browser/node_modules/.installed-lock.json; then
        npm ci --prefix tests/browser --no-audit --no-fund
        cp tests/browser/package-lock.json tests/browser/node_modules/.installed-lock.json
    fi
}

# Builds the page's engine with emscripten, compares its results with the program's, tests the npm package with its examples, and
# clicks through published twins that have the engine.
test_page_engine() {
    scripts/install_packages.sh publish
    install_browser_tests
    # Before the program, which carries it; flags of the program's compiler are not those of emscripten.
    env -u CXXFLAGS apps/web_engine/build.sh build/web_engine
    cmake --preset release
    cmake --build --preset release --target talus test_pack --parallel "$(nproc)"
    (cd web && npm ci --no-audit --no-fund)
    npm ci --prefix web/engine_package/examples/cesium --ignore-scripts --no-audit --no-fund # 53 MB, for this test alone
    tests/web_engine/run.sh
    run_tests release --tests-regex '^browser\.(publish|firefox_publish)$' --repeat until-pass:2
}

step "packages"
scripts/install_packages.sh test
if (($# == 0)); then set -- release; fi
for name in "$@"; do
    case $name in
        release | dev)
            install_browser_tests
            build_and_test "$name"
            ;;
        asan | tsan) build_and_test "$name" ;;
        style)
            step "style"
            cmake --preset release
            # clang-tidy reads headers that the build makes.
            cmake --build --preset release --target generated_sources --parallel "$(nproc)"
            run_tests release --label-regex style
            ;;
        qgis)
            step "qgis"
            scripts/install_packages.sh qgis
            cmake --preset release
            cmake --build --preset release --target talus --parallel "$(nproc)"
            # Debian's Python, for which its QGIS is made.
            PATH=$PWD/build/release/bin:$PATH /usr/bin/python3 -m unittest discover --start-directory tests/qgis --verbose
            ;;
        publish)
            step "publish"
            test_page_engine
            ;;
        *)
            echo "scripts/test.sh: $name is none of release, asan, tsan, style, qgis, publish, dev" >&2
            exit 2
            ;;
    esac
done
step "done"
