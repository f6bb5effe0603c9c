#!/usr/bin/env bash
# The daemon behind the proxy of docker/compose.tls.yaml: a real Caddy with docker/Caddyfile, by TLS, HTTP/2 and 1.1.
. "$(dirname "$0")/daemon.sh"
mesh=$root/tests/data/bracket.obj

caddy=$(command -v caddy || echo "$root/build/unpacked/usr/bin/caddy")
[ -x "$caddy" ] || {
  echo "SKIPPED: there is no caddy (./dev setup unpacks one)"
  exit 77
}

proxy=
stop_proxy() { [ -z "$proxy" ] || kill "$proxy" 2>/dev/null || true; }
trap 'stop_proxy; clean_up' EXIT

read -r port http_port < <(python3 -c '
import socket
sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(2)]
print(*(s.getsockname()[1] for s in sockets))')
echo the-key-behind-the-proxy >"$work/keys"
start_daemon --max-connections-per-address 512 --api-key-file "$work/keys"

# The file itself, but for the port that it would redirect from.
sed "0,/^{/s//{\n\thttp_port $http_port/" "$root/docker/Caddyfile" >"$work/Caddyfile"
grep -q http_port "$work/Caddyfile" || fail "the Caddyfile has no global options"
REMESHD_DOMAIN=https://localhost:$port REMESHD_UPSTREAM=$address XDG_DATA_HOME=$work/data XDG_CONFIG_HOME=$work/config \
  "$caddy" run --adapter caddyfile --config "$work/Caddyfile" 2>"$work/proxy.log" &
proxy=$!
answers_or_has_ended() {
  curl -ksSf -o /dev/null "https://localhost:$port/livez" 2>/dev/null || ! kill -0 "$proxy" 2>/dev/null
}
eventually answers_or_has_ended || fail "the proxy does not answer"
kill -0 "$proxy" 2>/dev/null || fail "the proxy ended at its start: $(tail -n 3 "$work/proxy.log")"

# [input=FILE] ask STATUS [CURL OPTION]...: the body goes to $work/body
ask() {
  local status=$1 got code input=${input:-/dev/null}
  shift
  # Caddy (Go) closes half a second after an answer to a body that is still being sent, or ends the stream of HTTP/2
  # there: a client that was not given the time to read it before sees a reset or a part of it, and asks again.
  for _ in $(seq 60); do
    code=0
    got=$(curl -ksS -m 600 -o "$work/body" -w '%{http_code}' -H 'X-API-Key: the-key-behind-the-proxy' "$@" <"$input") ||
      code=$?
    [[ "$status/$code" =~ ^413/(18|55|92)$ ]] || break
    sleep 1
  done
  [ "$code" = 0 ] || fail "curl $*: exit code $code, status $got"
  [ "$got" = "$status" ] || fail "curl $* got $got instead of $status: $(head -c 300 "$work/body")"
}

curl -sSf -H 'X-API-Key: the-key-behind-the-proxy' --data-binary "@$mesh" "http://$address/v1/remesh" -o "$work/direct"
truncate -s 300M "$work/large"
for version in --http2 --http1.1; do
  ask 200 "$version" --data-binary "@$mesh" "https://localhost:$port/v1/remesh"
  cmp -s "$work/body" "$work/direct" || fail "another answer comes through the proxy ($version)"
  input=$mesh ask 200 "$version" -X POST -T - "https://localhost:$port/v1/remesh"
  cmp -s "$work/body" "$work/direct" || fail "another answer comes through the proxy ($version, no length)"
  # 300 MB, announced, announced without waiting for 100 Continue, and not announced
  for way in -HX-Way:1 -HExpect:; do
    ask 413 "$version" "$way" --data-binary "@$work/large" "https://localhost:$port/v1/remesh"
    grep -q '"code":"body_too_large"' "$work/body" || fail "the proxy answers by itself: $(head -c 300 "$work/body")"
  done
  input=$work/large ask 413 "$version" -X POST -T - "https://localhost:$port/v1/remesh"
  grep -q '"code":"body_too_large"' "$work/body" || fail "the proxy answers by itself: $(head -c 300 "$work/body")"
done
code=$(curl -ksS -o /dev/null -w '%{http_code}' "https://localhost:$port/v1/capabilities")
[ "$code" = 401 ] || fail "without a key it says $code"
stop_daemon
