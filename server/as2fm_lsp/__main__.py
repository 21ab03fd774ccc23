# SPDX-License-Identifier: Apache-2.0
"""The command `as2fm-lsp`."""

from __future__ import annotations

import gc
import sys

from as2fm_lsp.collector import spare_the_collector


def main() -> None:
    from as2fm_lsp.cli.main import run  # noqa: PLC0415 - so that an interrupt during start-up prints no traceback

    spare_the_collector()
    status = run(sys.argv[1:])
    gc.freeze()  # The collections with which Python ends would take a tenth of a short command.
    sys.exit(status)


if __name__ == "__main__":
    main()
