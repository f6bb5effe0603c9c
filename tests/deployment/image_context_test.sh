#!/usr/bin/env bash
# What .dockerignore lets into the image is enough to configure its build: image_context_test.sh CMAKE PREFIX_PATH
set -euo pipefail
cmake=$1 prefix=${2:-}
cd "$(dirname "$0")/../.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
grep -qx '\*' .dockerignore || { echo "FAILED: .dockerignore does not begin with nothing"; exit 1; }
sed -n 's/^!//p' .dockerignore | grep -v node_modules | while read -r path; do
  find "$path" -name node_modules -prune -o -type f ! -name '*.md' -print0 | xargs -0 cp --parents -t "$folder"
done
"$cmake" -S "$folder" -B "$folder/build" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" -DREMESHD_TESTS=OFF -DREMESHD_WEB=OFF \
  >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
