#!/usr/bin/env bash
# The files of docker/ that deploy the daemon, checked without an engine and without a cluster: check.sh REMESHD FOLDER
# FOLDER keeps the packages of npm from one time to the next. Exit code 77: npm or docker-compose is not there.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
docker=$here/../../docker
remeshd=$(realpath "$1")
folder=$2

command -v npm >/dev/null || { echo "SKIPPED: there is no npm"; exit 77; }
command -v docker-compose >/dev/null || { echo "SKIPPED: there is no docker-compose"; exit 77; }

mkdir -p "$folder"
cp "$here/package.json" "$here/package-lock.json" "$here/check.mjs" "$folder/"
cd "$folder"
if ! cmp -s package-lock.json installed-lock.json; then
  npm ci --no-audit --no-fund --ignore-scripts --loglevel=error
  cp package-lock.json installed-lock.json
fi
env -i PATH="$PATH" "$remeshd" --print-config >settings
grep -o '"remeshd_[a-z_]*"' "$here/../../server/observe/metrics.cpp" | tr -d '"' >metrics
node check.mjs "$docker" settings metrics

export POSTGRES_PASSWORD=check REMESHD_API_KEY=check-0123456789ab
docker-compose -f "$docker/compose.yaml" config -q
docker-compose -f "$docker/compose.yaml" -f "$docker/compose.tls.yaml" config -q
docker-compose -f "$docker/compose.scale.yaml" config -q
# A password is needed, and said to be.
if env -u POSTGRES_PASSWORD docker-compose -f "$docker/compose.scale.yaml" config -q 2>/dev/null; then
  echo "FAILED: compose.scale.yaml takes no password for one"
  exit 1
fi
