#!/bin/sh
# Are the figures that are kept those that the stages draw now? Usage: kept_test.sh FIGURES_PROGRAM SOURCE_FOLDER
set -eu
drawn=$(mktemp -d)
trap 'rm -rf "$drawn"' EXIT
"$1" "$drawn" "$drawn/bracket.obj"
cmp "$drawn/bracket.obj" "$2/tests/data/bracket.obj"
for figure in "$drawn"/*.svg; do
  cmp "$figure" "$2/core/figures/${figure##*/}" || {
    echo './dev figures draws it again'
    exit 1
  }
done
