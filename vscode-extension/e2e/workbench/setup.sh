#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Makes ready what the end-to-end tests run in: a VS Code server in .cache/workbench, from the npm registry alone, and
# Debian's Chromium and ripgrep. Takes about two minutes the first time and nothing later. The checkouts of a user share
# the server: .cache/workbench is a link into the user's folder of caches.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
link=$(cd "$here/../../.." && pwd)/.cache/workbench

fail() {
    echo "The end-to-end tests cannot run: $1" >&2
    exit 1
}

# The package of Debian that has a program
need() {
    command -v "$1" >/dev/null 2>&1 && return
    if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null 2>&1; then
        [ -n "${updated:-}" ] || apt-get -qq update >/dev/null 2>&1 || true
        updated=yes
        DEBIAN_FRONTEND=noninteractive apt-get -qq install -y --no-install-recommends $2 >/dev/null 2>&1 || true
    fi
    command -v "$1" >/dev/null 2>&1 || fail "$1 is missing: as root, 'apt-get install $2'"
}

need node nodejs
need npm npm
need chromium "chromium fonts-dejavu-core"
need rg ripgrep

version=$(cat "$here/package-lock.json" "$here/setup.sh" | cksum | cut -d " " -f 1)-node-$(node --version)
shared=${XDG_CACHE_HOME:-$HOME/.cache}/as2fm-lsp/workbench-$version
use_shared() {
    mkdir -p "$(dirname "$link")"
    [ -L "$link" ] || rm -rf "$link"
    ln -sfn "$shared" "$link"
}
if [ -d "$shared" ]; then
    use_shared
    exit
fi

need make make
need c++ g++
need python3 python3

cache=$shared.$$ # renamed when it is complete
trap 'rm -rf "$cache"' EXIT
mkdir -p "$cache"
cp "$here/package.json" "$here/package-lock.json" "$here/.npmrc" "$cache"
log=$cache/setup.log
prefix=$(dirname "$(dirname "$(node -p process.execPath)")")
if [ -f "$prefix/include/node/node.h" ]; then
    export npm_config_nodedir="$prefix" # else node-gyp fetches the headers
fi

step() {
    (cd "$1" && shift && "$@") >>"$log" 2>&1 || {
        tail -n 20 "$log" >&2
        fail "'$*' failed in $1; is the npm registry reachable?"
    }
}

vscode=$cache/node_modules/code-server/lib/vscode
step "$cache" npm ci
step "$vscode" npm install --ignore-scripts --omit=dev --no-audit --no-fund
step "$vscode/extensions" npm install --ignore-scripts --omit=dev --no-audit --no-fund
for native in node-pty @vscode/spdlog native-watchdog @parcel/watcher; do
    step "$vscode/node_modules/$native" "$cache/node_modules/.bin/node-gyp" rebuild
done
mkdir -p "$vscode/node_modules/@vscode/ripgrep/bin"
ln -sf "$(command -v rg)" "$vscode/node_modules/@vscode/ripgrep/bin/rg"
ln -sfn node_modules "$vscode/node_modules.asar"
mv -T "$cache" "$shared" 2>/dev/null || [ -d "$shared" ] # another checkout may have been faster
use_shared
