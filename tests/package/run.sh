#!/bin/bash
# run.sh SOURCES BUILD WORK: builds the package, asks lintian, installs it on a bare system and tries
# official_day.sh there, then the same by autopkgtest where that is installed. Exit status 77: skipped.
set -euo pipefail
sources=$1 build=$2 work=$3
skip() {
    echo "package: $*"
    [[ -z ${RUNCERT_SKIPPED:-} ]] || echo "package: $*" >>"$RUNCERT_SKIPPED"
    exit 77
}
((EUID == 0)) || skip "only root can install packages in a folder"
for program in mmdebstrap lintian chroot; do
    command -v "$program" >/dev/null || skip "$program is not installed"
done
said() { echo "$*: $((SECONDS - begun)) s"; begun=$SECONDS; }
root=$work/root
unmount() { umount "$root/proc" 2>/dev/null || true; }
trap unmount EXIT
unmount
rm -rf -- "$work"
mkdir -p -- "$work"

begun=$SECONDS
RUNCERT_BUILD_DIR=$build "$sources/runcert" package "$work"
package=$(echo "$work"/runcert_*.deb)
said "made $(stat -c %s "$package") bytes"
mv "$package" "$work/first.deb"
RUNCERT_BUILD_DIR=$build "$sources/runcert" package "$work"
cmp "$work/first.deb" "$package" # the same sources, the same bytes
begun=$SECONDS
lintian --fail-on error,warning "$package"
said "lintian"

mirror=$(sed -n 's/^URIs: *//p; s/^deb \(http[^ ]*\/debian\) .*/\1/p' \
    /etc/apt/sources.list /etc/apt/sources.list.d/debian.sources 2>/dev/null | head -n 1) || true # either file may be missing
. /etc/os-release
mmdebstrap --variant=minbase "$VERSION_CODENAME" "$root" "deb $mirror $VERSION_CODENAME main" ||
    skip "no bare system could be made from $mirror"
said "bare system, $(du -sm --exclude=proc "$root" | cut -f1) MB"
mount -t proc proc "$root/proc"
cp "$package" "$root/tmp"
chroot "$root" apt-get update -q >/dev/null
chroot "$root" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q "/tmp/${package##*/}" \
    >"$work/install.log" 2>&1 || { tail -n 20 "$work/install.log"; exit 1; }
said "installed, $(du -sm --exclude=proc "$root" | cut -f1) MB"

cp "$sources/tests/package/official_day.sh" "$root/tmp"
chroot "$root" bash /tmp/official_day.sh
said "an official's day"
chroot "$root" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q man-db bash-completion \
    >>"$work/install.log" 2>&1
chroot "$root" apt-get install -y -q --reinstall "/tmp/${package##*/}" >>"$work/install.log" 2>&1
chroot "$root" man -l /usr/share/man/man1/runcert-certify.1.gz | grep -q 'certify \[OPTIONS\] ATTEMPT'
chroot "$root" bash -c '. /usr/share/bash-completion/completions/runcert
    COMP_WORDS=(runcert ver) COMP_CWORD=1; _runcert; [[ ${COMPREPLY[*]} == verify ]]
    COMP_WORDS=(runcert verify --rec) COMP_CWORD=2; _runcert; [[ ${COMPREPLY[*]} == --recompute ]]'
said "manual and completion"

if command -v autopkgtest >/dev/null; then
    tree=$work/tree
    mkdir -p "$tree/debian"
    cp -r "$sources/tests/package/autopkgtest" "$tree/debian/tests"
    cp "$sources/tests/package/official_day.sh" "$tree/debian/tests"
    printf 'Source: runcert\nMaintainer: %s\n\nPackage: runcert\nArchitecture: any\nDescription: runcert\n' \
        "$(dpkg-deb -f "$package" Maintainer)" >"$tree/debian/control"
    zcat "$build/package/derived/changelog.gz" >"$tree/debian/changelog"
    autopkgtest --no-built-binaries "$package" "$tree/" -- chroot "$root"
    said "autopkgtest"
fi
