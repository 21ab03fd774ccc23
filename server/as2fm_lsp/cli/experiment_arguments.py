# SPDX-License-Identifier: Apache-2.0
"""The arguments of `as2fm-lsp experiment`, on the command line or in a file `NAME.experiment.toml`.

The keys of such a file are the long options of the command, without hyphens in front. Paths are relative to the file.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator, Sequence
from typing import Any

from as2fm_lsp.cli.arguments import ArgumentParser, WordAction
from as2fm_lsp.cli.mock_options import add_mock_options, declarations_in
from as2fm_lsp.cli.model_arguments import UsageError
from as2fm_lsp.cli.numbers import positive
from as2fm_lsp.cli.times import add_reaction_time, time_of
from as2fm_lsp.cli.tree_semantics import add_semantics
from as2fm_lsp.cli.verify_arguments import add_sampling, expectations_in, limits_in, plot_file
from as2fm_lsp.outputs import InputPath, OutputPath
from roaml.api.parametric_mocks import MockTexts
from roaml.disk import MEGABYTE, required
from roaml.exhaustive import Vocabulary
from roaml.experiments.beside import BesideError, BesideValue, read_beside
from roaml.experiments.grid import ExperimentOptions, Grid
from roaml.figures.themes import AUTOMATIC, THEMES
from roaml.model.kinds import EXPERIMENT_SUFFIX, mocks_path
from roaml.project.experiment_file import KEYS, KeyForm, key_name
from roaml.suggest import close_names, did_you_mean
from roaml.text import LineIndex
from roaml.toml import TomlError, loads
from roaml.verification.expectations import Expectation

EXAMPLES = """\
examples:
  as2fm-lsp experiment main.xml --set capacity=20:200:20 --property delivered
  as2fm-lsp experiment main.xml --set capacity=20:200:20 --set loss=0,0.01,0.05 --plot battery.svg
  as2fm-lsp experiment model.jani --constant p=0.1:0.1:0.9 --format csv -o p.csv
  as2fm-lsp experiment main.xml --set loss=0:1/2:1/20 --exhaustive --plot loss.html
  as2fm-lsp experiment main.xml --set capacity=20:200:20 --find capacity --meets "delivered >= 0.99"
  as2fm-lsp experiment tree.xml --set p=0.5:1:0.1 --mock 'FollowPath: $(var p) in 8 s' --mock '*: 0.9'
  as2fm-lsp experiment battery.experiment.toml

A parameter has a list of values (0,0.01,1/20) or a range: 20:200:20 and 20:20:200 are the numbers from 20 to 200 in
steps of 20. Each point is exact if the model has few states, otherwise an estimate under uniform choices; the table
states which.

exit status: 0 success; 1 a point has no value, or the model has errors; 2 usage error; 3 internal error; 130
interrupted (143 by SIGTERM)
"""
_LISTS = tuple(name for name, key in KEYS.items() if key.form is KeyForm.ENTRIES)
"""The options that may be repeated, and are lists or tables in a file."""
_NAMED = ("set", "unit", "entry")
"""The options that are named entries: one on the command line replaces the one with its name in a file."""
_REPLACED = ("property", "plot")
"""The options that, on the command line, replace all of their kind in a file."""


class TableFormat(Vocabulary):
    """The formats of the points."""

    TEXT = "text"
    CSV = "csv"
    JSON = "json"
    MARKDOWN = "markdown"


def parser() -> ArgumentParser:
    result = ArgumentParser(
        prog="as2fm-lsp experiment",
        description="Compute properties for all combinations of the values of parameters, as a table and as plots.",
        epilog=EXAMPLES,
    )
    add = result.add_argument
    add(
        "main",
        type=InputPath,
        metavar=f"MAIN.xml|TREE.xml|MODEL.jani|FILE{EXPERIMENT_SUFFIX}",
        help="a system; a tree, whose mocks use the parameters; a JANI model, whose constants are its parameters; or a "
        "file with all arguments",
    )
    add(
        "--set",
        "--constant",
        action="append",
        default=[],
        metavar="NAME=VALUES",
        help="the values of a parameter or constant: 0,0.01,1/20 or 20:200:20; may be repeated",
    )
    add("--max-time", type=time_of, metavar="TIME", help='overrides <max_time> of MAIN.xml, for example "100 s"')
    add_reaction_time(result)
    add("--ros-path", action="append", default=[], metavar="DIR", help="a folder with ROS interface packages")
    add_semantics(result)
    add("--params-file", action="append", default=[], type=InputPath, metavar="FILE", help="sets parameters from a "
        "parameter file of ROS 2 (YAML); may be repeated")  # fmt: skip
    add_mock_options(result)
    add("--property", action="append", default=[], metavar="NAME", help="compute only this property; may be repeated")
    add("--find", metavar="NAME", help="find the values of this parameter for which --meets is met")
    add("--meets", metavar="'NAME >= P'", help="with --find: the expectation, with >=, <=, >, < or ==")
    add("--assume-monotone", action="store_true", help="with --find: assume that the property only rises or only falls "
        "with the parameter, so that few points are needed; without it, all values are computed")  # fmt: skip
    add("--scheduler", choices=("uniform",), help="the values under uniform choices, instead of the minimum or "
        "maximum over all schedulers")  # fmt: skip
    add("--exhaustive", "--exact", action="store_true", help="only exact values, however many states there are")
    add("--slopes", action="store_true", help="also compute the derivatives of exact probabilities by the parameters "
        "with several values, if only probabilities depend on these")  # fmt: skip
    add("--max-states", type=positive, metavar="N", help="explore at most N states for each point")
    add("--max-transitions", type=positive, metavar="N", help="without --exhaustive: explore at most N transitions for "
        "each point (8000000 divided by the number of points, but at least 200000)")  # fmt: skip
    add_sampling(result)
    add("--dask", metavar="ADDRESS", help="run on the Dask cluster with the scheduler at this address (needs the "
        "Python package distributed)")  # fmt: skip
    add("--resume", type=InputPath, metavar="FILE", help="save the points in FILE, and do not compute those that are "
        "already there")  # fmt: skip
    _add_outputs(result)
    return result


def _add_outputs(parser: ArgumentParser) -> None:
    """The arguments about what is written."""
    add = parser.add_argument
    add("--format", action=WordAction, words=TableFormat, default=TableFormat.TEXT, help="format of the table")
    add("-o", "--output", type=OutputPath, metavar="FILE", help="write the table into a file")
    add("--plot", type=plot_file, action="append", default=[], metavar="FILE", help="draw the points, as .svg, .html "
        "or .pdf; with several plots, the names get numbers; may be repeated")  # fmt: skip
    add("--beside", action="append", default=[], type=InputPath, metavar="FILE", help="also show the values in a "
        "CSV file, such as measurements: columns for the parameters, `property` and `value`, optionally `low`, `high` "
        "and `source`; may be repeated")  # fmt: skip
    add("--theme", choices=(AUTOMATIC, *THEMES), default=AUTOMATIC, help="the colors of SVG files; "
        f"{AUTOMATIC}: light, or dark if the reader prefers dark colors (default)")  # fmt: skip
    add("--live", action="store_true", help="write only JSON Lines with the points and plots to standard output while "
        "the experiment runs, for editors")  # fmt: skip
    add("--unit", action="append", default=[], metavar="NAME=UNIT", help="the unit of a parameter, for plots; may be "
        "repeated")  # fmt: skip


def parsed(arguments: Sequence[str]) -> argparse.Namespace:
    """The arguments. If `main` is a file of arguments, those on the command line take precedence, and `main` is the
    model that the file names.

    Raises:
        UsageError: the file is not valid.
    """
    options = parser().parse_args(arguments)
    if not options.main.endswith(EXPERIMENT_SUFFIX):
        return options
    path = str(options.main)
    rest = list(arguments)
    rest.remove(path)
    options = parser().parse_args([*_arguments_in(path, options), *rest])
    options.file = InputPath(path)
    return options


def _arguments_in(path: str, given: argparse.Namespace) -> list[str]:
    """The arguments in a file, without those that the options on the command line replace."""
    try:
        content = required(path, MEGABYTE).decode("utf-8")
        values = loads(content)
    except UnicodeDecodeError as error:
        raise UsageError(f"{path}: {error}") from None
    except TomlError as error:
        at = LineIndex(content).position(error.span.start)
        raise UsageError(f"{path}:{at.line + 1}:{at.column + 1}: {error}") from None
    model = values.pop("model", None)
    if not isinstance(model, str):
        raise UsageError(f'{path}: the file names no model; add `model = "main.xml"`')
    folder = os.path.dirname(path)
    actions = {
        option.removeprefix("--"): action
        for action in parser()._actions
        for option in action.option_strings
        if option.startswith("--")
    }
    arguments = [os.path.join(folder, model)]
    for key, value in values.items():
        action = actions.get(key_name(key))
        if action is None or key == "help":
            raise UsageError(f"{path}: there is no option `{key}`{did_you_mean(close_names(key, actions))}")
        if key in _REPLACED and (getattr(given, key) or (key == "property" and given.find is not None)):
            continue
        option = f"--{key_name(key)}"
        named = {_entry_name(text) for text in getattr(given, action.dest)} if action.dest in _NAMED else set()
        for text in _texts(path, key, value):
            if isinstance(text, str) and _entry_name(text) in named:
                continue
            is_path = isinstance(action.type, type) and issubclass(action.type, (InputPath, OutputPath))
            is_path |= action.type is plot_file
            if text is True:
                arguments.append(option)
            elif text is not False:
                arguments.append(f"{option}={os.path.join(folder, str(text)) if is_path else text}")
    return arguments


def _entry_name(entry: str) -> str:
    """The name in an option of the form `NAME=VALUE`."""
    return entry.partition("=")[0].strip()


def _texts(path: str, key: str, value: Any) -> Iterator[str | bool]:
    """The values of an option."""
    match value:
        case dict() if key in _LISTS:
            for name, entry in value.items():
                entries = entry if isinstance(entry, list) else [entry]
                yield f"{name}={','.join(_text(path, key, item) for item in entries)}"
        case list() if key in _LISTS:
            yield from (_text(path, key, item) for item in value)
        case bool():
            yield value
        case _:
            yield _text(path, key, value)


def _text(path: str, key: str, value: Any) -> str:
    match value:
        case bool():
            return "true" if value else "false"
        case str():
            return value
        case int() | float():
            return repr(value)
    raise UsageError(f"{path}: `{key}` has a value of a wrong type")


def computed_options(options: argparse.Namespace) -> ExperimentOptions:
    """How the values are computed.

    Raises:
        UsageError: options exclude each other, or have impossible values.
    """
    sampling = ("confidence", "epsilon", "method", "max_traces", "max_steps")
    asks_for_traces = any(getattr(options, name) is not None for name in sampling)
    if options.exhaustive and asks_for_traces:
        raise UsageError("--exhaustive computes exact values, so options of traces have no effect; leave one out")
    return ExperimentOptions(
        limits_in(options),
        only_uniform=options.scheduler is not None,
        exact=not asks_for_traces,
        is_exhaustive=options.exhaustive,
        max_transitions=options.max_transitions,
        max_states=options.max_states,
        has_slopes=getattr(options, "slopes", False),
    )


def expectation_in(options: argparse.Namespace) -> Expectation | None:
    """The expectation of `--find`; `None` if no value is to be found.

    Raises:
        UsageError: the options do not fit each other, or the expectation is not valid.
    """
    if (options.find is None) is not (options.meets is None):
        raise UsageError("--find and --meets need each other: --find capacity --meets 'delivered >= 0.99'")
    if options.find is None:
        if options.assume_monotone:
            raise UsageError("--assume-monotone needs --find")
        return None
    if options.property or options.resume is not None:
        raise UsageError(
            "--find takes the property from --meets, and keeps no points; leave out --property and --resume"
        )
    (expectation,) = expectations_in([options.meets])
    return expectation


def mocks_in(options: argparse.Namespace) -> MockTexts:
    """The mocks that the options declare; without them, those in the file beside the model, if there is one.

    Raises:
        MockError: an entry is not written as `NAME=VALUE`.
        UsageError: mocks are declared for a JANI model, or their file is not valid UTF-8.
        OSError: the file with mocks cannot be read.
    """
    declared = declarations_in(options)
    if options.main.endswith(".jani"):
        if not declared.is_empty:
            raise UsageError("mocks, entries and a tick rate are for behavior trees; a JANI model has none")
        return MockTexts()
    beside = mocks_path(options.main)
    file = declared.file or (beside if not declared.has_mocks and os.path.isfile(beside) else None)
    try:
        text = "" if file is None else required(file).decode("utf-8")
    except UnicodeDecodeError:
        raise UsageError(f"{file}: not valid UTF-8; fix the encoding") from None
    return MockTexts(declared.texts, text, declared.entries, declared.rate)


def beside_in(options: argparse.Namespace, grid: Grid) -> tuple[BesideValue, ...]:
    """The values in the files of `--beside`. Without a column for it, the source is the name of the file.

    Raises:
        UsageError: a file is not valid.
        OSError: a file cannot be read.
    """
    values: list[BesideValue] = []
    for path in options.beside:
        source = os.path.splitext(os.path.basename(path))[0]
        try:
            text = required(path, MEGABYTE).decode("utf-8-sig")
            values += read_beside(text, source, grid.sweeps, grid.properties)
        except UnicodeDecodeError:
            raise UsageError(f"{path}: not valid UTF-8; fix the encoding") from None
        except BesideError as error:
            raise UsageError(f"{path}: {error}") from None
    return tuple(values)


def units_in(options: argparse.Namespace) -> dict[str, str]:
    """The units of parameters.

    Raises:
        UsageError: a text has not the form `NAME=UNIT`.
    """
    units = {}
    for text in options.unit:
        name, equals, unit = text.partition("=")
        if not equals or not name.strip() or not unit.strip():
            raise UsageError(f"write `--unit NAME=UNIT`, such as `--unit capacity=%`, instead of `{text}`")
        units[name.strip()] = unit.strip()
    return units
