#!/usr/bin/env bash
# The README's curl does what the README says, against a real daemon.
. "$(dirname "$0")/daemon.sh"

command=$(grep -m 1 '^curl ' "$root/README.md") || fail "the README has no curl"
[[ $command == *localhost:8080* ]] || fail "the README's curl asks somebody else: $command"

start_daemon
# the same words, but for the port, in a copy of the folder that its file stands in
mkdir -p "$work/tests"
cp -r "$root/tests/data" "$work/tests/data"
cd "$work"
bash -euc "${command//localhost:8080/$address}" || fail "$command"

[ "$(count_faces out.obj)" -gt 0 ] || fail "no face came back"
[ "$(count_faces out.obj)" -lt 600 ] || fail "the bracket has 4800 faces and came back with $(count_faces out.obj)"
grep -v '^#' out.obj | grep '^v ' | sort >kept
grep '^v ' tests/data/bracket.obj | sort >given
[ -z "$(comm -23 kept given)" ] || fail "a vertex came back that was not sent: $(comm -23 kept given | head -n 1)"

summary=$(curl -sS -o /dev/null -D - --data-binary @tests/data/bracket.obj "http://$address/v1/remesh" |
  tr -d '\r' | sed -n 's/^[Rr]emesh-[Ss]ummary: //p')
echo "$summary"
[[ $summary == *input_faces=4800* && $summary == *patches=115* && $summary == *verified=1* ]] ||
  fail "the summary says: $summary"
stop_daemon
