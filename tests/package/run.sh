#!/bin/bash
# run.sh SOURCES WORK [SUITE...]: on a bare system of each Debian (bookworm and trixie, if none is named)
# the README's two commands in a fresh clone, then the package, checked by lintian; on a second bare
# system an official's day with that package. Last, each system recomputes what the others measured.
# Exit status 77: skipped.
set -euo pipefail
sources=$1 work=$2
shift 2
suites=("$@")
((${#suites[@]} > 0)) || suites=(bookworm trixie)
skip() {
    echo "package: $*"
    [[ -z ${RUNCERT_SKIPPED:-} ]] || echo "package: $*" >>"$RUNCERT_SKIPPED"
    exit 77
}
((EUID == 0)) || skip "only root can make a system in a folder"
for program in debootstrap bwrap git; do
    command -v "$program" >/dev/null || skip "$program is not installed"
done
mirror=$(sed -n 's/^URIs: *//p; s/^deb \(http[^ ]*\/debian\) .*/\1/p' \
    /etc/apt/sources.list /etc/apt/sources.list.d/debian.sources 2>/dev/null | head -n 1) || true # either file may be missing
rm -rf -- "$work"
mkdir -p -- "$work/shared"

said() { echo "$system, $*: $((SECONDS - begun)) s"; begun=$SECONDS; }
# A root of its own, not chroot: in one, the kernel lets nobody shut in what reads a recording.
inside() { # inside COMMAND...: in the bare system $system, with nothing of this one's environment
    bwrap --bind "$work/$system" / --dev /dev --proc /proc --ro-bind /sys /sys \
        --bind "$work/shared" /shared --ro-bind-try "${RUNCERT_DATA:-/nonexistent}" /recordings \
        --die-with-parent --unshare-pid --cap-add ALL --clearenv \
        --setenv PATH /usr/sbin:/usr/bin:/sbin:/bin --setenv HOME /root \
        --setenv RUNCERT_DATA /recordings -- "$@"
}
installs() { # installs PACKAGE...
    inside env DEBIAN_FRONTEND=noninteractive apt-get install -y -q "$@" >>"$work/install.log" 2>&1 ||
        { tail -n 20 "$work/install.log"; exit 1; }
}
make_bare() { # make_bare NAME SUITE
    system=$1 begun=$SECONDS
    debootstrap --variant=minbase "$2" "$work/$1" "$mirror" >"$work/install.log" 2>&1 ||
        skip "no bare system of $2 could be made from $mirror"
    # What apt needs on this machine to reach a mirror.
    cp -r /etc/apt/apt.conf.d/. "$work/$1/etc/apt/apt.conf.d"
    inside apt-get update -q >/dev/null
    said "bare, $(du -sm "$work/$1" | cut -f1) MB"
}

# What is committed; the history goes along, because every file names the commit.
git clone --quiet --no-hardlinks "$sources" "$work/shared/clone"
status=0
for suite in "${suites[@]}"; do
    make_bare "$suite" "$suite"
    cp -r "$work/shared/clone" "$work/$suite/root/runcert"
    here() { inside bash -c "cd /root/runcert && $1"; }
    here "./runcert certify examples/land_yacht/attempt.yaml"
    said "certify"
    here "./runcert test" | tee "$work/$suite-tests.log" | grep -vE ' Passed +[0-9.]+ sec$| Start +[0-9]+: ' ||
        status=1
    said "test"
    for example in land_yacht salt_lake oval mast; do
        here "./runcert certify examples/$example/attempt.yaml --out /shared/$suite-$example --no-render --quiet" ||
            (($? == 1))
    done
    here "./runcert package /shared" && mv "$work"/shared/runcert_*.deb "$work/shared/first-$suite.deb"
    here "./runcert package /shared" && mv "$work"/shared/runcert_*.deb "$work/shared/$suite.deb"
    cmp "$work/shared/first-$suite.deb" "$work/shared/$suite.deb" # the same sources, the same bytes
    said "package, $(stat -c %s "$work/shared/$suite.deb") bytes"
    installs lintian
    inside lintian --fail-on error,warning "/shared/$suite.deb"
    said "lintian"

    make_bare "$suite-installed" "$suite"
    installs "/shared/$suite.deb"
    said "installed, $(du -sm "$work/$system" | cut -f1) MB"
    cp "$sources/tests/package/official_day.sh" "$work/$system/tmp"
    inside bash /tmp/official_day.sh
    said "an official's day"
    installs man-db bash-completion
    inside man -l /usr/share/man/man1/runcert-certify.1.gz | grep -q 'certify \[OPTIONS\] ATTEMPT'
    inside bash -c '. /usr/share/bash-completion/completions/runcert
        COMP_WORDS=(runcert ver) COMP_CWORD=1; _runcert; [[ ${COMPREPLY[*]} == verify ]]
        COMP_WORDS=(runcert verify --rec) COMP_CWORD=2; _runcert; [[ ${COMPREPLY[*]} == --recompute ]]'
    said "manual and completion"
done

# Each system with the runs of all.
for suite in "${suites[@]}"; do
    system=$suite begun=$SECONDS
    for run in "$work"/shared/*-*/; do
        name=$(basename "$run")
        # Nobody signed these runs, so that verify says no on the whole.
        inside /root/runcert/runcert verify "/shared/$name" --recompute >"$work/verified.log" || true
        grep '^yes  recompute' "$work/verified.log" | sed "s|^|$suite, $name: |" ||
            { cat "$work/verified.log"; status=1; }
    done
    said "recomputed"
done
exit "$status"
