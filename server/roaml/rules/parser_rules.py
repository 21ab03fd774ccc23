# SPDX-License-Identifier: Apache-2.0
"""The rules whose findings come from parsers; each is a code, a severity and a sentence."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from roaml.diagnostics import Finding, Fix, Severity
from roaml.record import replace
from roaml.rules.rule import FileContext, Rule
from roaml.text import TextEdit


def parser_findings(code: str, context: FileContext) -> Iterator[Finding]:
    """The findings of the parsers in a file that have the code `code`."""
    return (finding for finding in context.findings if finding.code == code)


_ESCAPES = ("&amp;", "&lt;")


def xml_syntax(context: FileContext) -> Iterator[Finding]:
    """The violations of well-formedness. In a tree that only BehaviorTree.CPP reads, those that its parser accepts are
    warnings: one for all characters that must be escaped, and one for all others with the same message."""
    groups: dict[str, list[Finding]] = {}
    for finding in parser_findings("xml-syntax", context):
        if not (context.is_lone_tree and finding.tolerated):
            yield finding
        else:
            groups.setdefault(_UNESCAPED if _is_unescaped(finding) else finding.message, []).append(finding)
    for message, findings in groups.items():
        if message is _UNESCAPED:
            characters = "a character is" if len(findings) == 1 else f"{len(findings)} characters are"
            message = f"{characters} not escaped"  # noqa: PLW2901 - the same message with its number
            advice, title = "; write `&amp;` for `&` and `&lt;` for `<`", "Escape all characters of the file"
        else:
            advice = f" (also at {len(findings) - 1} other places)" if len(findings) > 1 else ""
            title = findings[0].fixes[0].title if findings[0].fixes else ""
        text = f"not well-formed XML: {message}; BehaviorTree.CPP accepts this, other programs do not{advice}"
        edits = tuple(edit for finding in findings for fix in finding.fixes[:1] for edit in fix.edits)
        fixes = (Fix(title, edits, safe=True),) if edits else ()
        yield XML_SYNTAX.at(findings[0].span, text, *fixes, severity=Severity.WARNING)


def undefined_entity(context: FileContext) -> Iterator[Finding]:
    """The entities that XML does not define; BehaviorTree.CPP keeps their text."""
    severity = Severity.WARNING if context.is_lone_tree else None
    return (replace(finding, severity=severity) for finding in parser_findings("undefined-entity", context))


_UNESCAPED = "unescaped"


def _is_unescaped(finding: Finding) -> bool:
    return any(fix.plan == (TextEdit(finding.span, text),) for fix in finding.fixes for text in _ESCAPES)


def _parser_rule(code: str, severity: Severity, summary: str) -> Rule:
    return Rule(code, severity, summary, file=partial(parser_findings, code))


DUPLICATE_ATTRIBUTE = _parser_rule("duplicate-attribute", Severity.ERROR, "An element has the same attribute twice.")
DUPLICATE_JSON_KEY = _parser_rule(
    "duplicate-json-key", Severity.WARNING, "An object has the same key twice; only the last value is used."
)
INTERFACE_SYNTAX = _parser_rule(
    "interface-syntax", Severity.ERROR, "A ROS interface definition violates the rules of ROS 2."
)
INVALID_SETTING = _parser_rule(
    "invalid-setting",
    Severity.ERROR,
    "A configuration file has an unknown setting or an invalid value.",
)
JANI_NAME = _parser_rule("jani-name", Severity.ERROR, "Two properties in a file have the same name.")
JANI_SYNTAX = _parser_rule("jani-syntax", Severity.ERROR, "A property violates the JANI specification.")
JSON_SCHEMA = _parser_rule("json-schema", Severity.ERROR, "A part of a JSON Schema has no corresponding type.")
JSON_SYNTAX = _parser_rule("json-syntax", Severity.ERROR, "The file is not well-formed JSON.")
MISSING_FOLDER = _parser_rule(
    "missing-folder", Severity.WARNING, "A configuration file names a folder that does not exist."
)
MISSING_MOCK = _parser_rule(
    "missing-mock", Severity.WARNING, "A leaf of a tree has no mock in the file beside the tree."
)
MOCK_SYNTAX = _parser_rule("mock-syntax", Severity.ERROR, "A line of a file of mocks is not a mock.")
NESTING_TOO_DEEP = _parser_rule("nesting-too-deep", Severity.ERROR, "Elements are nested too deeply to be analysed.")
REPEATED_CONSTANT = _parser_rule(
    "repeated-constant", Severity.WARNING, "Two constants of one enumeration have the same value."
)
REPEATED_MOCK = _parser_rule("repeated-mock", Severity.WARNING, "A file contains two mocks for the same nodes.")
TOML_SYNTAX = _parser_rule("toml-syntax", Severity.ERROR, "A configuration file is not valid TOML.")
UNDEFINED_ENTITY = Rule(
    "undefined-entity",
    Severity.ERROR,
    "An entity is not one of the five predefined entities.",
    file=undefined_entity,
)
UNKNOWN_EXPECTATION = _parser_rule(
    "unknown-expectation", Severity.WARNING, "A configuration file names a property that no system has."
)
UNMATCHED_MOCK = _parser_rule("unmatched-mock", Severity.WARNING, "A mock matches no node of the tree.")
XML_SYNTAX = Rule("xml-syntax", Severity.ERROR, "The file is not well-formed XML.", file=xml_syntax)

RULES = (
    DUPLICATE_ATTRIBUTE,
    DUPLICATE_JSON_KEY,
    INTERFACE_SYNTAX,
    INVALID_SETTING,
    JANI_NAME,
    JANI_SYNTAX,
    JSON_SCHEMA,
    JSON_SYNTAX,
    MISSING_FOLDER,
    MISSING_MOCK,
    MOCK_SYNTAX,
    NESTING_TOO_DEEP,
    REPEATED_CONSTANT,
    REPEATED_MOCK,
    TOML_SYNTAX,
    UNDEFINED_ENTITY,
    UNKNOWN_EXPECTATION,
    UNMATCHED_MOCK,
    XML_SYNTAX,
)
