# SPDX-License-Identifier: Apache-2.0
"""The command `as2fm-lsp`."""

from __future__ import annotations

import atexit
import gc
import os
import signal
import sys
from contextlib import suppress

INTERRUPTED = 130
"""The exit status of an interrupted command, as in shells: 128 + SIGINT."""


def main() -> None:
    status = 1  # that of Python after a traceback

    def end() -> None:
        """End the process. Python would destroy its objects one by one, which takes 5 ms."""
        for stream in (sys.stdout, sys.stderr):
            with suppress(AttributeError, OSError, ValueError):  # It is closed; `run` has reported what is lost.
                stream.flush()
        os._exit(status)

    atexit.register(end)  # The first function that is registered is called last.
    try:
        _import_msgspec()
        from as2fm_lsp.cli.main import run  # noqa: PLC0415 - an interrupt during start-up prints no traceback

        # The cycles of a command do not grow with its work (tests/cli/test_cli_garbage.py). Looking for them would take
        # a fifth of the time to verify a JANI file of 16 MB. The server and the debugger collect garbage rarely.
        gc.disable()
        status = run(sys.argv[1:])
    except KeyboardInterrupt:
        status = INTERRUPTED
    # Nor does one during the end.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    sys.exit(status)


def _import_msgspec() -> None:
    """Import `msgspec` without `typing_extensions`, from which it takes forms of `TypedDict` that no record uses. This
    would import `inspect`, `ast` and `tokenize`, too: a tenth of the start of a command."""
    hidden = "typing_extensions"
    if hidden in sys.modules:
        return
    sys.modules[hidden] = None  # type: ignore[assignment]  # an `import` then raises an ImportError
    try:
        import msgspec  # noqa: F401, PLC0415
    finally:
        del sys.modules[hidden]


if __name__ == "__main__":
    main()
