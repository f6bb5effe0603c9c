#!/usr/bin/env bash
# The daemon from start to stop: it is well, says what is wrong with bad input and answers the next request, and ends
# well on SIGTERM.
. "$(dirname "$0")/daemon.sh"

# ask PATH [CURL OPTION]...: the status; the body goes to $work/body, its type to $work/type
ask() {
  local path=$1
  shift
  curl -sS -o "$work/body" -w '%{http_code} %{content_type}' "$@" "http://$address$path" >"$work/answer" || return 1
  cut -d ' ' -f 2- "$work/answer" >"$work/type"
  cut -d ' ' -f 1 "$work/answer"
}
expect() {
  local status=$1 code=$2
  shift 2
  local got
  got=$(ask "$@") || fail "no answer to $*"
  [ "$got" = "$status" ] || fail "$* got $got instead of $status: $(head -c 300 "$work/body")"
  [ -z "$code" ] || grep -q "\"code\": *\"$code\"" "$work/body" || fail "$* says $(head -c 300 "$work/body")"
  [ -z "$code" ] || [[ $(cat "$work/type") == application/problem+json* ]] || fail "$* has type $(cat "$work/type")"
}

start_daemon --max-body 1MiB
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >"$work/good.obj"
expect 200 '' /livez
expect 200 '' /readyz
expect 200 '' /openapi.json
expect 200 '' /v1/capabilities
"$remeshd" health --bind "$address" || fail "health says that it is not well"

good() { expect 200 '' /v1/remesh --data-binary "@$work/good.obj"; }
good
: >"$work/empty.obj"
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n' >"$work/range.obj"
printf 'v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n' >"$work/nan.obj"
head -c 100000 /dev/urandom >"$work/garbage"
head -c 2000000 /dev/zero | tr '\0' '#' >"$work/big.obj"
expect 422 index_out_of_range /v1/remesh --data-binary "@$work/range.obj"
grep -q '"line": *4' "$work/body" || fail "the line is not told: $(cat "$work/body")"
good
expect 422 nonfinite_coordinate /v1/remesh --data-binary "@$work/nan.obj"
good
expect 413 body_too_large /v1/remesh --data-binary "@$work/big.obj"
good
expect 400 unknown_option '/v1/remesh?refin=true' --data-binary "@$work/good.obj"
expect 400 invalid_option '/v1/remesh?weld_tolerance=-1' --data-binary "@$work/good.obj"
expect 400 invalid_option '/v1/remesh?max_edge_length=1&max_edge_fraction=0.1' --data-binary "@$work/good.obj"
expect 422 output_too_large '/v1/remesh?max_edge_length=1e-6' --data-binary "@$work/good.obj"
grep -q '"limit": *50000000' "$work/body" || fail "the limit is not told: $(cat "$work/body")"
good
expect 404 not_found /nowhere
good
for bad in empty.obj garbage; do
  status=$(ask /v1/remesh --data-binary "@$work/$bad") || fail "no answer to $bad"
  [[ $status == 4?? ]] || fail "$bad got $status"
  good
done

stop_daemon
! "$remeshd" health --bind "$address" 2>/dev/null || fail "health says that a stopped daemon is well"
