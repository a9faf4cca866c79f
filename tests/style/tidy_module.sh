#!/usr/bin/env bash
# tidy_module.sh MODULE BUILD COMMAND...: runs the command with the compile commands of a build folder, without g++'s precompiled
# headers, which clang does not read. It is skipped (77) if TALUS_CHANGED_SINCE names a revision since which no file of the module has changed.
set -euo pipefail
module=$1
build=$2
shift 2
if [[ -n ${TALUS_CHANGED_SINCE:-} ]] && git diff --quiet "$TALUS_CHANGED_SINCE" -- "$module"; then
    echo "skipped: $module has not changed since $TALUS_CHANGED_SINCE"
    exit 77
fi
commands=$(mktemp -d)
trap 'rm -r "$commands"' EXIT
sed -E 's# -Winvalid-pch| -include [^ ]*/cmake_pch\.hxx##g' "$build/compile_commands.json" >"$commands/compile_commands.json"
"$@" -p "$commands"
