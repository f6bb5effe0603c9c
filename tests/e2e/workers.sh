#!/usr/bin/env bash
# The same bytes for 1 and 8 workers and on every run, from the daemon and from the command line.
. "$(dirname "$0")/daemon.sh"

meshes=("$root/tests/data/bracket.obj")
if [ -d "$shared/planar-cad" ] && [ -d "$shared/polygons" ]; then
  while IFS= read -r mesh; do meshes+=("$mesh"); done < <(find "$shared/planar-cad" "$shared/polygons" -name '*.obj' | sort)
elif [ "$is_corpus_required" = 1 ]; then
  fail "there is no $shared with planar-cad and polygons, and REMESHD_REQUIRE_CORPUS is 1"
else
  echo "SKIPPED in part: there is no $shared with planar-cad and polygons, so only the project's own mesh is tried"
fi

# What is asked for, as query and as flags.
queries=('refine=false' 'min_angle_deg=25' 'proximity=1&min_angle_deg=20&max_edge_fraction=0.1')
as_flags() {
  local pair
  for pair in ${1//&/ }; do
    pair=${pair//_/-}
    printf -- '--%s\n' "$pair"
  done
}

for run in 1 8 8; do
  start_daemon --workers "$run"
  for i in "${!meshes[@]}"; do
    mesh=${meshes[$i]}
    for query in "${queries[@]}"; do
      mapfile -t flags < <(as_flags "$query")
      curl -sSf --data-binary "@$mesh" -H 'Content-Type: model/obj' "http://$address/v1/remesh?$query" -o "$work/http" ||
        fail "the daemon refuses $mesh with $query"
      "$remesh" "$mesh" -o "$work/cli.obj" --workers "$run" "${flags[@]}" 2>"$work/cli.log" ||
        fail "remesh refuses $mesh with ${flags[*]}: $(cat "$work/cli.log")"
      for way in http cli.obj; do
        first="$work/first-$i-$query-$way"
        [ -e "$first" ] || cp "$work/$way" "$first"
        cmp "$first" "$work/$way" || fail "$mesh differs with $run workers ($way, $query)"
      done
      grep '^[vf] ' "$work/http" >"$work/http.vf"
      grep '^[vf] ' "$work/cli.obj" | cmp - "$work/http.vf" || fail "$mesh: daemon and command line differ ($query)"
    done
  done
  stop_daemon
done
echo "${#meshes[@]} meshes"
