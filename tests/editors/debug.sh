#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Tests the debug adapter with dap-mode of Emacs, which apt-get installs: a breakpoint, a step, a step back, a value.
set -eu
cd "$(dirname "$0")/../.."
. tests/environment.sh

if ! dpkg -s elpa-dap-mode >/dev/null 2>&1 && [ "$(id -u)" = 0 ]; then
    apt-get -qq update >/dev/null 2>&1 || true
    apt-get -qq install -y --no-install-recommends emacs-nox elpa-dap-mode >/dev/null 2>&1 || true
fi
dpkg -s elpa-dap-mode >/dev/null 2>&1 || fail "dap-mode is missing: as root, 'apt-get install emacs-nox elpa-dap-mode'"
prepare "[dev]"
HOME=$(mktemp -d)
export HOME
output=$(PATH="$PWD/.venv/bin:$PATH" timeout 580 emacs -q --batch -f package-initialize \
    -l tests/editors/debug.el examples/assembly_robot/main_with_bug.xml 2>&1) || true
rm -rf "$HOME"
echo "$output"
for line in "after continue: PickUp: its tick" "after stepBack: PickUp: its tick" "holding: false"; do
    echo "$output" | grep -qF "$line" || fail "dap-mode does not show: $line"
done
# The seed determines what the next step does, so only the numbers of the steps are compared.
step() { echo "$output" | sed -n "s/^after $1: .*, step \([0-9]*\)$/\1/p"; }
[ "$(step stepIn)" = "$(($(step continue) + 1))" ] || fail "a step does not lead to the next step"
[ "$(step stepBack)" = "$(step continue)" ] || fail "a step back does not lead to the previous step"
echo "dap-mode shows what it should"
