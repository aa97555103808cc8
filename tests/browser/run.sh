#!/bin/sh
# Runs the browser tests: run.sh PROGRAMS WORK (PROGRAMS: folder of runcert's programs; WORK: a folder
# to work in). The node modules are installed into WORK/modules once for each package-lock.json; a
# machine without a network takes them from RUNCERT_NODE_MODULES. Exit status 77: skipped, for want of
# a program.
set -eu
skip() {
    echo "browser: $*"
    [ -z "${RUNCERT_SKIPPED:-}" ] || echo "browser: $*" >>"$RUNCERT_SKIPPED"
    exit 77
}
if [ $# -ne 2 ]; then
    echo "run.sh: give the folder of runcert's programs and a folder to work in" >&2
    exit 2
fi
here=$(cd "$(dirname "$0")" && pwd)
for program in node npm "${RUNCERT_CHROMIUM:-/usr/bin/chromium}" minisign ssh-keygen; do
    command -v "$program" >/dev/null ||
        skip "$program is not installed (packages nodejs, npm, chromium, minisign and openssh-client)"
done
mkdir -p "$2"
work=$(cd "$2" && pwd)
if [ -z "${RUNCERT_NODE_MODULES:-}" ]; then
    RUNCERT_NODE_MODULES=$work/modules
    if ! cmp -s "$here/package-lock.json" "$RUNCERT_NODE_MODULES/installed-lock.json"; then
        rm -rf "$RUNCERT_NODE_MODULES"
        mkdir -p "$RUNCERT_NODE_MODULES"
        cp "$here/package.json" "$here/package-lock.json" "$RUNCERT_NODE_MODULES"
        (cd "$RUNCERT_NODE_MODULES" && npm ci --ignore-scripts --no-audit --no-fund) ||
            skip "npm could not fetch what package-lock.json lists: give the machine a network, or" \
                "name a folder with these modules in RUNCERT_NODE_MODULES"
        cp "$here/package-lock.json" "$RUNCERT_NODE_MODULES/installed-lock.json"
    fi
fi
export RUNCERT_NODE_MODULES RUNCERT_BIN="$1" RUNCERT_BROWSER_WORK="$work/pages"
exec node --test "$here/browser.test.mjs"
