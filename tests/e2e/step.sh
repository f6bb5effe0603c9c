#!/usr/bin/env bash
# The line of the README that makes triangles of a STEP file does so, finely enough that its bore is found.
. "$(dirname "$0")/daemon.sh"

command -v gmsh >/dev/null || {
  echo "SKIPPED: there is no gmsh"
  exit 77
}
mapfile -t commands < <(sed -nE 's/^(gmsh part\.step [^#]*).*/\1/p' "$root/README.md")
[ "${#commands[@]}" = 1 ] || fail "the README has ${#commands[@]} lines for STEP files"

cd "$work"
cat >part.geo <<'GEO'
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 40, 30, 10};
Cylinder(2) = {20, 15, -1, 0, 0, 12, 6};
BooleanDifference{ Volume{1}; Delete; }{ Volume{2}; Delete; }
GEO
gmsh part.geo -0 -v 2 -o part.step >log || {
  echo "SKIPPED: this gmsh writes no STEP files"
  exit 77
}
eval "${commands[0]}" >log 2>&1 || fail "${commands[0]}"
"$remesh" --analyze part.stl >found || fail "part.stl is not read"
grep -q ' closed, 40 x 30 x 10$' found || fail "part.stl is another part: $(cat found)"
grep -q '1 cylinder of r 6 (hole)' found || fail "the bore is not found: $(cat found)"
"$remesh" part.stl -o part.obj --preset volume >/dev/null 2>&1 || fail "part.stl is not remeshed"
[ "$(count_faces part.obj)" -gt 50 ] || fail "part.stl came back with $(count_faces part.obj) faces"
