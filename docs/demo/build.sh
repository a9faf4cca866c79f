#!/bin/sh
# Writes the built-in scene as one page, docs/demo/twin.html.
set -eu
here=$(dirname "$0")
talus=${TALUS:-$here/../../build/release/bin/talus}
exec "$talus" publish -o "$here/twin.html" --without-engine --no-files --interval 0.5 --force
