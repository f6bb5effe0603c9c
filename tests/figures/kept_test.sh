#!/bin/sh
# Are the figures that are kept those that the stages draw now? Usage: kept_test.sh FIGURES_PROGRAM SOURCE_FOLDER
set -eu
drawn=$(mktemp -d)
trap 'rm -rf "$drawn"' EXIT
mkdir "$drawn/figures"
"$1" "$drawn/figures" "$drawn/bracket.obj" >"$drawn/log"
# The drawing of the includes is another program's, and another test's.
cp "$2/core/figures/wings.svg" "$drawn/figures"
diff -rq "$drawn/figures" "$2/core/figures" && cmp "$drawn/bracket.obj" "$2/tests/data/bracket.obj" || {
  echo './dev figures draws them again'
  exit 1
}
