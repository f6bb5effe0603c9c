#!/usr/bin/env bash
# The curls of the documents do what the documents say, against a real daemon, and so do their command lines.
. "$(dirname "$0")/daemon.sh"

# In the order in which they are meant to be read: what one command writes or sets, a later one may take.
documents=(README.md api/README.md server/README.md docker/README.md)

# commands_of PATTERN: the lines of all documents that match; sets `commands`. No other document has such lines.
commands_of() {
  local found
  mapfile -t commands < <(cd "$root" && grep -hE "$1" "${documents[@]}")
  while IFS= read -r found; do
    [[ " ${documents[*]} " == *" ${found#./} "* ]] || fail "the commands of $found are not run here"
  done < <(cd "$root" && grep -rlE "$1" --include='*.md' --exclude-dir=build --exclude-dir=node_modules .)
}

# The README begins with two: refined, not refined.
[ "$(grep -cE '^curl ' "$root/README.md")" -ge 2 ] || fail "the README has no curls"
commands_of '^(job=\$\()?curl '
[ "${#commands[@]}" -ge 8 ] || fail "the documents have ${#commands[@]} curls only"

start_daemon
# the same words, but for the port, in a copy of the folder that its file stands in
mkdir -p "$work/tests"
cp -r "$root/tests/data" "$work/tests/data"
cd "$work"
echo the-key-of-the-readme >keys
"$remesh" tests/data/bracket.obj -o part.stl 2>/dev/null || fail "part.stl, which the documents send, could not be made"
# An answer that is an error fails, too.
curl() { command curl --fail-with-body "$@"; }
for command in "${commands[@]}"; do
  [[ $command == *localhost:8080* ]] || fail "this curl of a document asks somebody else: $command"
  eval "${command//localhost:8080/$address}" || fail "$command" # in this shell: one takes up what another sets
done

coarse_faces=$(count_faces coarse.obj)
[ "$coarse_faces" -gt 0 ] || fail "no face came back"
[ "$coarse_faces" -lt 600 ] || fail "the bracket has 4800 faces and came back with $coarse_faces"
grep '^v ' coarse.obj | sort >kept
grep '^v ' tests/data/bracket.obj | sort >given
[ -z "$(comm -23 kept given)" ] || fail "a vertex came back that was not sent: $(comm -23 kept given | head -n 1)"
[ "$(count_faces out.obj)" -gt "$coarse_faces" ] || fail "refined it has no more faces"
grep '^v ' out.obj | sort >refined
[ -z "$(comm -23 kept refined)" ] || fail "refinement lost a vertex: $(comm -23 kept refined | head -n 1)"
grep '^# unrefined: ' out.obj || true

# field SUMMARY NAME
field() { sed -n "s/.*$2=\\([^,]*\\).*/\\1/p" <<<"$1"; }
for query in '' '?refine=false'; do
  summary=$(curl -sS -o /dev/null -D - --data-binary @tests/data/bracket.obj "http://$address/v1/remesh$query" |
    tr -d '\r' | sed -n 's/^[Rr]emesh-[Ss]ummary: //p')
  echo "$summary"
  [[ $summary == *input_faces=4800* && $summary == *patches=115* && $summary == *verified=1* ]] ||
    fail "the summary says: $summary"
  [ -n "$query" ] || awk -v angle="$(field "$summary" min_angle_deg)" 'BEGIN { exit !(angle >= 25) }' ||
    fail "angles below 25 degrees: $summary"
done
stop_daemon

# The same for the command line: a mesh, a folder.
commands_of '^(build/release/)?remesh '
[ "${#commands[@]}" -ge 3 ] || fail "the documents have no command lines"
rm -f out.obj part.obj
mkdir parts
cp tests/data/bracket.obj parts
for command in "${commands[@]}"; do
  eval "\"\$remesh\" ${command#* }" || fail "$command"
done
[ "$(count_faces out.obj)" -gt "$coarse_faces" ] || fail "the command line made no out.obj"
[ "$(count_faces part.obj)" -gt "$coarse_faces" ] || fail "the command line made no part.obj"
grep -q '"min_angle_deg":30' report.json || fail "the report has other options: $(head -c 300 report.json)"
grep -q '^bracket.obj,ok,' parts.csv || fail "the batch says: $(cat parts.csv)"
[ -s remeshed/bracket.stl ] || fail "the batch made no remeshed/bracket.stl"
