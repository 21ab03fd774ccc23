# SPDX-License-Identifier: Apache-2.0
"""The command `as2fm-lsp`."""

from __future__ import annotations

import gc
import sys


def main() -> None:
    from as2fm_lsp.cli.main import run  # noqa: PLC0415 - so that an interrupt during start-up is quiet, too

    spare_the_collector()
    sys.exit(run(sys.argv[1:]))


def spare_the_collector() -> None:
    """Let Python look for garbage in cycles less often.

    Our trees are large, and next to nothing in them is cyclic. At its own pace the collector takes a sixth of the time
    of a check, more the larger the system, and makes every fifth key in an editor wait for 80 ms.
    """
    gc.set_threshold(50_000)


if __name__ == "__main__":
    main()
