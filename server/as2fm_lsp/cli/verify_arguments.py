# SPDX-License-Identifier: Apache-2.0
"""The arguments of `as2fm-lsp verify`."""

from __future__ import annotations

import argparse
import math
import os
from collections.abc import Sequence

from as2fm_lsp.cli.arguments import ArgumentParser, WordAction
from as2fm_lsp.cli.formats import Format
from as2fm_lsp.cli.model_arguments import UsageError, add_model_arguments
from as2fm_lsp.cli.numbers import natural, positive, size
from as2fm_lsp.outputs import STANDARD_OUTPUT_PATH, InputPath, OutputFolder, OutputPath
from roaml.comparison import UniformPolicy
from roaml.exhaustive import Vocabulary
from roaml.experiments.bands import BandKind
from roaml.explicit.space import StateLimits
from roaml.record import replace
from roaml.smc.run import MIN_EPSILON, EstimationMethod, Options
from roaml.suggest import listing
from roaml.verification.expectations import Expectation, parse
from roaml.verification.small import SHARED_LIMITS
from roaml.verification.stuck import StuckLevel

EXAMPLES = """\
examples:
  as2fm-lsp verify main.xml                              all properties: exact values if the model has few states,
                                                         otherwise to 0.01 with 95 percent confidence
  as2fm-lsp verify main.xml --property alarm --explain   also show the shortest trace in which it fails
  as2fm-lsp verify main.xml --expect "alarm >= 0.95" --format junit
  as2fm-lsp verify model.jani --confidence 0.99 --epsilon 0.001 --jobs 8 --resume state.json
  as2fm-lsp verify main.xml --scheduler lss              the minimum and maximum probability of sampled schedulers
  as2fm-lsp verify main.xml --property stuck --explain   the probability of getting stuck, and the automata that wait
  as2fm-lsp verify tree.xml --mock "*: 0.9 in 1 s"       a tree without a system: success, time, recoveries
  as2fm-lsp verify model.jani --property "Pmax=? [ F<=100 done ]" --format csv
  as2fm-lsp verify main.xml --exhaustive                 all states: exact minimum, maximum and uniform value

In a trace, nondeterminism is resolved uniformly at random: at each step, each edge without action and each
combination of edges of a synchronisation is one choice, and all enabled choices are equally probable. A trace ends
where nothing is enabled or no choice changes anything; then F and U are false, G and W are true. The result lists how
many traces have ended for each reason. A trace is stuck if its automata wait for one another, so that time does not
advance; a warning with an example reports this.

exit status: 0 success; 1 an expectation is not met, a property cannot be answered, the model has errors, or a trace got
stuck (with --stuck error); 2 usage error; 3 internal error; 130 interrupted (143 by SIGTERM)
"""
PLOT_SUFFIXES = (".svg", ".html", ".pdf")
TRACE_OPTIONS = (
    "confidence",
    "epsilon",
    "method",
    "max_traces",
    "max_steps",
    "seed",
    "separate",
    "resume",
    "traces",
    "dask",
    "exhaustive",
)
"""The options that select random traces or all states. Without them, the size of the model decides which are used."""


class Scheduler(Vocabulary):
    """How nondeterminism is resolved."""

    UNIFORM = "uniform"
    LSS = "lss"


def parser() -> ArgumentParser:
    result = ArgumentParser(
        prog="as2fm-lsp verify",
        description="Compute the probabilities of the properties of a system or JANI model: exactly if the model has "
        "few states, otherwise as estimates from random traces.",
        epilog=EXAMPLES,
    )
    result.add_argument(
        "main",
        type=InputPath,
        metavar="MAIN.xml|MODEL.jani|TREE.xml",
        help="the system file, a JANI model, or a tree without a system; - is standard input",
    )
    add = result.add_argument
    add("--property", action="append", default=[], metavar="NAME", help="verify only this property; may be "
        "repeated. It can be written as in PRISM: 'Pmax=? [ F<=100 done ]'")  # fmt: skip
    add("--expect", action="append", default=[], metavar="'NAME >= P'", help="expect this of the "
        "property NAME, with >=, <=, >, < or ==, and exit with 1 if it does not hold; may be repeated")  # fmt: skip
    add("--uniform", action=WordAction, words=UniformPolicy, help="what an expectation is worth that is met under "
        "uniform choices, but not known to be met under all schedulers: it is met (accept), met with a warning (warn, "
        "the default), or not met, with exit status 1 (fail)")  # fmt: skip
    add_sampling(result)
    _add_search(result)
    add_model_arguments(result)
    _add_traces(result)
    add("--format", action=WordAction, words=Format, default=Format.TEXT,
        help="format of the results")  # fmt: skip
    return result


def _add_search(parser: ArgumentParser) -> None:
    """The options for the search through all states."""
    add = parser.add_argument
    add("--scheduler", action=WordAction, words=Scheduler,
        help="how nondeterminism is resolved: uniformly at random (uniform), or by "
        "schedulers that are sampled for the minimum and the maximum probability (lss); default: uniformly at random, "
        "and a warning or note states whether other schedulers may have another value")  # fmt: skip
    add("--exhaustive", "--exact", action="store_true", help="explore all states, for the exact minimum, maximum and "
        "uniform value of each property, and the shortest trace")  # fmt: skip
    add("--max-states", type=positive, metavar="N", help="explore at most N states for each property (2000000; with "
        "--exhaustive: no limit). Without --exhaustive, a property with more states is estimated from traces, with it, "
        "the property is undecided")  # fmt: skip
    add("--max-transitions", type=positive, metavar="N", help="without --exhaustive: explore at most N transitions for "
        "all properties together (8000000, which takes about 10 s; with --scheduler uniform: 2000000)")  # fmt: skip
    add("--max-memory", type=size, metavar="SIZE", help="stop when the states occupy this much memory, for example 4G "
        "or 500M (1G; with --exhaustive: half of the free memory)")  # fmt: skip
    add("--no-reductions", action="store_true", help="with --exhaustive: explore all states even if there are many; "
        "without it, choices are left out that change neither the minimum nor the maximum, and states that differ only "
        "in variables without influence are one state")  # fmt: skip


def _add_traces(parser: ArgumentParser) -> None:
    """The options for traces, and for the computers that generate them."""
    add = parser.add_argument
    add("--stuck", action=WordAction, words=StuckLevel, default=StuckLevel.WARNING,
        help="report traces that get stuck as a "
        "warning (default), or as an error with exit status 1")  # fmt: skip
    add("--separate", action="store_true", help="generate traces for each property; without it, properties share "
        "traces, with the same results")  # fmt: skip
    add(
        "--resume",
        type=InputPath,
        metavar="FILE",
        help="save the intermediate state in FILE, and continue from it if it exists",
    )
    add("--traces", type=OutputFolder, metavar="DIR", help="write traces as CSV and JSON files into DIR")
    add("--traces-limit", type=natural, default=10, metavar="N", help="with --traces: write the first N "
        "traces of each verdict, and the shortest one (10)")  # fmt: skip
    add("--explain", nargs="?", action="append", const=STANDARD_OUTPUT_PATH, default=[], type=_story_file,
        metavar="FILE", help="show the shortest trace in which the property fails (if only upper limits are "
        "expected: in which it holds), as text or in FILE.txt, FILE.mmd (Mermaid) or FILE.html; may be "
        "repeated")  # fmt: skip
    add("--quantiles", type=_shares, default=(), metavar="P,...", help="also estimate the values that these shares of "
        "the traces do not exceed, for each reward, such as 0.5,0.9")  # fmt: skip
    add_curves(parser)
    add("--dask", metavar="ADDRESS", help="run on the Dask cluster with the scheduler at this address (needs the "
        "Python package distributed)")  # fmt: skip


def add_sampling(parser: ArgumentParser, *, has_jobs: bool = True) -> None:
    """Add the options of estimates from traces."""
    add = parser.add_argument
    add(
        "--confidence",
        type=_share,
        metavar="C",
        help="the probability with which the interval contains the true value (0.95)",
    )
    add("--epsilon", type=_width, metavar="E", help="half the width of the interval (0.01); for "
        "an expected reward relative to its value")  # fmt: skip
    add("--method", action=WordAction, words=EstimationMethod,
        help="generate traces, also if the model is small: until the interval is narrow "
        "enough (adaptive, the default for larger models), as many as Hoeffding's bound requires (okamoto), until it "
        "is decided whether the expectation holds (sprt), or --max-traces (fixed)")  # fmt: skip
    add("--max-traces", type=positive, metavar="N", help="generate at most N traces")
    add("--max-steps", type=positive, metavar="N", help="cut traces after N steps; cut traces are "
        "undecided (1000000)")  # fmt: skip
    add("--seed", type=natural, metavar="N", help="seed of the random numbers (0)")
    if has_jobs:
        add(
            "--jobs",
            type=positive,
            default=_processors(),
            metavar="N",
            help="number of processes (all processors); it does not change the results",
        )


def add_curves(parser: ArgumentParser) -> None:
    """Add the options of curves over time."""
    add = parser.add_argument
    add("--plot", type=plot_file, action="append", default=[], metavar="FILE", help="draw the probability over time "
        "that each property holds and fails, from further traces with uniform choices, as .svg, .html or .pdf; may be "
        "repeated")  # fmt: skip
    add("--over-time", action="append", default=[], metavar="VARIABLE", help="with --plot: draw the median of this "
        "variable over time (Machine.variable, or a name of the JANI model); may be repeated")  # fmt: skip
    add("--band", action=WordAction, words=BandKind, default=BandKind.SIMULTANEOUS, help="with --plot: the bands "
        "contain the whole curve (simultaneous, default), or each value by itself (pointwise), with the probability of "
        "--confidence")  # fmt: skip


def plot_file(text: str) -> OutputPath:
    if not text.endswith(PLOT_SUFFIXES):
        raise argparse.ArgumentTypeError(f"`{text}` does not end in {listing(PLOT_SUFFIXES)}")
    return OutputPath(text)


def _processors() -> int:
    if hasattr(os, "sched_getaffinity"):
        return max(1, len(os.sched_getaffinity(0)))
    return os.cpu_count() or 1


def _share(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0 < value < 1:
        raise argparse.ArgumentTypeError("expected a number between 0 and 1")
    return value


def _shares(text: str) -> tuple[float, ...]:
    try:
        shares = tuple(float(part) for part in text.split(","))
    except ValueError:
        shares = ()
    if not shares or not all(0 < share < 1 for share in shares):
        raise argparse.ArgumentTypeError("expected shares greater than 0 and less than 1, such as 0.5,0.9")
    return shares


def _width(text: str) -> float:
    value = _share(text)
    if value < MIN_EPSILON:
        raise argparse.ArgumentTypeError(
            f"expected a number of at least {MIN_EPSILON:g} and less than 1; a smaller one would need too many traces"
        )
    return value


def _story_file(text: str) -> OutputPath:
    if text != STANDARD_OUTPUT_PATH and not text.endswith((".txt", ".mmd", ".html")):
        raise argparse.ArgumentTypeError(
            f"`{text}` does not end in .txt, .mmd or .html; if it is the model, name it before --explain"
        )
    return OutputPath(text)


def expectations_in(texts: Sequence[str]) -> list[Expectation]:
    """The values of `--expect`.

    Raises:
        UsageError: a text is not an expectation.
    """
    try:
        return [parse(text) for text in texts]
    except ValueError as error:
        raise UsageError(str(error)) from None


def limits_in(options: argparse.Namespace) -> Options:
    """The options of the traces.

    Raises:
        UsageError: an option has an impossible value.
    """
    names = ("confidence", "epsilon", "max_traces", "max_steps", "seed", "method")
    given = {name: value for name in names if (value := getattr(options, name)) is not None}
    try:
        return Options(**given)
    except ValueError as error:
        raise UsageError(str(error)) from None


def state_limits_in(options: argparse.Namespace) -> StateLimits:
    """The limits of searches for exact values without --exhaustive."""
    given = {"states": options.max_states, "transitions": options.max_transitions, "bytes": options.max_memory}
    return replace(SHARED_LIMITS, **{name: value for name, value in given.items() if value is not None})


def has_state_limits(options: argparse.Namespace) -> bool:
    """Whether the user has set a limit of searches for exact values."""
    return any(value is not None for value in (options.max_states, options.max_transitions, options.max_memory))


def asks_for_traces(options: argparse.Namespace) -> bool:
    """Whether an option selects random traces or all states, so that the size of the model does not decide."""
    values = [getattr(options, name) for name in TRACE_OPTIONS]
    return any(value is not None and value is not False for value in values) or options.scheduler is Scheduler.LSS
