# SPDX-License-Identifier: Apache-2.0
"""The rule schema-violation, for which no file is known: the tables of the grammars explain every violation of the
schemas."""

from __future__ import annotations

from roaml.language import HL_SCXML, SYSTEM
from roaml.language.validate import SchemaViolation
from roaml.rules.elements import schema_violation
from roaml.rules.rule import FileContext
from roaml.text import SourceFile
from roaml.xml_syntax import parse


def test_schema_violations() -> None:
    document = parse("<roaml><parameters/></roaml>")
    assert document.root is not None
    violation = SchemaViolation(document.root.elements[0], "something else")
    context = FileContext(SourceFile("main.xml", document.text), (), document, SYSTEM, (violation,))
    [finding] = schema_violation.check(context)
    assert (finding.code, finding.span) == ("schema-violation", (8, 18))
    assert "something else" in finding.message


def test_schema_violations_that_other_rules_explain() -> None:
    document = parse('<ascxml><state><transition><target id="a"/><send/></transition></state></ascxml>')
    assert document.root is not None
    transition = document.root.elements[0].elements[0]
    violation = SchemaViolation(transition, "Unexpected child with tag 'send' at position 2.")
    context = FileContext(SourceFile("a.ascxml", document.text), (), document, HL_SCXML, (violation,))
    assert not list(schema_violation.check(context))
