#!/usr/bin/env bash
# Which packages ./dev asks for on a machine that has none; nothing is installed and nothing built: dev_test.sh
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() {
  echo "FAILED: $*" >&2
  exit 1
}

# Programs in place of the system's: no package is there, and what is to be installed is written down, and fails.
mkdir "$work/bin"
printf '#!/bin/sh\nexit 1\n' >"$work/bin/dpkg-query"
printf '#!/bin/sh\n[ "$1" != install ] || { echo "$*" >"%s/asked"; exit 1; }\n' "$work" >"$work/bin/apt-get"
printf '#!/bin/sh\nwhile [ "${1#*=}" != "$1" ]; do shift; done\nexec "$@"\n' >"$work/bin/sudo"
chmod +x "$work"/bin/*

# asked COMMAND [ARGUMENT]...: the packages, one a line; npm aside, which node may have brought
asked() {
  rm -f "$work/asked"
  ! PATH="$work/bin:$PATH" "$root/dev" "$@" >"$work/log" 2>&1 || fail "./dev $* goes on without its packages"
  [ -s "$work/asked" ] || fail "./dev $* asks for nothing: $(cat "$work/log")"
  tr ' ' '\n' <"$work/asked" | grep -vE '^(install|npm|-.*)$' | sort
}

# What the first stage of the image installs, which builds the same two programs.
sed -n '/AS build/,/rm -rf/p' "$root/docker/Dockerfile" | tr -d '\\' | tr ' ' '\n' |
  grep -E '^(g\+\+|cmake|ninja-build|pkg-config|nodejs|lib.*-dev|.*-cpp-dev|.*-json3-dev|zlib1g-dev)$' | sort >"$work/image"
asked serve >"$work/serve"
diff "$work/image" "$work/serve" >&2 || fail "./dev serve and docker/Dockerfile build from other packages"
asked setup >"$work/setup"
[ -z "$(comm -23 "$work/serve" "$work/setup")" ] || fail "./dev setup leaves out $(comm -23 "$work/serve" "$work/setup")"
for package in chromium docker-compose libcgal-dev python3-vtk9; do
  grep -qx "$package" "$work/setup" || fail "./dev setup leaves out $package"
done
# What only some parts of the benchmark need.
for parts in '' '--only cad' '--only http --only cad --runs 1'; do
  asked bench $parts >"$work/bench"
  grep -qx occt-draw "$work/bench" || fail "./dev bench $parts leaves out occt-draw"
done
asked bench --only http --step cad >"$work/bench"
! grep -qx occt-draw "$work/bench" || fail "./dev bench --only http asks for occt-draw"
asked volume-check part.stl >"$work/volume-check"
grep -qx python3-netgen "$work/volume-check" || fail "./dev volume-check leaves out python3-netgen"
