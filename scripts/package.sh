#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes the source archive and the Debian packages of the last commit in build/package, from nothing
# but the archive: package.sh [--test] [--twice [--anew]]. docs/packages.md describes them.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."
out=$PWD/build/package

say() { printf 'package: %s\n' "$*"; }
fail() {
  printf 'package: %s\n' "$*" >&2
  exit 1
}

test=no twice=no anew=no
for word in "$@"; do
  case $word in
    --test) test=yes ;;
    --twice) twice=yes ;;
    --anew) anew=yes ;;
    *) fail "unknown argument '$word'; expected --test, --twice or --anew" ;;
  esac
done
[ "$anew" = no ] || [ "$twice" = yes ] || fail "--anew needs --twice: it compiles the second time without the cache"

git rev-parse --verify -q HEAD >/dev/null ||
  fail "this is no clone of the repository; docs/packages.md says how to build the packages from a source archive"
[ -z "$(git status --porcelain)" ] ||
  say "the packages are made of the last commit; the changes since then are not in them"

# archive CLONE FILE: the sources of its last commit. The same commit gives the same bytes.
archive() {
  git -C "$1" archive --format=tar --prefix="$name/" HEAD | gzip -9n >"$2"
}

# build ARCHIVE FOLDER: packages in FOLDER, from sources unpacked there. Their place in it, and the name
# build/release, are those of an ordinary build, so that ccache finds what that has compiled.
build() {
  mkdir -p "$2"
  tar -xzf "$1" -C "$2"
  (
    umask 022
    cd "$2/$name"
    cmake --preset package -B build/release >../log 2>&1 &&
      cmake --build build/release -j "$(nproc)" >>../log 2>&1 &&
      cpack --config build/release/CPackConfig.cmake -B .. >>../log 2>&1
  ) || {
    tail -n 30 "$2/log"
    fail "building the packages failed; $2/log has the whole output"
  }
  rm -rf "$2/_CPack_Packages"
}

read -r version _ < <(cmake -P cmake/package/version.cmake)
name=quadtune-$version
rm -rf "$out"
mkdir -p "$out"

say "source archive of $name"
archive . "$out/$name.tar.gz"
say "building from it"
build "$out/$name.tar.gz" "$out/built"
mv "$out"/built/*.deb "$out"

if [ "$twice" = yes ]; then
  say "once more, from another clone in another folder"
  mkdir "$out/again"
  git clone -q . "$out/again/clone"
  archive "$out/again/clone" "$out/again/$name.tar.gz"
  [ "$anew" = no ] || export CCACHE_RECACHE=1
  build "$out/again/$name.tar.gz" "$out/again/in/another/folder"
  mv "$out"/again/in/another/folder/*.deb "$out/again"
  for file in "$out"/*.deb "$out"/*.tar.gz; do
    cmp "$file" "$out/again/${file##*/}" || fail "the second build has other bytes"
  done
  count=$(find "$out/again" -maxdepth 1 -name '*.deb' | wc -l)
  [ "$count" = "$(find "$out" -maxdepth 1 -name '*.deb' | wc -l)" ] ||
    fail "the second build made $count packages"
  say "the second build has the same bytes"
  rm -rf "$out/again"
fi

say "lintian"
root=()
[ "$(id -u)" != 0 ] || root=(--allow-root)
# The tag that is left out is about uploads to Debian.
lintian "${root[@]}" --fail-on error --tag-display-limit 0 \
  --suppress-tags initial-upload-closes-no-bugs "$out"/*.deb

[ "$test" = no ] || tests/install/package_test.sh "$out"/*.deb

printf '\n%-58s %12s %16s\n' "in build/package" 'bytes' 'installed [KiB]'
for file in "$out"/*.tar.gz "$out"/*.deb; do
  installed=
  [ "${file##*.}" != deb ] || installed=$(dpkg-deb -f "$file" Installed-Size)
  printf '%-58s %12s %16s\n' "${file##*/}" "$(stat -c %s "$file")" "$installed"
done
