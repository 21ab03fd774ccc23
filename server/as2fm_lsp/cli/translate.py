# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp translate MAIN.xml`: a system as plain SCXML and JANI."""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence

from as2fm_lsp.cli.arguments import ArgumentParser, WordAction
from as2fm_lsp.cli.exit_status import CLEAN, FOUND, USAGE
from as2fm_lsp.cli.formats import CheckReport, Format, render
from as2fm_lsp.cli.formats.report import entry, shown_path
from as2fm_lsp.cli.numbers import positive
from as2fm_lsp.cli.output import complain, print_text, takes_color, write_output
from as2fm_lsp.cli.parameters import ParameterFileError, add_set, with_parameter_files
from as2fm_lsp.cli.standard_input import STANDARD_INPUT_PATH, add_stdin_filename, named_input
from as2fm_lsp.cli.status_line import StatusLine
from as2fm_lsp.cli.times import add_reaction_time, time_of
from as2fm_lsp.cli.tree_semantics import add_semantics, semantics_of
from as2fm_lsp.outputs import (
    STANDARD_OUTPUT_PATH,
    InputPath,
    OutputFiles,
    OutputFolder,
    OutputPath,
    TranslationPath,
    outputs_of,
)
from as2fm_lsp.translation import jani_path, summary, without_bounded
from roaml import api
from roaml.diagnostics import Diagnostic
from roaml.disk import MAX_BYTES, read
from roaml.jani.model import Model
from roaml.jani.reaction import ReactionError, without_hold
from roaml.jani.writer import write as jani_text
from roaml.model.parameters import Overrides
from roaml.project.configuration import find_settings
from roaml.project.settings import ament_prefixes
from roaml.record import replace
from roaml.scxml.lowered_properties import FILE_NAME, NOBODY_TEXT, lowered_properties
from roaml.scxml.model import Network
from roaml.scxml.names import TRANSLATION_MARK
from roaml.scxml.writer import NOBODY
from roaml.scxml.writer import write as scxml_texts
from roaml.text import SourceFile
from roaml.views.machine import machine_graph
from roaml.views.network import network_graph
from roaml.views.notations import NOTATIONS, Notation
from roaml.views.tree import tree_graph

EXAMPLES = """\
examples:
  as2fm-lsp translate main.xml                       write main.jani beside main.xml
  as2fm-lsp translate main.xml -o - --indent 2 | less
  as2fm-lsp translate main.xml --property tree_success --max-time "20 s"
  as2fm-lsp translate main.xml --scxml-dir scxml --map main.map.json --dot diagrams

exit status: 0 translated; 1 the system has errors, or a property that was named cannot be translated, and nothing was
written; 2 usage error; 3 internal error
"""


def run(arguments: Sequence[str]) -> int:
    options = parser().parse_args(arguments)
    overrides = Overrides(
        options.max_time,
        options.max_array_size,
        options.reaction_time,
        semantics=semantics_of(options),
        values=tuple(options.set),
    )
    if options.main == STANDARD_INPUT_PATH:
        options.output = options.output or TranslationPath(STANDARD_OUTPUT_PATH)
    options.main, texts = named_input(options.main, options)
    options.output = options.output or TranslationPath(jani_path(options.main))
    output = options.output
    settings, problems = find_settings(os.path.abspath(options.main))
    if problems:
        return _fail(problems[0])
    try:
        settings = with_parameter_files(replace(settings, ament_prefixes=ament_prefixes()), options.params_file)
    except ParameterFileError as error:
        return _fail(str(error))
    if output == STANDARD_OUTPUT_PATH and options.map == STANDARD_OUTPUT_PATH:
        return _fail("the model and the map cannot both go to standard output")
    with StatusLine() as status:
        try:
            status.stage("reading")
            system = api.load(options.main, options.ros_path, settings, texts, overrides)
            outputs = outputs_of(options, system.files)
            status.stage("translating")
            network = api.to_scxml(system)
            # The summary, the map and the diagrams describe the written model.
            model, left_out = without_bounded(without_hold(api.to_jani(system, options.property or None)))
            is_refused = bool(left_out and options.property)
            if not is_refused:
                status.stage("writing")
                _write(options, outputs, system, network, model)
        except (api.ParameterError, api.PathError, api.PropertyError, ReactionError) as error:
            return _fail(str(error))
        except api.ModelError as error:
            failure: api.ModelError | None = error
        except BrokenPipeError:
            raise
        except OSError as error:
            return _fail(f"{shown_path(error.filename or output)}: {error.strerror or error}")
        else:
            failure = None
    if failure is not None:
        result = failure.result
        _report(options, _reported(result.diagnostics, result.source, result.files))
        return _not_written(options, output)
    report = _reported(left_out, lambda path: _source(system, path), system.files)
    if is_refused:  # The named property cannot be translated.
        _report(options, report)
        return _not_written(options, output)
    if options.format is Format.TEXT or STANDARD_OUTPUT_PATH not in (output, options.map):
        _report(options, report)
    if options.format is Format.TEXT and output != STANDARD_OUTPUT_PATH:
        messages = sys.stderr if options.map == STANDARD_OUTPUT_PATH else sys.stdout
        print_text(f"{shown_path(output)}: {summary(model)}\n", stream=messages)
    return CLEAN


def parser() -> ArgumentParser:
    result = ArgumentParser(
        prog="as2fm-lsp translate",
        description="Translate a system to JANI, and to plain SCXML on request.",
        epilog=EXAMPLES,
    )
    result.add_argument("main", type=InputPath, metavar="MAIN.xml", help="the system file; - is standard input")
    add_stdin_filename(result)
    result.add_argument(
        "-o", "--output", type=TranslationPath, metavar="FILE", help="the JANI file (MAIN.jani); - for standard output"
    )
    result.add_argument("--indent", type=_count, metavar="N", help="indent the JANI file by N spaces (one line)")
    result.add_argument(
        "--map", type=OutputPath, metavar="FILE", help="write the source position of each automaton, edge and variable"
    )
    result.add_argument(
        "--scxml-dir",
        type=OutputFolder,
        metavar="DIR",
        help="write a plain SCXML file for each automaton, and the properties in XML",
    )
    result.add_argument(
        "--expand",
        type=OutputFolder,
        metavar="DIR",
        help="write the files of the system without parameters and instances, which AS2FM reads",
    )
    for notation in NOTATIONS.values():
        help_ = f"write diagrams of the machines, the tree and the network ({notation.title})"
        result.add_argument(f"--{notation.name}", type=OutputFolder, metavar="DIR", help=help_)
    result.add_argument(
        "--property", action="append", default=[], metavar="NAME", help="translate only this property; may be repeated"
    )
    result.add_argument("--max-array-size", type=positive, metavar="N", help="overrides <max_array_size> of MAIN.xml")
    result.add_argument(
        "--max-time", type=time_of, metavar="TIME", help='overrides <max_time> of MAIN.xml, for example "100 s"'
    )
    add_reaction_time(result)
    result.add_argument("--ros-path", action="append", default=[], metavar="DIR", help="a folder with ROS interfaces")
    add_semantics(result)
    add_set(result)
    result.add_argument(
        "--format",
        action=WordAction,
        words=(Format.TEXT, Format.JSON),
        default=Format.TEXT,
        help="format of the diagnostics",
    )
    return result


def _count(text: str) -> int:
    value = int(text) if text.isdecimal() else -1
    if not 0 <= value <= 16:
        raise argparse.ArgumentTypeError("expected a number of spaces from 0 to 16")
    return value


def _write(
    options: argparse.Namespace, outputs: OutputFiles, system: api.LoadedSystem, network: Network, model: Model
) -> None:
    """Write the requested files; the JANI file is last, so that a failure leaves it unchanged."""
    if options.scxml_dir is not None:
        _write_folder(outputs, options.scxml_dir, _scxml_files(options, system, network))
    if options.expand is not None:
        _write_folder(outputs, options.expand, _plain_files(options.expand, system))
    for notation in NOTATIONS.values():
        folder = getattr(options, notation.name)
        if folder is not None:
            _write_folder(outputs, folder, _diagrams(system, model, notation))
    if options.map is not None:
        text = json.dumps(api.source_map(system, model), ensure_ascii=False, indent=1) + "\n"
        write_output(outputs, options.map, [text])
    write_output(outputs, options.output, (*jani_text(model, options.indent), "\n"), translates=True)


def _scxml_files(options: argparse.Namespace, system: api.LoadedSystem, network: Network) -> Iterator[tuple[str, str]]:
    """File name and text of each machine of the network, and of the properties in XML. The mark is at the end, because
    not every tool that reads SCXML accepts comments before the root element."""
    mark = f"<!-- {TRANSLATION_MARK} -->\n"
    for name, text in scxml_texts(network):
        yield f"{name}.scxml", text + mark
    chosen = [p for p in system.observed if not options.property or p.name in options.property]
    lowered = lowered_properties(network, chosen)
    if lowered.text:
        yield FILE_NAME, lowered.text + mark
    if lowered.names_nobody:
        yield f"{NOBODY}.scxml", NOBODY_TEXT + mark
    for property_, reason in lowered.left_out:
        complain(f"the property `{property_.name}` is not written to {FILE_NAME}: {reason}")


def _plain_files(folder: str, system: api.LoadedSystem) -> Iterator[tuple[str, str]]:
    """File name and text of each file of the system without parameters and instances. A file in JSON cannot contain the
    mark, so one that is there already is left out."""
    for name, text in api.to_plain(system).items():
        if text.lstrip("\ufeff \t\r\n").startswith("<"):
            end = "" if text.endswith("\n") else "\n"
            yield name, f"{text}{end}<!-- {TRANSLATION_MARK} -->\n"
        elif not _has_text(os.path.join(folder, name), text):
            yield name, text


def _has_text(path: str, text: str) -> bool:
    """Whether a file contains exactly `text`."""
    content = read(path, MAX_BYTES)
    return isinstance(content, bytes) and content == text.encode()


def _diagrams(system: api.LoadedSystem, model: Model, notation: Notation) -> Iterator[tuple[str, str]]:
    """File name and text of each diagram."""
    linked = system.analysis.system(system.path)
    assert linked is not None
    for path, outline in (*linked.nodes, *linked.plugins):
        machine = system.analysis.machine(path)
        if machine is None:  # that of a channel, which no file contains
            continue
        for number, graph in enumerate(machine_graph(machine)):
            suffix = f"-{number}" if number else ""
            yield f"machine-{outline.name}{suffix}.{notation.extension}", notation.render(graph)
    if linked.instances:
        yield f"tree.{notation.extension}", notation.render(tree_graph(linked))
    title = os.path.basename(system.path)
    yield f"network.{notation.extension}", notation.render(network_graph(model, title))


def _write_folder(outputs: OutputFiles, folder: str, files: Iterable[tuple[str, str]]) -> None:
    """Write files into a folder, if all of them may be written."""
    texts = {os.path.join(folder, name): text for name, text in files}
    outputs.check(texts, translates=True)
    os.makedirs(folder, exist_ok=True)
    for path, text in texts.items():
        os.makedirs(os.path.dirname(path), exist_ok=True)
        outputs.write(path, text, translates=True)


def _source(system: api.LoadedSystem, path: str) -> SourceFile:
    source = system.analysis.source(path)
    assert source is not None
    return source


def _reported(
    diagnostics: Sequence[Diagnostic], source_of: Callable[[str], SourceFile], files: Sequence[str]
) -> CheckReport:
    entries = [entry(diagnostic, source_of, shown_path) for diagnostic in diagnostics]
    return CheckReport(entries, len(files), color=takes_color(sys.stderr))


def _report(options: argparse.Namespace, report: CheckReport) -> None:
    """Write the diagnostics in the form of `--check`: as text on standard error, as JSON on standard output."""
    if options.format is Format.JSON:
        print_text(render(report, Format.JSON), "utf-8")
    elif report.entries:
        print_text(render(report, Format.TEXT), stream=sys.stderr)


def _not_written(options: argparse.Namespace, output: str) -> int:
    if options.format is Format.TEXT:
        complain(f"{shown_path(output)} was not written")
    return FOUND


def _fail(message: str) -> int:
    complain(message)
    return USAGE
