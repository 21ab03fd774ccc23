#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds the documentation as a website in build/site. `sh docs/site.sh serve` shows it while pages are written.
set -eu
cd "$(dirname "$0")/.."
. tests/environment.sh
prepare "[docs]"
.venv/bin/python docs/site.py
exec .venv/bin/mkdocs "${1:-build}" --config-file build/pages/mkdocs.yml
