#!/bin/sh
# Puts Embree 4 under DEST on a machine whose distribution does not package it (Debian 12).
#
#   ffi/embree4-sys/prefix.sh DEST
#
# Afterwards DEST/include/embree4/*.h and DEST/lib/libembree4.so (with its TBB) are there, and
# `EMBREE_DIR=DEST cargo build` uses them. The library comes from the PyPI wheel `embreex`, which
# has no headers; the headers come from the package libembree-dev of Debian 13, whose binary needs
# a newer C library than Debian 12 has. Both are fetched by pip and apt-get, from the mirrors that
# this machine is set up to use. Root is not needed, and the system's own packages stay as they are.
# A second run finds the finished prefix and does nothing.
set -eu

wheel="embreex==4.4.0.post1"
suite="trixie"
package="libembree-dev"
keyring="/usr/share/keyrings/debian-archive-keyring.gpg"

fail() {
    printf 'prefix.sh: %s\n' "$*" >&2
    exit 1
}

run() {
    printf '+ %s\n' "$*"
    "$@"
}

need() {
    command -v "$1" >/dev/null 2>&1 || fail "$1 is missing; it is in the Debian package $2"
}

# The mirror that serves this machine's own Debian release: the same one has the other release.
debian_mirror() {
    own_release=$(. /etc/os-release && printf '%s' "${VERSION_CODENAME:-}")
    # shellcheck disable=SC2016 # apt-get, not the shell, expands $(REPO_URI)
    apt-get indextargets --format '$(REPO_URI) $(RELEASE) $(COMPONENT)' 'Created-By: Packages' |
        while read -r uri release component; do
            if [ "$release" = "$own_release" ] && [ "$component" = main ]; then
                printf '%s\n' "$uri"
                break
            fi
        done
}

[ $# -eq 1 ] || fail "usage: prefix.sh DEST"
stamp="$wheel and $package of $suite"
if [ -f "$1/.complete" ] && [ "$(cat "$1/.complete")" = "$stamp" ]; then
    printf 'Embree 4 is already in %s (%s)\n' "$1" "$stamp"
    exit 0
fi
if [ -e "$1" ] && [ ! -f "$1/.complete" ] && [ -n "$(ls -A "$1")" ]; then
    fail "$1 exists and was not made by this script; remove it or name another directory"
fi

need apt-get apt
need dpkg-deb dpkg
need python3 python3
python3 -m pip --version >/dev/null 2>&1 || fail "pip is missing; it is in the Debian package python3-pip"
[ -r "$keyring" ] || fail "$keyring is missing; it is in the Debian package debian-archive-keyring"
mirror=$(debian_mirror)
[ -n "$mirror" ] || fail "no Debian source for this machine's release found in /etc/apt; \
install Embree 4 by other means and set EMBREE_DIR"

mkdir -p "$(dirname "$1")"
dest=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
work="$dest.partial"
rm -rf "$work"
mkdir -p "$work/prefix/include" "$work/prefix/lib" "$work/apt/lists/partial" "$work/apt/cache/archives/partial"
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

run python3 -m pip download --quiet --no-deps --only-binary :all: --dest "$work/wheel" "$wheel" ||
    fail "pip found no wheel $wheel for this Python and processor"
run python3 -m zipfile -e "$work"/wheel/embreex-*.whl "$work/wheel/content"
for file in "$work"/wheel/content/embreex.libs/*.so*; do
    cp "$file" "$work/prefix/lib/"
done
# The wheel's file names carry a hash; the linker looks for the plain name.
library=$(basename "$work"/prefix/lib/libembree4-*.so.4)
[ -f "$work/prefix/lib/$library" ] || fail "the wheel $wheel does not contain libembree4"
ln -s "$library" "$work/prefix/lib/libembree4.so"

printf 'deb [signed-by=%s] %s %s main\n' "$keyring" "$mirror" "$suite" >"$work/apt/sources.list"
apt_get() {
    run apt-get --quiet=2 \
        -o Dir::Etc::SourceList="$work/apt/sources.list" -o Dir::Etc::SourceParts=- \
        -o Dir::State::Lists="$work/apt/lists" -o Dir::Cache="$work/apt/cache" \
        -o APT::Sandbox::User="$(id -un)" -o Acquire::Languages=none "$@"
}
apt_get update || fail "apt-get could not read $suite from $mirror"
(cd "$work/apt" && apt_get download "$package/$suite") ||
    fail "apt-get could not fetch $package of $suite from $mirror"
run dpkg-deb -x "$work"/apt/"$package"_*.deb "$work/headers"
[ -f "$work/headers/usr/include/embree4/rtcore.h" ] || fail "$package of $suite has no embree4 headers"
cp -R "$work/headers/usr/include/embree4" "$work/prefix/include/"

printf '%s\n' "$stamp" >"$work/prefix/.complete"
rm -rf "$dest"
mv "$work/prefix" "$dest"
printf 'Embree 4 is in %s (%s)\n' "$dest" "$stamp"
