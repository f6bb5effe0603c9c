#!/usr/bin/env bash
# Requests as tools make them, by curl: every way to send a mesh and to ask for an answer; keys, origins, observation.
. "$(dirname "$0")/daemon.sh"
mesh=$root/tests/data/bracket.obj

# ask STATUS [CURL OPTION]... PATH: the body goes to $work/body, the head to $work/head
ask() {
  local status=$1 got
  shift
  local path=${*: -1}
  set -- "${@:1:$#-1}"
  got=$(curl -sS -o "$work/body" -D "$work/head" -w '%{http_code}' "$@" "http://$address$path") || true
  [ "$got" = "$status" ] || fail "curl $* $path got $got instead of $status: $(head -c 300 "$work/body")"
}
header() { tr -d '\r' <"$work/head" | sed -n "s/^$1: //Ip" | head -n 1; }
same() { cmp -s "$work/body" "$work/plain" || fail "$1 gives another answer"; }
digest_of() {
  local hex
  hex=$(sha256sum <"$1" | cut -d ' ' -f 1)
  # shellcheck disable=SC2059
  printf 'sha-256=:%s:' "$(printf "$(sed 's/../\\x&/g' <<<"$hex")" | base64 -w 0)"
}

start_daemon --ops-bind 127.0.0.1:0
ops=$(sed -n 's/.*"ops_address": *"\([^"]*\)".*/\1/p' "$work/log")

# every way to send one gives the same answer
ask 200 --data-binary "@$mesh" '/v1/remesh?refine=false'
cp "$work/body" "$work/plain"
[ "$(header Repr-Digest)" = "$(digest_of "$work/plain")" ] || fail "the digest is $(header Repr-Digest)"
[[ $(header Server-Timing) == *total\;dur=* ]] || fail "no times: $(cat "$work/head")"
[ -n "$(header X-Request-Id)" ] || fail "no request id"
[ "$(header Connection)" = keep-alive ] || fail "it does not say that the connection is kept"
ask 200 -H 'Connection: close' --data-binary "@$mesh" '/v1/remesh?refine=false'
same 'a connection of its own'
[ "$(header Connection)" = close ] || fail "it does not say that it closes"
ask 200 -H 'Content-Type: model/obj' --data-binary "@$mesh" '/v1/remesh?refine=false'
same 'a named type'
ask 200 -H 'Transfer-Encoding: chunked' --data-binary "@$mesh" '/v1/remesh?refine=false'
same 'a body in chunks'
ask 200 -H 'Expect: 100-continue' --data-binary "@$mesh" '/v1/remesh?refine=false'
same 'a client that waits for 100 Continue'
ask 200 --http1.0 --data-binary "@$mesh" '/v1/remesh?refine=false'
same 'HTTP/1.0'
got=$(curl -sS -o /dev/null -o "$work/body" -w '%{num_connects}' --data-binary "@$mesh" \
  "http://$address/v1/remesh?refine=false" "http://$address/v1/remesh?refine=false")
[ "$got" = 10 ] || fail "two requests made connections: $got instead of 1 and 0"
same 'a kept connection'
ask 200 -F "mesh=@$mesh" -F 'options={"refine": false};type=application/json' /v1/remesh
same 'a form'
[[ $(header Content-Disposition) == *bracket* ]] || fail "the name of the upload is lost: $(header Content-Disposition)"
# a word with a sign changes the default list, however the plus is written in the query
for plus in + %2B %20; do
  ask 200 -H 'Accept: application/json' --data-binary "@$mesh" "/v1/remesh?refine=false&repair=${plus}inside_out,-winding"
  grep -q '"repair": *"[^"]*inside_out"' "$work/body" || fail "${plus}inside_out did not add it"
  grep -q '"repair": *"[^"]*duplicates[^"]*"' "$work/body" || fail "${plus}inside_out replaced the list"
  ! grep -q '"repair": *"[^"]*winding' "$work/body" || fail '-winding left it in'
done
ask 400 --data-binary "@$mesh" '/v1/remesh?refine=false&repair=+inside_out,winding'
grep -q 'mixes' "$work/body" || fail "mixed words got: $(cat "$work/body")"
gzip -c "$mesh" >"$work/mesh.gz"
ask 200 -H 'Content-Encoding: gzip' --data-binary "@$work/mesh.gz" '/v1/remesh?refine=false'
same 'a compressed body'
ask 200 -H 'Accept-Encoding: gzip' --data-binary "@$mesh" '/v1/remesh?refine=false'
[ "$(header Content-Encoding)" = gzip ] || fail 'the answer is not compressed'
[ "$(header Repr-Digest)" = "$(digest_of "$work/body")" ] || fail 'the digest is not that of the compressed answer'
gzip -dc <"$work/body" >"$work/unzipped" && mv "$work/unzipped" "$work/body"
same 'a compressed answer'
ask 200 -H 'Content-Type: application/json' \
  -d '{"mesh":{"vertices":[[0,0,0],[1,0,0],[0,1,0]],"faces":[[0,1,2]]},"options":{"refine":false}}' /v1/remesh
grep -q '"verified"' "$work/body" || fail "no report: $(head -c 200 "$work/body")"

# other methods
ask 200 --head /v1/capabilities
ask 204 -X OPTIONS /v1/remesh
[[ $(header Allow) == *POST* ]] || fail "Allow: $(header Allow)"
ask 405 /v1/remesh
ask 404 /nowhere
[ -z "$(header Access-Control-Allow-Origin)" ] || fail 'pages of others may ask'

# what it says of itself
trace=4bf92f3577b34da6a3ce929d0e0e4736
ask 200 -H "Traceparent: 00-$trace-00f067aa0ba902b7-01" -H 'X-Request-Id: requests-sh-0123456789' --data-binary "@$mesh" /v1/remesh
eventually grep -q requests-sh-0123456789 "$work/log" || fail 'the request is not in the log'
line=$(grep requests-sh-0123456789 "$work/log")
for part in "\"trace_id\":\"$trace\"" '"bytes_in"' '"bytes_out"' '"work_ms"' '"queue_ms"' '"triangulation"' '"input_faces":4800'; do
  [[ $line == *"$part"* ]] || fail "the log has no $part: $line"
done
curl -sS "http://$ops/metrics" >"$work/metrics"
for series in 'remeshd_http_requests_total{code="200",method="POST",route="/v1/remesh"}' remeshd_build_info \
  'remeshd_stage_duration_seconds_count{stage="triangulation"}' remeshd_http_connections remeshd_memory_reserved_bytes \
  'remeshd_patches_total{status="remeshed"}' remeshd_input_faces_count process_resident_memory_bytes; do
  grep -qF "$series" "$work/metrics" || fail "/metrics has no $series"
done
ask 200 /metrics
stop_daemon

# keys, read again on SIGHUP
printf 'the-first-key-of-requests\n' >"$work/keys"
start_daemon --api-key-file "$work/keys" --cors-origin https://tool.example
ask 200 /livez
ask 401 /v1/capabilities
ask 401 --data-binary "@$mesh" /v1/remesh
ask 200 -H 'X-API-Key: the-first-key-of-requests' /v1/capabilities
ask 200 -H 'Authorization: Bearer the-first-key-of-requests' --data-binary "@$mesh" /v1/remesh
printf 'the-second-key-of-requests\n' >"$work/keys"
kill -HUP "$daemon"
eventually grep -q 'keys read again' "$work/log" || fail 'the keys are not read again'
ask 401 -H 'X-API-Key: the-first-key-of-requests' /v1/capabilities
ask 200 -H 'X-API-Key: the-second-key-of-requests' /v1/capabilities
! grep -q 'key-of-requests' "$work/log" || fail 'a key is in the log'
ask 204 -X OPTIONS -H 'Origin: https://tool.example' -H 'Access-Control-Request-Method: POST' /v1/remesh
[ "$(header Access-Control-Allow-Origin)" = https://tool.example ] || fail 'the allowed origin is not'
"$remeshd" health --bind "$address" || fail 'health needs a key'
stop_daemon
! "$remeshd" health --bind "$address" 2>/dev/null || fail 'health says that a stopped daemon is well'

# what it refuses to start with
! "$remeshd" --check-config --bind 0.0.0.0:0 2>"$work/why" || fail 'it would listen beyond loopback without a key'
grep -q 'api-key' "$work/why" || fail "it does not say what to do: $(cat "$work/why")"
"$remeshd" --check-config --bind 0.0.0.0:0 --allow-anonymous >/dev/null || fail '--allow-anonymous is not taken'
"$remeshd" --check-config --bind 0.0.0.0:0 --api-key-file "$work/keys" >/dev/null || fail 'a key is not enough'
! "$remeshd" --check-config --api-key-file "$work/none" 2>/dev/null || fail 'a key file that is not there is taken'
! REMESHD_API_KEY=short "$remeshd" --check-config 2>/dev/null || fail 'a short key is taken'
! "$remeshd" --check-config --memory-budget lots 2>/dev/null || fail 'a bad size is taken'
! REMESHD_MAX_BODDY=1MiB "$remeshd" --check-config 2>"$work/why" || fail 'a misspelt variable is taken'
grep -q 'REMESHD_MAX_BODDY' "$work/why" || fail "it does not say which variable is wrong: $(cat "$work/why")"
REMESHD_MAX_BODY=1MiB "$remeshd" --check-config >/dev/null || fail 'a variable is not taken'
