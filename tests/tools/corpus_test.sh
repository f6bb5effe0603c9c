#!/usr/bin/env bash
# Tests that need the collection of real meshes are skipped where it is missing, and fail there with
# REMESHD_REQUIRE_CORPUS=1: corpus_test.sh REMESHD REMESH CORE_TESTS API_TESTS MUTATE_FUZZ CANCEL_TEST
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
remeshd=$1 remesh=$2 core_tests=$3 api_tests=$4 mutate_fuzz=$5 cancel_test=$6
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() {
  echo "FAILED: $*" >&2
  exit 1
}
export REMESHD_CORPUS=$work/nowhere

# expect_skips PROGRAM FILTER...: every test of each filter is skipped.
# With the variable each of them fails, and the message names a path in the folder that is missing.
expect_skips() {
  local program=$1 test
  shift
  for test in "$@"; do
    REMESHD_REQUIRE_CORPUS=0 "$program" --gtest_filter="$test" >"$work/log" 2>&1 || fail "$test fails without the corpus"
    grep -q 'SKIPPED' "$work/log" || fail "$test has nothing to skip"
    ! grep -q '\[       OK' "$work/log" || fail "$test passes without the corpus"
    ! REMESHD_REQUIRE_CORPUS=1 "$program" --gtest_filter="$test" >"$work/log" 2>&1 || fail "$test succeeds without the corpus"
    grep -q "there is no \"$REMESHD_CORPUS" "$work/log" || fail "$test does not name what is missing"
    ! grep -qE 'SKIPPED|\[       OK' "$work/log" || fail "a test of $test does not fail"
  done
}
expect_skips "$core_tests" 'shared_meshes.*' '*refined_shared_meshes*' 'collection.*' 'report_files.*' \
  seams.the_cylinder_of_the_shared_collection_is_closed \
  spikes.spike_out_of_the_shared_collection_has_area_30_and_two_faces \
  inside_out.hollow_bodies_of_a_report_get_their_right_volume \
  self_intersections.counts_of_real_meshes_are_those_computed_by_other_means \
  coordinate_range.files_of_absurd_coordinates_are_refused_at_once \
  coordinate_range.absurd_sizes_of_narrow_parts_are_refused_at_once \
  obj_fast_path.real_meshes_are_read_alike
expect_skips "$api_tests" 'shared_meshes.*'

# expect_failure PROGRAM [ARGUMENT]...: it fails soon, and names the folder.
expect_failure() {
  ! REMESHD_REQUIRE_CORPUS=1 "$@" >"$work/log" 2>&1 || fail "$1 succeeds without the corpus"
  grep -q "there is no $REMESHD_CORPUS" "$work/log" || fail "$1 does not name what is missing: $(cat "$work/log")"
}
expect_failure "$mutate_fuzz" 1
expect_failure "$cancel_test" --runs 1
expect_failure bash "$root/tests/e2e/workers.sh" "$remeshd" "$remesh"

# The continuous integration requires the collection where it stands beside the checkout, and says so if it does not.
mkdir -p "$work/checkout/.ci"
cp "$root/.ci/run" "$work/checkout/.ci/run"
printf '#!/bin/sh\necho "required: ${REMESHD_REQUIRE_CORPUS:-0}"\n' >"$work/checkout/dev"
chmod +x "$work/checkout/dev"
unset REMESHD_REQUIRE_CORPUS
"$work/checkout/.ci/run" >"$work/log"
grep -q 'are skipped' "$work/log" && grep -qx 'required: 0' "$work/log" || fail ".ci/run without the corpus: $(cat "$work/log")"
mkdir -p "$work/shared/meshes"
"$work/checkout/.ci/run" >"$work/log"
[ "$(cat "$work/log")" = 'required: 1' ] || fail ".ci/run with the corpus: $(cat "$work/log")"

# A test that asks for the corpus in another way than through the helper is not seen above.
! grep -rnE 'GTEST_SKIP.*(meshes|collection|corpus)' "$root/tests" --include='*.cpp' ||
  fail "these tests do not use has_shared_mesh"
