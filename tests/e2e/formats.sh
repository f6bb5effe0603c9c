#!/usr/bin/env bash
# Formats over HTTP, as curl sends them: told by type, by content, compressed or not; and the same from the command line.
. "$(dirname "$0")/daemon.sh"

part=$root/tests/data/bracket.obj
start_daemon --max-decompressed 2MiB

# post FILE OUT [CURL OPTION]...: prints the status
post() {
  local file=$1 out=$2
  shift 2
  curl -sS --data-binary "@$file" "http://$address/v1/remesh?refine=false" -o "$out" -w '%{http_code}' "$@"
}

# Through each format and back: the same number of faces as by the plain way.
[ "$(post "$part" "$work/plain.obj")" = 200 ] || fail "the OBJ is refused"
faces=$(count_faces "$work/plain.obj")
[ "$faces" -gt 100 ] || fail "only $faces faces"
for type in model/stl application/x-ply application/x-off; do
  name=${type##*[/-]}
  [ "$(post "$part" "$work/part.$name" -H "Accept: $type")" = 200 ] || fail "no answer as $type"
  [ "$(post "$work/part.$name" "$work/by_content.obj" -H "Accept: model/obj")" = 200 ] || fail "$name is not known by its content"
  [ "$(post "$work/part.$name" "$work/by_type.obj" -H "Accept: model/obj" -H "Content-Type: $type")" = 200 ] ||
    fail "$name is not read as $type"
  cmp "$work/by_content.obj" "$work/by_type.obj" || fail "$name depends on how it is told"
  [ "$(count_faces "$work/by_type.obj")" = "$faces" ] || fail "$name: $(count_faces "$work/by_type.obj") faces, not $faces"
  "$remesh" "$work/part.$name" -o "$work/cli.obj" --refine false || fail "$name: the command line"
  cmp "$work/by_type.obj" "$work/cli.obj" || fail "$name: daemon and command line differ"
done
[ "$(post "$part" "$work/out.vtu" -H "Accept: application/x-vtu")" = 200 ] || fail "no answer as vtu"
[ "$(post "$part" "$work/out.msh" -H "Accept: application/x-gmsh")" = 200 ] || fail "no answer as msh"

# Compressed, as a file and as a coded body.
gzip -c "$part" >"$work/part.obj.gz"
[ "$(post "$work/part.obj.gz" "$work/file.obj")" = 200 ] || fail "a gz file is refused"
[ "$(post "$work/part.obj.gz" "$work/coded.obj" -H "Content-Encoding: gzip")" = 200 ] || fail "a gzip body is refused"
cmp "$work/plain.obj" "$work/file.obj" || fail "a gz file gives another mesh"
cmp "$work/plain.obj" "$work/coded.obj" || fail "a gzip body gives another mesh"

# expect STATUS CODE FILE [CURL OPTION]...
expect() {
  local status=$1 code=$2 file=$3 got
  shift 3
  got=$(post "$file" "$work/problem" "$@")
  [ "$got" = "$status" ] || fail "$file: $got, not $status"
  grep -q "\"code\":\"$code\"" "$work/problem" || fail "$file: $(cat "$work/problem"), not $code"
}
expect 400 malformed_request "$part" -H "Content-Encoding: gzip"
expect 415 unsupported_media_type "$part" -H "Content-Encoding: br"
expect 415 unsupported_media_type "$work/out.vtu" -H "Content-Type: application/x-vtu"
head -c 1000 "$work/part.stl" >"$work/cut.stl"
expect 422 invalid_mesh "$work/cut.stl"
grep -q '"byte":1000' "$work/problem" || fail "the problem names no byte: $(cat "$work/problem")"
head -c 3000000 /dev/zero | gzip -c >"$work/bomb.gz"
expect 413 decompressed_too_large "$work/bomb.gz"
expect 413 decompressed_too_large "$work/bomb.gz" -H "Content-Encoding: gzip"
stop_daemon
