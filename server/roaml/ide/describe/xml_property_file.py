# SPDX-License-Identifier: Apache-2.0
"""Descriptions, as Markdown, for property files in XML: properties as sentences, and the variables of ports."""

from __future__ import annotations

from roaml.diagnostics import Symbol
from roaml.ide.describe.markdown import code, name, paragraphs
from roaml.ide.names.lookup import symbol_group
from roaml.model.property_file import Port, PortVariable, PortVariableKind, PropertyFile, WrittenProperty
from roaml.model.property_sentences import event_clause, formula, quoted, sentence
from roaml.project.analysis import Analysis


def property_(analysis: Analysis, symbol: Symbol) -> str:
    """The description of a property: its sentence, with the formula below; "" if there is no definition."""
    for place in symbol_group(analysis, (symbol,)).definitions:
        file = analysis.property_file(place.path)
        for written in file.properties if file is not None else ():
            if file is not None and written.id is not None and written.id.span == place.span:
                return described(file, written)
    return ""


def described(file: PropertyFile, written: WrittenProperty) -> str:
    text = formula(written)
    return paragraphs(sentence(file, written), code(text) if text else "")


def variable(analysis: Analysis, symbol: Symbol) -> str:
    """The description of a variable of a port: its type, and its value at each step."""
    file = analysis.property_file(symbol.path)
    for port, declared in file.variables if file is not None else ():
        if declared.id is not None and declared.id.value == symbol.name:
            return paragraphs(code(f"{symbol.name} : {_type(declared)}"), _value(port, declared))
    return paragraphs(code(symbol.name), "No port has a variable with this name")


def _type(declared: PortVariable) -> str:
    if declared.kind in (PortVariableKind.GOAL_ID, PortVariableKind.RESULT_CODE):
        return "int32"
    return (
        "bool"
        if declared.kind in (PortVariableKind.EVENT, PortVariableKind.ACCEPTED)
        else declared.type.text
        if declared.type
        else "?"
    )


def _value(port: Port, declared: PortVariable) -> str:
    happens = str(event_clause(port))
    if declared.kind is PortVariableKind.EVENT:
        return f"True in the step in which {happens}, false in all others"
    subject = {
        PortVariableKind.GOAL_ID: "The number of the goal",
        PortVariableKind.RESULT_CODE: "The code of the result",
        PortVariableKind.ACCEPTED: "Whether the goal was accepted",
    }.get(declared.kind, f"The value of {quoted(declared.field.value if declared.field else '')}")
    before = f"; {name(declared.initial.text)} before" if declared.initial is not None else ""
    return f"{subject} at the last time that {happens}{before}"
