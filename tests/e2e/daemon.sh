# For the scripts beside it: start and stop a daemon, and say what went wrong.
# Sets `root` (of the sources), `shared` and `is_corpus_required` (of the real meshes), `work` (a folder that is removed at
# the end), `remeshd` and `remesh`.

set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
remeshd=$(realpath "$1")
remesh=$(realpath "$2")
work=$(mktemp -d)
daemon=
# The collection of real meshes: its folder, and whether a test must fail without it.
shared=${REMESHD_CORPUS:-$root/../shared/meshes}
is_corpus_required=${REMESHD_REQUIRE_CORPUS:-0}
# What is set outside must not change what is tested.
for variable in "${!REMESHD_@}"; do unset "$variable"; done
# Where jobs go by default, and nobody else's.
export XDG_STATE_HOME=$work/state

# eventually COMMAND [ARGUMENT]...: tries it until it succeeds, for minutes, so that a busy machine is not mistaken for a
# fault.
eventually() {
  local end=$((SECONDS + 120))
  until "$@"; do
    [ "$SECONDS" -lt "$end" ] || return 1
    sleep 0.05
  done
}

clean_up() {
  [ -z "$daemon" ] || kill "$daemon" 2>/dev/null || true
  rm -rf "$work"
}
trap clean_up EXIT

fail() {
  printf 'FAILED: %s\n' "$*" >&2
  if [ -s "$work/log" ]; then
    echo "the daemon's log:" >&2
    tail -n 20 "$work/log" >&2
  fi
  exit 1
}

# Whether the daemon has told where it listens; sets `address`.
listens() {
  address=$(sed -n 's/.*"address": *"\(127\.0\.0\.1:[0-9]*\)".*/\1/p' "$work/log" | head -n 1)
  [ -n "$address" ] || ! kill -0 "$daemon" 2>/dev/null
}

# start_daemon [OPTION]...: on a free port; sets `daemon` (the process) and `address`.
start_daemon() {
  : >"$work/log" # it is looked into before the daemon may have opened it
  "$remeshd" --bind 127.0.0.1:0 --log-format json "$@" 2>"$work/log" &
  daemon=$!
  eventually listens || fail "the daemon does not say where it listens"
  [ -n "$address" ] || fail "the daemon ended at its start"
}

# Stops it as an orchestrator does; its exit code must be 0.
stop_daemon() {
  local code=0
  kill -TERM "$daemon"
  wait "$daemon" || code=$?
  daemon=
  [ "$code" = 0 ] || fail "exit code $code after SIGTERM"
}

count_faces() { grep -c '^f ' "$1" || true; }
