# SPDX-License-Identifier: Apache-2.0
"""The command `as2fm-lsp`."""

from __future__ import annotations

import gc
import sys


def main() -> None:
    from as2fm_lsp.cli.main import run  # noqa: PLC0415 - so that an interrupt during start-up prints no traceback

    spare_the_collector()
    status = run(sys.argv[1:])
    gc.freeze()  # The collections with which Python ends would take a tenth of a short command.
    sys.exit(status)


def spare_the_collector() -> None:
    """Reduce the frequency of cyclic garbage collection.

    The trees of the parsers are large and contain almost no cycles. With the default thresholds, the collector takes a
    sixth of the time of a check, more for larger systems, and delays every fifth keystroke in an editor by 80 ms.
    """
    gc.set_threshold(50_000)


if __name__ == "__main__":
    main()
