# SPDX-License-Identifier: Apache-2.0
"""The command `as2fm-lsp`."""

from __future__ import annotations

import gc
import signal
import sys

from as2fm_lsp.collector import spare_the_collector

INTERRUPTED = 130
"""The exit status of an interrupted command, as in shells: 128 + SIGINT."""


def main() -> None:
    try:
        from as2fm_lsp.cli.main import run  # noqa: PLC0415 - an interrupt during start-up prints no traceback

        spare_the_collector()
        status = run(sys.argv[1:])
    except KeyboardInterrupt:
        status = INTERRUPTED
    # Nor does one during the end.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    gc.freeze()  # The collections with which Python ends would take a tenth of a short command.
    sys.exit(status)


if __name__ == "__main__":
    main()
