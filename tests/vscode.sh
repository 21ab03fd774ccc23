#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Checks the VS Code extension: lint, types, unit tests, the package, and end-to-end tests in a real workbench.
# Arguments select end-to-end tests by name. `--static` does only what needs no Python: all but the package and the
# end-to-end tests; `--end-to-end` does the rest.
set -eu
part=${1:-}
case "$part" in --static | --end-to-end) shift ;; esac
cd "$(dirname "$0")/../vscode-extension"
. ../tests/environment.sh

command -v node >/dev/null 2>&1 && command -v npm >/dev/null 2>&1 ||
    fail "The VS Code extension cannot be tested: Node.js 20 or newer with npm is needed"
[ "$(node -p 'process.versions.node.split(".")[0] >= 20')" = true ] ||
    fail "The VS Code extension cannot be tested: Node.js $(node --version) is too old, 20 is needed"

quietly() {
    echo "$*"
    log=$(mktemp)
    "$@" >"$log" 2>&1 || {
        cat "$log" >&2
        rm -f "$log"
        fail "failed: $*"
    }
    rm -f "$log"
}

if [ "$part" != --end-to-end ]; then
    wanted="$(cat package.json package-lock.json | cksum) $(node --version)"
    if [ "$(cat node_modules/.prepared 2>/dev/null)" != "$wanted" ]; then
        quietly npm ci
        echo "$wanted" >node_modules/.prepared
    fi
    quietly npm run lint
    quietly npm run unit
    sh e2e/workbench/setup.sh
fi
if [ "$part" != --static ]; then
    quietly npm run package
    npm run --silent e2e -- "$@" || fail "failed: npm run e2e"
fi
