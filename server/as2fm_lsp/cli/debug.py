# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp debug`: the debug adapter on standard input and output."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

from as2fm_lsp.cli.arguments import ArgumentParser
from as2fm_lsp.cli.exit_status import CLEAN
from as2fm_lsp.collector import spare_the_collector

EXAMPLES = """\
An editor starts this program; docs/debugging.md describes the configuration. The arguments of `launch` are:
  program       the system file, or a JANI model
  property      the property that is evaluated on the run (the first one)
  seed, trace   the run is the trace of `verify` with this seed and number (0, 0)
  against       N: the N-th trace in which the property does not hold
  inFavor       N: the N-th trace in which it holds
  session       the file of a saved run (`simulate --save`)
  stopOnEntry   whether the run stops at its start (true, except with `against` and `inFavor`)
  reactionTime  how long machines may wait before they take a possible step: "any", "instant", or "20 ms"
  maxTime       overrides <max_time> of the system, for example "100 s"
  parameters    {"NAME": VALUE}, for parameters that the models of a system declare
  constants     {"NAME": VALUE}, for constants of a JANI model
  rosPath       folders with ROS interface packages

example:
  as2fm-lsp debug

exit status: 0 the session has ended; 2 usage error; 3 internal error
"""


def run(arguments: Sequence[str]) -> int:
    parser().parse_args(arguments)
    from as2fm_lsp.debug.adapter import Adapter  # noqa: PLC0415
    from as2fm_lsp.debug.framing import MessageReader  # noqa: PLC0415

    spare_the_collector()
    # Only the adapter may write into the stream of messages.
    output = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    # The reading thread may still wait for input when the program ends, which must not wait for `sys.stdin`.
    Adapter(MessageReader(os.fdopen(os.dup(sys.stdin.fileno()), "rb")), output).run()
    return CLEAN


def parser() -> ArgumentParser:
    return ArgumentParser(
        prog="as2fm-lsp debug",
        description="Debug runs of systems and JANI models: a debug adapter (DAP) on standard input and output.",
        epilog=EXAMPLES,
    )
