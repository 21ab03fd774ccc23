# SPDX-License-Identifier: Apache-2.0
"""The command `as2fm-lsp`."""

from __future__ import annotations

import sys


def main() -> None:
    from as2fm_lsp.cli.main import run  # noqa: PLC0415 - so that an interrupt during start-up is quiet, too

    sys.exit(run(sys.argv[1:]))


if __name__ == "__main__":
    main()
