#!/usr/bin/env bash
# tsan_libraries.sh FOLDER: the libraries that ThreadSanitizer has to see into, made once from Debian's own sources.
# It follows atomics and locks only in code that it compiled; across others it takes what is ordered for a race.
#   FOLDER/lib, FOLDER/include   oneTBB, built with it
#   FOLDER/httplib/httplib.h     cpp-httplib as one header, which is then compiled with us
set -euo pipefail
[ $# = 1 ] || {
  echo "usage: $0 FOLDER" >&2
  exit 64
}
mkdir -p "$1"
cd "$1"
[ ! -e done ] || exit 0
folder=$PWD

# Where the packages come from, the sources come from.
rm -rf apt sources
mkdir -p apt/parts apt/lists/partial apt/cache/archives/partial sources
for file in /etc/apt/sources.list.d/*.sources; do
  [ -e "$file" ] && sed 's/^Types:.*/Types: deb-src/' "$file" >"apt/parts/$(basename "$file")"
done
cat /etc/apt/sources.list /etc/apt/sources.list.d/*.list 2>/dev/null | sed -n 's/^deb /deb-src /p' >apt/parts/lines.list || true
apt=(apt-get -qq -o Dir::Etc::sourcelist=/dev/null -o "Dir::Etc::sourceparts=$folder/apt/parts"
  -o "Dir::State::lists=$folder/apt/lists" -o "Dir::Cache=$folder/apt/cache")
"${apt[@]}" update
(cd sources && "${apt[@]}" source onetbb cpp-httplib)

mkdir -p httplib
cp sources/cpp-httplib-*/httplib.h httplib/
CC=clang CXX=clang++ cmake -S sources/onetbb-* -B build -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DTBB_SANITIZE=thread \
  -DTBB_TEST=OFF -DTBB_STRICT=OFF -DTBBMALLOC_BUILD=OFF -DCMAKE_INSTALL_LIBDIR=lib "-DCMAKE_INSTALL_PREFIX=$folder"
cmake --build build
cmake --install build
touch done
