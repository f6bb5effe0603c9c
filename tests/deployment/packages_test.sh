#!/usr/bin/env bash
# The Debian packages, installed beside the machine's own: packages_test.sh BUILD
# BUILD is the folder of the build. They are made, unpacked by dpkg into a folder of their own, the command of the unit is
# run from there, and after they are purged nothing is left. Exit code 77: this machine has no dpkg, or cannot make packages.
set -euo pipefail
build=$(realpath "$1")
source=$(cd "$(dirname "$0")/../.." && pwd)
for variable in "${!REMESHD_@}"; do unset "$variable"; done
for program in dpkg dpkg-deb dpkg-shlibdeps cpack curl; do
  command -v "$program" >/dev/null || { echo "SKIPPED: there is no $program"; exit 77; }
done
[ "$(id -u)" = 0 ] || { echo "SKIPPED: dpkg installs for root alone"; exit 77; }

work=$(mktemp -d)
daemon=
touch "$work/daemon"
finish() {
  [ -z "$daemon" ] || kill "$daemon" 2>/dev/null || true
  rm -rf "$work"
}
trap finish EXIT
fail() {
  echo "FAILED: $*" >&2
  exit 1
}

cpack --config "$build/CPackConfig.cmake" -B "$work/made" >"$work/log" 2>&1 || fail "cpack: $(tail -n 5 "$work/log")"
packages=("$work"/made/remesh_*.deb "$work"/made/remeshd_*.deb)
[ -e "${packages[0]}" ] && [ -e "${packages[1]}" ] || fail "there are $(ls "$work/made")"

# The packages of the libraries that the loader finds are among those that the package asks for.
for package in "${packages[@]}"; do
  name=$(dpkg-deb -f "$package" Package)
  asked=" $(dpkg-deb -f "$package" Depends | sed 's/ *([^)]*)//g; s/[,|]/ /g') "
  files=("$build/$name")
  [ "$name" != remesh ] || files+=("$build/remesh_http.so")
  needed=$(objdump -p "${files[@]}" | sed -n 's/^ *NEEDED *//p' | sort -u)
  for library in $needed; do
    path=$(ldd "${files[@]}" | sed -n "s|^[[:space:]]*$library => \\([^ ]*\\) .*|\\1|p" | head -n 1)
    [ -n "$path" ] || continue # the loader itself
    # dpkg knows some of them below /lib, where a merged system has them below /usr/lib.
    path=$(realpath "$path")
    owner=$(dpkg -S "*/$(basename "$(dirname "$path")")/$(basename "$path")" | head -n 1 | cut -d: -f1)
    # A library may be asked for by a name that its package provides, as that of spdlog is.
    is_asked=no
    for one in $owner $(dpkg-query -W -f '${Provides}' "$owner" | sed 's/([^)]*)//g; s/,/ /g'); do
      [[ $asked != *" $one "* ]] || is_asked=yes
    done
    [ $is_asked = yes ] || fail "$name needs $library of $owner, and asks for $asked"
  done
done

root=$work/root
mkdir -p "$root"/var/lib/dpkg/{info,updates,triggers} "$root"/{etc,usr/bin,usr/lib/systemd/system,usr/share/doc,var/lib}
# In folders that a machine has in any case, other packages have files.
touch "$root/var/lib/dpkg/status" "$root"/{etc,usr/bin,usr/lib/systemd/system,usr/share/doc,var/lib}/of-another
# The machine's libraries serve, so what the packages ask for is not there twice.
install_with() { dpkg --root="$root" --log=/dev/null --force-depends --force-script-chrootless "$@" >>"$work/log" 2>&1; }
traces() { (cd "$root" && find . -path ./var/lib/dpkg -prune -o -print | sort); }
traces >"$work/before"
install_with -i "${packages[@]}" || fail "they cannot be installed: $(tail -n 5 "$work/log")"

"$root/usr/bin/remesh" "$source/tests/data/bracket.obj" -o "$work/out.stl" 2>/dev/null || fail "the command line does not work"
[ -s "$work/out.stl" ] || fail "the command line wrote nothing"

# The unit's commands, in the environment that the unit gives.
unit=$root/usr/lib/systemd/system/remeshd.service
key=key-of-the-packages-test
mkdir -p "$root/etc/remeshd" "$root/var/lib/remeshd"
echo "packages $key" >"$root/etc/remeshd/api-keys"
environment=(STATE_DIRECTORY="$root/var/lib/remeshd" REMESHD_BIND=127.0.0.1:0)
while IFS= read -r setting; do
  environment+=("${setting//%d/$root/etc/remeshd}")
done < <(sed -n 's/^Environment=//p' "$unit")
while IFS= read -r setting; do environment+=("$setting"); done < <(grep -v '^#' "$root/etc/remeshd/environment")
command_of() { sed -n "s|^$1=||p" "$unit"; }
env -i "${environment[@]}" sh -c "exec $root$(command_of ExecStartPre)" >/dev/null || fail "the settings of the unit are not valid"
env -i "${environment[@]}" sh -c "exec $root$(command_of ExecStart)" 2>"$work/daemon" &
daemon=$!
for _ in $(seq 600); do
  ! grep -q '"listening"' "$work/daemon" || break
  kill -0 "$daemon" 2>/dev/null || fail "it does not start: $(cat "$work/daemon")"
  sleep 0.1
done
address=$(sed -n 's/.*"address":"\([^"]*\)".*/\1/p' "$work/daemon")
curl -fsS -H "X-API-Key: $key" --data-binary "@$source/tests/data/bracket.obj" "http://$address/v1/remesh" -o "$work/out.obj" ||
  fail "it answers no request"
REMESH_API_KEY=$key "$root/usr/bin/remesh" --server "http://$address" "$source/tests/data/bracket.obj" -o "$work/out.ply" \
  2>/dev/null || fail "the command line cannot ask it"
[ -e "$root/var/lib/remeshd/jobs.sqlite" ] || fail "it keeps no jobs in its folder"
kill "$daemon"
wait "$daemon" || fail "it ended with $?"
daemon=

# What the administrator has written stays over an upgrade and a removal, and nothing over a purge.
echo 'REMESHD_WORKERS=2' >>"$root/etc/remeshd/environment"
install_with -i "${packages[@]}" || fail "they cannot be installed again: $(tail -n 5 "$work/log")"
grep -q '^REMESHD_WORKERS=2$' "$root/etc/remeshd/environment" || fail "an upgrade has overwritten the settings"
install_with -r remesh remeshd || fail "they cannot be removed: $(tail -n 5 "$work/log")"
[ ! -e "$root/usr/bin/remeshd" ] && [ ! -e "$unit" ] || fail "a removal leaves programs"
for kept in etc/remeshd/environment etc/remeshd/api-keys var/lib/remeshd/jobs.sqlite; do
  [ -e "$root/$kept" ] || fail "a removal takes $kept"
done
install_with -P remesh remeshd || fail "they cannot be purged: $(tail -n 5 "$work/log")"
traces | diff "$work/before" - || fail "something is left"
echo "$(basename -a "${packages[@]}" | paste -sd ' '): nothing wrong"
