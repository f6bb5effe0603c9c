#!/usr/bin/env bash
# The plain `curl --data-binary` takes a file of 100 MB: a flat square of 2.5 million triangles comes back as two.
. "$(dirname "$0")/daemon.sh"

awk -v n=1120 'BEGIN {
  for (i = 0; i <= n; ++i) for (j = 0; j <= n; ++j) printf "v %.12f %.12f 0.500000000000\n", i / 1024, j / 1024
  for (i = 0; i < n; ++i) for (j = 1; j <= n; ++j) {
    a = i * (n + 1) + j; b = a + n + 1
    printf "f %d %d %d\nf %d %d %d\n", a, b, b + 1, a, b + 1, a + 1
  }
}' >"$work/square.obj"
[ "$(stat -c %s "$work/square.obj")" -gt 100000000 ] || fail "the file is too small: $(stat -c %s "$work/square.obj")"

start_daemon
curl -sSf --data-binary "@$work/square.obj" "http://$address/v1/remesh?refine=false" -o "$work/out.obj" || fail "it is refused"
[ "$(count_faces "$work/out.obj")" = 2 ] || fail "$(count_faces "$work/out.obj") faces instead of 2"
[ "$(grep -c '^v ' "$work/out.obj")" = 4 ] || fail "not 4 vertices"
stop_daemon
