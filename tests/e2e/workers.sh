#!/usr/bin/env bash
# The same bytes for 1, 2 and 8 workers and on every run, from the daemon and from the command line.
. "$(dirname "$0")/daemon.sh"

meshes=("$root/tests/data/bracket.obj")
shared=$root/../shared/meshes
if [ -d "$shared" ]; then
  while IFS= read -r mesh; do meshes+=("$mesh"); done < <(find "$shared/planar-cad" "$shared/polygons" -name '*.obj' | sort)
else
  echo "SKIPPED in part: $shared is not there, only the project's own mesh is tried"
fi

for run in 1 2 8 8; do
  start_daemon --workers "$run"
  for i in "${!meshes[@]}"; do
    mesh=${meshes[$i]}
    curl -sSf --data-binary "@$mesh" -H 'Content-Type: model/obj' "http://$address/v1/remesh" -o "$work/http" ||
      fail "the daemon refuses $mesh"
    "$remesh" "$mesh" -o "$work/cli.obj" --workers "$run" 2>"$work/cli.log" ||
      fail "remesh refuses $mesh: $(cat "$work/cli.log")"
    for way in http cli.obj; do
      [ -e "$work/first-$i-$way" ] || cp "$work/$way" "$work/first-$i-$way"
      cmp "$work/first-$i-$way" "$work/$way" || fail "$mesh differs with $run workers ($way)"
    done
    grep '^[vf] ' "$work/http" >"$work/http.vf"
    grep '^[vf] ' "$work/cli.obj" | cmp - "$work/http.vf" || fail "$mesh: daemon and command line differ"
  done
  stop_daemon
done
echo "${#meshes[@]} meshes"
