#!/usr/bin/env bash
# tidy_module.sh MODULE COMMAND...: runs the command, unless TALUS_CHANGED_SINCE names a revision since which no file of the
# module has changed; then it is skipped (77).
set -euo pipefail
module=$1
shift
if [[ -n ${TALUS_CHANGED_SINCE:-} ]] && git diff --quiet "$TALUS_CHANGED_SINCE" -- "$module"; then
    echo "skipped: $module has not changed since $TALUS_CHANGED_SINCE"
    exit 77
fi
exec "$@"
