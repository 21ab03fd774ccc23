# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp draw FILE`: draws a state machine, all state machines of a system, its behavior tree or its ROS graph as
SVG or PDF."""

from __future__ import annotations

import argparse
import os
from collections.abc import Sequence

from as2fm_lsp.cli.arguments import ArgumentParser
from as2fm_lsp.cli.exit_status import CLEAN, USAGE
from as2fm_lsp.cli.mock_options import add_mocks, declared_mocks
from as2fm_lsp.cli.output import complain, is_quiet, print_text
from as2fm_lsp.cli.standard_input import STANDARD_INPUT_PATH, add_stdin_filename, named_input
from as2fm_lsp.outputs import STANDARD_OUTPUT_PATH, InputPath, OutputPath, outputs_of
from roaml import api
from roaml.figures.layout import LayoutDirection
from roaml.figures.themes import THEMES
from roaml.ide.diagrams import DiagramKind
from roaml.mocks.mock import MockError
from roaml.project.configuration import find_settings
from roaml.project.settings import ament_prefixes
from roaml.record import replace

PDF = ".pdf"

EXAMPLES = """\
examples:
  as2fm-lsp draw arm.ascxml                          write Arm.machine.svg
  as2fm-lsp draw main.xml                            the ROS graph of the system
  as2fm-lsp draw main.xml --around Arm               the ROS graph around a node
  as2fm-lsp draw main.xml --matching std_msgs/Bool   topics of this type, and their nodes
  as2fm-lsp draw main.xml --machine Arm -o arm.svg
  as2fm-lsp draw main.xml --machines -o machines.pdf
  as2fm-lsp draw main.xml --tree --theme dark -o tree.svg
  as2fm-lsp draw tree.xml --outline                  a row for each node, for narrow pages
  as2fm-lsp draw tree.xml --mock "*: 0.9 in 1 s"     with the mocks of the leaves
  as2fm-lsp draw tree.xml --direction down -o - | rsvg-convert -o tree.png
  as2fm-lsp draw - < tree.xml > tree.svg

exit status: 0 drawn, 2 usage error, 3 internal error
"""


def run(arguments: Sequence[str]) -> int:
    options = parser().parse_args(arguments)
    if options.file == STANDARD_INPUT_PATH:
        options.output = options.output or OutputPath(STANDARD_OUTPUT_PATH)
    options.file, texts = named_input(options.file, options)
    settings, problems = find_settings(os.path.abspath(options.file))
    if problems:
        return _fail(problems[0])
    try:
        mocks = declared_mocks(options).mocks()
        picture = api.draw(
            options.file,
            _kind(options),
            machine=options.machine,
            around=options.around,
            matching=options.matching,
            mocks=mocks,
            theme=options.theme,
            direction=options.direction,
            outline=options.outline,
            interfaces=options.interfaces,
            settings=replace(settings, ament_prefixes=ament_prefixes()),
            texts=texts,
        )
    except (api.DrawingError, api.PathError, MockError, OSError) as error:
        return _fail(str(error))
    if options.output == STANDARD_OUTPUT_PATH:
        print_text(picture.svg)
        return CLEAN
    output = options.output or _default_output(options.file, picture)
    try:
        outputs_of(options, picture.files).write(output, picture.pdf() if output.lower().endswith(PDF) else picture.svg)
    except OSError as error:
        return _fail(f"{output}: {error.strerror or error}")
    if not is_quiet():
        print_text(f"{output}: {picture.width:.0f} x {picture.height:.0f} pixels\n")
    return CLEAN


def _default_output(file: str, picture: api.DrawnPicture) -> str:
    """The path that is used without `--output`: the file name that the editor proposes, in the folder of the input."""
    return os.path.join(os.path.dirname(file), f"{os.path.splitext(picture.title)[0]}.{picture.kind.value}.svg")


def _kind(options: argparse.Namespace) -> DiagramKind | None:
    """The kind of diagram that the options request; `None` for the one that fits the file."""
    if options.tree:
        return DiagramKind.TREE
    if options.graph or options.around is not None or options.matching is not None:
        return DiagramKind.ROS
    return DiagramKind.SYSTEM if options.machines else None


def parser() -> ArgumentParser:
    result = ArgumentParser(
        prog="as2fm-lsp draw",
        description="Draw state machines, the behavior tree or the ROS graph as SVG or PDF, as the editor "
        "shows it. "
        "Models with errors are drawn as far as possible.",
        epilog=EXAMPLES,
    )
    result.add_argument(
        "file",
        type=InputPath,
        metavar="FILE",
        help="a system, a state machine or a behavior tree; - is standard input",
    )
    add_stdin_filename(result)
    what = result.add_mutually_exclusive_group()
    what.add_argument("--machine", metavar="NAME", help="draw this state machine of the system")
    what.add_argument("--tree", action="store_true", help="draw the behavior tree")
    what.add_argument("--graph", action="store_true", help="draw the ROS graph (default for a system)")
    what.add_argument("--machines", action="store_true", help="draw all state machines of the system")
    result.add_argument(
        "--around",
        metavar="NAME",
        help="draw only this node, topic, service or action of the ROS graph, what is connected to it, and the nodes "
        "with which it communicates",
    )
    result.add_argument(
        "--matching",
        metavar="TEXT",
        help="draw only the part of the ROS graph that contains all words of TEXT in its kind, name or type, and what "
        "is connected to it",
    )
    result.add_argument(
        "--interfaces",
        action="store_true",
        help="draw each topic, service and action of a ROS graph with more than 60 nodes on its own (default: most are "
        "drawn in the node that publishes or serves them)",
    )
    result.add_argument(
        "-o",
        "--output",
        type=OutputPath,
        metavar="FILE",
        help="the file: SVG, or PDF if its name ends with .pdf; - is standard output (default: an SVG file named after "
        "the diagram, in the folder of the input)",
    )
    result.add_argument("--theme", choices=tuple(THEMES), default="light", help="the colors (default: light)")
    form = result.add_mutually_exclusive_group()
    form.add_argument(
        "--outline",
        action="store_true",
        help="draw the behavior tree in a narrow column: a row for each node, with its children indented below it",
    )
    form.add_argument(
        "--direction",
        choices=tuple(direction.value for direction in LayoutDirection),
        help="the direction of the edges (default: the one in which the drawing fits a page of 4:3 better)",
    )
    add_mocks(result)
    return result


def _fail(message: str) -> int:
    complain(message)
    return USAGE
