# SPDX-License-Identifier: Apache-2.0
"""What an editor asks before an experiment (docs/experiments.md#editor): which parameters have which values, and which
property is computed. A system without parameters has numbers that can become one."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from roaml.comparison import as_written
from roaml.exact_number import exact_fraction
from roaml.expansion.declarations import Declared
from roaml.expansion.values import ParameterValue, number_text
from roaml.expr.types import INTEGER_RANGES, ScalarKind
from roaml.ide.code_actions.new_parameter import literals
from roaml.ide.describe.comment import remark
from roaml.ide.verifiable import expected_beside, verifiable
from roaml.model.kinds import FileKind
from roaml.project.analysis import Analysis
from roaml.record import Record
from roaml.text import Span
from roaml.xml_syntax import Attribute

STEPS = 10
"""About how many steps the proposed values have."""


class VariableParameter(Record, frozen=True):
    """A parameter of a system.

    Attributes:
        value: its current value, as text.
        proposed: values to try, in the form of `--set`.
        limits: the least and the greatest value that its declaration allows, in words; "" if there are none.
        span: the place of its name in the system file.
    """

    name: str
    value: str
    proposed: str
    limits: str
    span: Span


class AskedProperty(Record, frozen=True):
    """A property with its description, and what its file expects of it; "" if nothing."""

    name: str
    comment: str
    expected: str


class NumberPlace(Record, frozen=True):
    """A number in a file of a system that can become a parameter; `line` is the text of its line, `comment` the comment
    about its element, "" if there is none."""

    path: str
    span: Span
    text: str
    line: str
    comment: str


def parameters_of(analysis: Analysis, system: str) -> tuple[VariableParameter, ...]:
    """The parameters that a system declares and that have a value, in their order."""
    expanded = analysis.expanded(system)
    if expanded is None:
        return ()
    found = []
    for declared in expanded.expansion.declared:
        value = expanded.expansion.parameters.get(declared.name.value)
        if value is not None:
            least, most = (_number(end) for end in (declared.least, declared.most))
            words = [f"at least {_text(least)}"] if least is not None else []
            words += [f"at most {_text(most)}"] if most is not None else []
            proposed = _proposed(declared, value, least, most)
            found.append(
                VariableParameter(declared.name.value, value.text, proposed, " and ".join(words), declared.name.span)
            )
    return tuple(found)


def properties_of(analysis: Analysis, system: str) -> tuple[AskedProperty, ...]:
    expected = expected_beside(analysis, system)
    texts = {name: f"{comparison.relation} {as_written(comparison.number)}" for name, comparison in expected.items()}
    return tuple(AskedProperty(p.name, p.comment, texts.get(p.name, "")) for p in verifiable(analysis, system))


def numbers_of(analysis: Analysis, system: str) -> Iterator[NumberPlace]:
    """The numbers in the machines of a system that can become parameters: those in `<data>` first, and of these, those
    of ROS nodes, which describe the robot and its environment, before those of plugins."""
    machines = [path for path in analysis.files_of(system) if analysis.kind(path) is FileKind.MACHINE]
    linked = analysis.system(system)
    nodes = {path for path, _ in linked.nodes} if linked is not None else set()
    places = [(path, element, span) for path in machines for element, span in literals(analysis, path)]
    for path, element, span in sorted(places, key=lambda place: (place[1].name != "data", place[0] not in nodes)):
        source, document = analysis.source(path), analysis.document(path)
        if source is not None and document is not None:
            begin = source.text.rfind("\n", 0, span.start) + 1
            end = source.text.find("\n", span.end)
            line = source.text[begin : end if end >= 0 else len(source.text)]
            comment = " ".join(remark(document, element).split())
            yield NumberPlace(path, span, source.text[span.start : span.end], " ".join(line.split()), comment)


def _text(number: Fraction) -> str:
    return number_text(number, is_real=False)


def _number(attribute: Attribute | None) -> Fraction | None:
    return None if attribute is None else exact_fraction(attribute.value)


def _proposed(declared: Declared, value: ParameterValue, least: Fraction | None, most: Fraction | None) -> str:
    """Values of a parameter to try: from the least to the greatest one, if these are declared; otherwise, from 0 to 1
    for a number between them, and from a tenth of twice the value for others."""
    content = value.content
    match content:
        case bool():
            return "false,true"
        case str():
            return content
    is_integer = value.kind is ScalarKind.INT
    is_share = not is_integer and 0 <= content <= 1
    low = least if least is not None else Fraction(0) if is_share else None
    high = most if most is not None else Fraction(1) if is_share else max(2 * content, Fraction(STEPS))
    if is_integer and declared.type in INTEGER_RANGES:
        high = min(high, Fraction(INTEGER_RANGES[declared.type][1]))
    if content < 0 or (low is not None and low >= high):
        return value.text
    step = _round((high - (low or 0)) / STEPS, is_integer=is_integer)
    return ":".join(map(_text, (step if low is None else low, high, step)))


def _round(step: Fraction, *, is_integer: bool) -> Fraction:
    """The least number of the form 1, 2 or 5 times a power of 10 that is not less than a step."""
    power = Fraction(1) if is_integer else Fraction(1, 10**6)
    while True:
        for factor in (1, 2, 5):
            if factor * power >= step:
                return factor * power
        power *= 10
