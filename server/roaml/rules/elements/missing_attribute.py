# SPDX-License-Identifier: Apache-2.0
"""The rule `missing-attribute`, which missing_attribute.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.language import HL_SCXML
from roaml.language.validate import MissingAttribute, misspelled_attribute
from roaml.model.build_machine import INTERFACE_ATTRIBUTES
from roaml.model.machine import Declaration
from roaml.model.syntax import PortRead
from roaml.model.vocabulary import DECLARING_ELEMENTS
from roaml.roles import SymbolKind
from roaml.rules.rule import FileContext, MachineContext, Rule
from roaml.rules.support import misspelled
from roaml.text import Span, TextEdit
from roaml.xml_syntax import Element

DEFAULTS = {"version": "1.0", "unit": "s"}


def check(context: FileContext) -> Iterator[Finding]:
    for violation in context.violations:
        if not isinstance(violation, MissingAttribute):
            continue
        element, attribute = violation.element, violation.attribute
        if attribute.name == "name" and set(attribute.refers) & DECLARING_ELEMENTS.keys():
            continue  # undeclared-handle reports this with more detail
        known = violation.type.attributes
        meant = any(misspelled.only_missing(element, violation.type, a.name) for a in element.attributes)
        if not meant and not misspelled_attribute(element, attribute.name, known):
            choices = [choice.value for choice in attribute.simple.choices if not choice.use]
            value = choices[0] if len(choices) == 1 else _likely(context, element, attribute.name)
            yield _missing(element, attribute.name, value)


def check_machine(context: MachineContext) -> Iterator[Finding]:
    """Check attributes that the schema cannot require, because a child element may replace them."""
    for declaration in context.machine.declarations:
        if declaration.kind is not SymbolKind.TIMER:  # invalid-rate reports these
            yield from _interface(declaration)


def _interface(declaration: Declaration) -> Iterator[Finding]:
    element = declaration.element
    known = HL_SCXML.elements[element.name].attributes
    name = next(name for name in INTERFACE_ATTRIBUTES if name in known)
    child = element.find(name)
    if isinstance(declaration.interface, PortRead) and declaration.handle is None and element.get("name") is None:
        yield RULE.at(
            element.name_span, f"`<{element.name}>` needs a `name`, because its `{name}` is the value of a port"
        )
    elif declaration.interface is None and element.get(name) is None:
        if child is not None:
            yield RULE.at(child.name_span, f"`<{name}>` is empty; write a name or a `<bt_get_input>` into it")
        elif not misspelled_attribute(element, name, known):
            yield _missing(element, name, "")


def _likely(context: FileContext, element: Element, name: str) -> str:
    """The most likely value of a missing attribute, or an empty string if no value is likely."""
    if name == "initial":
        state = element.find("state")
        identifier = state.get("id") if state else None
        return identifier.value if identifier else ""
    if name == "name" and context.document is not None and element is context.document.root:
        return context.source.path.replace("\\", "/").rpartition("/")[2].partition(".")[0]
    return DEFAULTS.get(name, "")


def _missing(element: Element, name: str, value: str) -> Finding:
    at = element.name_span.end
    fix = Fix(f'Add `{name}="{value}"`', (TextEdit(Span(at, at), f' {name}="{value}"'),), preferred=bool(value))
    return RULE.at(element.name_span, f"`<{element.name}>` needs the attribute `{name}`", fix)


RULE = Rule(
    "missing-attribute",
    Severity.ERROR,
    "A required attribute is missing.",
    file=check,
    machine=check_machine,
)
