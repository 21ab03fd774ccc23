# SPDX-License-Identifier: Apache-2.0
"""Moves the expectations of a property file to the table `verify.expect` of the configuration, which the reference
translator does not read (rule `unportable-expectation`)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from roaml.comparison import read_comparison
from roaml.ide.code_actions.action import WorkspaceEdit, text_edits
from roaml.ide.json_tree import values
from roaml.jani.expressions import Integer, Real
from roaml.jani.operators import BinaryOperator
from roaml.jani.properties import BinaryFormula, Expectation, Filter, FilterFunction, Formula, Probability, Property
from roaml.json_syntax import JsonObject, JsonString, JsonValue
from roaml.model.kinds import FileKind
from roaml.project.analysis import Analysis
from roaml.project.expectation_setting import expectation_edit
from roaml.text import Span, TextEdit, apply_edits

_RELATIONS = {
    BinaryOperator.LESS: ("<", ">"),
    BinaryOperator.LESS_EQUAL: ("<=", ">="),
    BinaryOperator.GREATER: (">", "<"),
    BinaryOperator.GREATER_EQUAL: (">=", "<="),
    BinaryOperator.EQUAL: ("==", "=="),
}
"""Comparison operator -> the relation of the value to the number: first if the value is the left operand, then if it is
the right operand."""
_JUDGING = (FilterFunction.FORALL, FilterFunction.EXISTS)
"""The functions of filters over comparisons. If there is only one initial state, both functions have the same
result."""


class MovableExpectation(NamedTuple):
    """An expectation that can be moved to the configuration.

    Attributes:
        name: the name of the property.
        expected: the expectation, such as `>= 0.9`.
        edits: the edits that remove it from the property file.
    """

    name: str
    expected: str
    edits: tuple[TextEdit, ...]


def movable_expectations(analysis: Analysis, path: str) -> tuple[MovableExpectation, ...]:
    """The expectations in a property file that can be moved."""
    if analysis.kind(path) is FileKind.XML_PROPERTIES:
        return tuple(_in_xml(analysis, path))
    return tuple(_in_jani(analysis, path))


def moved(
    analysis: Analysis, path: str, expectations: tuple[MovableExpectation, ...], configuration: str
) -> WorkspaceEdit:
    """The edits that move expectations to the configuration; empty if the configuration cannot be changed.

    Args:
        path: the property file.
        configuration: the configuration file, which need not exist.
    """
    source = analysis.source(configuration)
    before = "" if source is None else source.text
    after = before
    for expectation in expectations:
        edit = expectation_edit(configuration, after, expectation.name, expectation.expected)
        if edit is None:
            return WorkspaceEdit()
        after = apply_edits(after, (edit,))
    removed = {path: tuple(edit for expectation in expectations for edit in expectation.edits)}
    if source is None:
        return WorkspaceEdit(removed, created={configuration: after})
    return WorkspaceEdit({**removed, configuration: text_edits(before, after)})


def _in_xml(analysis: Analysis, path: str) -> Iterator[MovableExpectation]:
    file, source = analysis.property_file(path), analysis.source(path)
    for written in file.properties if file is not None and source is not None else ():
        attribute = written.element.get("expect")
        if attribute is None or written.expect is None or written.id is None:
            continue
        if read_comparison(written.expect.value) is not None:
            assert source is not None
            start = len(source.text[: attribute.span.start].rstrip())
            edit = TextEdit(Span(start, attribute.span.end), "")
            yield MovableExpectation(written.id.value, written.expect.value.strip(), (edit,))


def _in_jani(analysis: Analysis, path: str) -> Iterator[MovableExpectation]:
    source, document = analysis.source(path), analysis.json(path)
    for property_ in analysis.properties(path)[0] if source is not None and document is not None else ():
        assert source is not None
        assert document is not None
        expectation = _compared(property_, source.text, document[0])
        if expectation is not None:
            yield expectation


def _compared(property_: Property, text: str, document: JsonValue) -> MovableExpectation | None:
    match property_.expression:
        case Filter(function, BinaryFormula(operator, left, right) as comparison) as filter_ if operator in _RELATIONS:
            pass
        case _:
            return None
    if comparison.origin is None:
        return None
    for value, number, relation in ((left, right, 0), (right, left, 1)):
        if not isinstance(value, (Probability, Expectation)) or not isinstance(number, (Integer, Real)):
            continue
        if value.origin is None or number.origin is None:
            continue
        edits = [TextEdit(comparison.origin.span, text[slice(*value.origin.span)])]
        if function in _JUDGING:
            edits.insert(0, TextEdit(_function_span(filter_, document), f'"{FilterFunction.VALUES.value}"'))
        expected = f"{_RELATIONS[operator][relation]} {text[slice(*number.origin.span)]}"
        edits.sort(key=lambda edit: edit.span)
        return MovableExpectation(property_.name, expected, tuple(edits))
    return None


def _function_span(filter_: Formula, document: JsonValue) -> Span:
    """The span of the value of the key `fun` of a filter."""
    objects = (value for value in values(document) if isinstance(value, JsonObject))
    written = next(value for value in objects if filter_.origin is not None and value.span == filter_.origin.span)
    function = written.get("fun")
    assert isinstance(function, JsonString)
    return function.span
