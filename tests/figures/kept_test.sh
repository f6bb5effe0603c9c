#!/bin/sh
# Are the figures that are kept those that the stages draw now? Usage: kept_test.sh FIGURES_PROGRAM SOURCE_FOLDER
set -eu
drawn=$(mktemp -d)
trap 'rm -rf "$drawn"' EXIT
mkdir "$drawn/figures"
"$1" "$drawn/figures" "$drawn/bracket.obj" >"$drawn/log"
diff -rq "$drawn/figures" "$2/core/figures" && cmp "$drawn/bracket.obj" "$2/tests/data/bracket.obj" || {
  echo './dev figures draws them again'
  exit 1
}
