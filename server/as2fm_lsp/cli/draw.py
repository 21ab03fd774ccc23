# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp draw FILE`: draws a state machine, all state machines of a system, its behavior tree or its ROS graph as
SVG or PDF."""

from __future__ import annotations

import argparse
import os
from collections.abc import Sequence

from as2fm_lsp.atomic_write import write_file
from as2fm_lsp.cli.arguments import ArgumentParser
from as2fm_lsp.cli.exit_status import CLEAN, USAGE
from as2fm_lsp.cli.mock_options import add_mocks, declared_mocks
from as2fm_lsp.cli.output import STANDARD_OUTPUT_PATH, complain, print_text
from roaml import api
from roaml.figures.layout import LayoutDirection
from roaml.figures.pdf import pdf_file
from roaml.figures.svg import svg_file
from roaml.figures.themes import THEMES
from roaml.ide.diagrams import PAGE, DiagramKind, draw, draw_for, picture_of, tree_picture
from roaml.mocks.mock import MockError
from roaml.model.kinds import FileKind
from roaml.project.analysis import Analysis
from roaml.project.configuration import find_settings
from roaml.project.settings import ament_prefixes
from roaml.record import replace
from roaml.suggest import close_names, did_you_mean, listing

PDF = ".pdf"

EXAMPLES = """\
examples:
  as2fm-lsp draw arm.ascxml                          write Arm.machine.svg
  as2fm-lsp draw main.xml                            the ROS graph of the system
  as2fm-lsp draw main.xml --machine Arm -o arm.svg
  as2fm-lsp draw main.xml --machines -o machines.pdf
  as2fm-lsp draw main.xml --tree --theme dark -o tree.svg
  as2fm-lsp draw tree.xml --mock "*: 0.9 in 1 s"     with the mocks of the leaves
  as2fm-lsp draw tree.xml --direction down -o - | rsvg-convert -o tree.png

exit status: 0 drawn, 2 usage error, 3 internal error
"""


def run(arguments: Sequence[str]) -> int:
    options = parser().parse_args(arguments)
    path = os.path.abspath(options.file)
    settings, problems = find_settings(path)
    if problems:
        return _fail(problems[0])
    settings = replace(settings, ament_prefixes=ament_prefixes())
    try:
        analysis = api.check([options.file], settings=settings).snapshot.analysis
    except api.PathError as error:
        return _fail(str(error))
    kind = _kind(options, analysis, path)
    drawn = path
    if options.machine is not None:
        machines = _machines(analysis, path)
        if options.machine not in machines:
            return _fail(_unknown_machine(options.machine, machines, options.file))
        drawn = machines[options.machine]
    try:
        mocks = declared_mocks(options).mocks()
    except (MockError, OSError) as error:
        return _fail(str(error))
    if mocks and kind is not DiagramKind.TREE:
        return _fail("mocks are for the leaves of behavior trees; add --tree to draw the tree of a system")
    picture = tree_picture(analysis, drawn, mocks) if mocks else picture_of(kind, analysis, drawn)
    if picture is None or not picture.nodes:
        return _fail(f"{options.file}: {_NOTHING[kind]}")
    drawing = (
        draw(kind, picture, LayoutDirection(options.direction)) if options.direction else draw_for(kind, picture, *PAGE)
    )
    text = svg_file(drawing, picture.title, options.theme)
    if options.output == STANDARD_OUTPUT_PATH:
        print_text(text)
        return CLEAN
    output = options.output or _default_output(options.file, picture.title, kind)
    try:
        write_file(output, pdf_file(text) if output.lower().endswith(PDF) else text)
    except OSError as error:
        return _fail(f"{output}: {error.strerror or error}")
    print_text(f"{output}: {drawing.size.width:.0f} x {drawing.size.height:.0f} pixels\n")
    return CLEAN


def _default_output(file: str, title: str, kind: DiagramKind) -> str:
    """The path that is used without `--output`: the file name that the editor proposes, in the folder of the input."""
    return os.path.join(os.path.dirname(file), f"{os.path.splitext(title)[0]}.{kind.value}.svg")


_NOTHING = {
    DiagramKind.MACHINE: "the file contains no state machine",
    DiagramKind.TREE: "the file contains no behavior tree; name a tree file, or the system file of a tree",
    DiagramKind.ROS: "the file is not a system; name the system file",
    DiagramKind.SYSTEM: "the file is not a system with state machines; name the system file",
}


def _kind(options: argparse.Namespace, analysis: Analysis, path: str) -> DiagramKind:
    """The kind of diagram that the options request. Without an option, it is the kind that fits the file."""
    if options.machine is not None:
        return DiagramKind.MACHINE
    if options.tree:
        return DiagramKind.TREE
    if options.graph:
        return DiagramKind.ROS
    if options.machines:
        return DiagramKind.SYSTEM
    if analysis.machine(path) is not None:
        return DiagramKind.MACHINE
    return DiagramKind.TREE if analysis.kind(path) is FileKind.TREE else DiagramKind.ROS


def _machines(analysis: Analysis, path: str) -> dict[str, str]:
    """The files of the machines of a system, or of a single machine, by the names of the machines."""
    return {
        machine.name.value: file
        for file in dict.fromkeys((path, *analysis.files_of(path)))
        if (machine := analysis.machine(file)) and machine.name
    }


def _unknown_machine(name: str, machines: dict[str, str], file: str) -> str:
    if not machines:
        return f"{file}: there are no state machines"
    meant = close_names(name, machines, 1)
    return f"{file}: there is no state machine `{name}`" + (
        did_you_mean(meant) if meant else f"; the machines are {listing(tuple(machines))}"
    )


def parser() -> ArgumentParser:
    result = ArgumentParser(
        prog="as2fm-lsp draw",
        description="Draw state machines, the behavior tree or the ROS graph as SVG or PDF, as the editor "
        "shows it. "
        "Models with errors are drawn as far as possible.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    result.add_argument("file", metavar="FILE", help="a system, a state machine or a behavior tree")
    what = result.add_mutually_exclusive_group()
    what.add_argument("--machine", metavar="NAME", help="draw this state machine of the system")
    what.add_argument("--tree", action="store_true", help="draw the behavior tree")
    what.add_argument("--graph", action="store_true", help="draw the ROS graph (default for a system)")
    what.add_argument("--machines", action="store_true", help="draw all state machines of the system")
    result.add_argument(
        "-o",
        "--output",
        metavar="FILE",
        help="the file: SVG, or PDF if its name ends with .pdf; - is standard output (default: an SVG file named after "
        "the diagram, in the folder of the input)",
    )
    result.add_argument("--theme", choices=tuple(THEMES), default="light", help="the colors (default: light)")
    result.add_argument(
        "--direction",
        choices=tuple(direction.value for direction in LayoutDirection),
        help="the direction of the edges (default: the one in which the drawing fits a page of 4:3 better)",
    )
    add_mocks(result)
    return result


def _fail(message: str) -> int:
    complain(message)
    return USAGE
