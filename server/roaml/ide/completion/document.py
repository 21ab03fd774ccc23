# SPDX-License-Identifier: Apache-2.0
"""The documentation of one completion item, created when it is selected."""

from __future__ import annotations

from collections.abc import Mapping

from roaml.diagnostics import Symbol
from roaml.distributions.laws import LAWS
from roaml.expr.operators import FUNCTIONS
from roaml.ide.describe import describe
from roaml.ide.describe import language as describe_language
from roaml.language import BEHAVIOR_TREE, HL_SCXML, STRUCTS, SYSTEM, XML_PROPERTIES, ElementType, Grammar
from roaml.project.analysis import Analysis
from roaml.roles import SymbolKind

_GRAMMARS: Mapping[str, Grammar] = {
    grammar.schema: grammar for grammar in (HL_SCXML, SYSTEM, STRUCTS, XML_PROPERTIES, BEHAVIOR_TREE)
}


def document(analysis: Analysis, about: Symbol) -> str:
    """The documentation of the subject of an item, as Markdown; "" if there is none.

    In addition to the symbols that `describe` supports, `about` may be a part of the languages. The kinds are `element`
    (`path` is the name of the parent, `scope` the schema), `attribute` (`path` is `PARENT/ELEMENT`),
    `enumeration-value` (`path` is `PARENT/ELEMENT/ATTRIBUTE`), `function`, `event-variable`, `base-type` and `json`
    (`scope` is the documentation).
    """
    grammar = _GRAMMARS.get(about.scope)
    match about.kind:
        case SymbolKind.ELEMENT if grammar is not None:
            type_ = _element(grammar, about.path, about.name)
            return describe_language.element(type_) if type_ else ""
        case SymbolKind.ATTRIBUTE if grammar is not None:
            type_ = _element(grammar, *about.path.split("/", 1))
            attribute = type_.attributes.get(about.name) if type_ else None
            return describe_language.attribute(attribute) if attribute else ""
        case SymbolKind.ENUMERATION_VALUE if grammar is not None:
            parent, element, name = about.path.split("/", 2)
            type_ = _element(grammar, parent, element)
            attribute = type_.attributes.get(name) if type_ else None
            choices = attribute.simple.choices if attribute else ()
            return next((describe_language.choice(choice) for choice in choices if choice.value == about.name), "")
        case SymbolKind.FUNCTION:
            if (distribution := LAWS.get(about.name)) is not None:
                return describe_language.law(distribution)
            math_function = FUNCTIONS.get(about.name)
            return describe_language.function(math_function) if math_function else ""
        case SymbolKind.EVENT_VARIABLE:
            return describe_language.EVENT_VARIABLES.get(about.name, "")
        case SymbolKind.BASE_TYPE:
            return describe_language.base_type(about.name)
        case SymbolKind.JSON:
            return about.scope
    return describe(analysis, about)


def _element(grammar: Grammar, parent: str, name: str) -> ElementType | None:
    """The type of the element as a child of `parent`; if it is not allowed there, its type in any other parent; `None`
    if the grammar has no element with this name."""
    outer = grammar.find(parent) if parent else None
    inner = grammar.child(outer, name) if outer else None
    return inner or grammar.find(name)
