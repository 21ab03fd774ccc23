# SPDX-License-Identifier: Apache-2.0
"""Puts the channels of a system between its machines."""

from __future__ import annotations

import functools
from collections.abc import Iterator

from roaml.diagnostics import Symbol
from roaml.expansion.channel_links import ListedMachine, declares, link
from roaml.expansion.channels import delay_uses, read_channels, tick_periods
from roaml.expansion.declarations import CHANNELS, channel_sections
from roaml.expansion.state import ExpansionState, relative
from roaml.expansion.text import CopiedText, ExpandedText, edited_again
from roaml.expansion.values import Scope
from roaml.model.syntax import Name
from roaml.model.system_file import SystemSection
from roaml.roles import SymbolKind
from roaml.scxml.names import sanitise
from roaml.text import Span, TextEdit
from roaml.xml_syntax import Document, parse


def expand_channels(state: ExpansionState, document: Document, scope: Scope) -> Iterator[TextEdit]:
    """Put the channels of the system between its machines. The edits list their machines in the system file."""
    sections = list(channel_sections(document))
    problems = state.problems_of(state.path)
    message = (
        f"AS2FM ignores `<{CHANNELS}>`, so all messages arrive at once in it; `as2fm-lsp translate --expand DIR` "
        "writes a machine for each channel"
    )
    state.not_in_reference(state.path, sections[0].name_span, message)
    for element in (child for section in sections for child in section.elements):
        state.note_system_uses(delay_uses(document, element, scope))
    texts = {path: text for path in state.machines if (text := state.expanded(path)) is not None}
    machines = [ListedMachine(path, parse(text.text)) for path, text in texts.items()]
    periods = tick_periods(document, (machine.document for machine in machines), scope)
    read = functools.partial(state.read_data, state.path)
    channels = read_channels(state.path, document, sections, scope, periods, problems, read)
    links = link(channels, machines, state.sources.interface, problems)
    written = [found for path in set(state.machines.values()) if (found := state.sources.document(path)) is not None]
    for channel in channels:
        if any(declares(machine, channel) for machine in written):
            _note_interface(state, channel.kind.value, channel.name)
    for path, edits in links.edits.items():
        state.texts[path] = edited_again(texts[path], edits)
    for own in links.delivered:
        sent = _interface(state.path, own.kind.value, own.sent)
        symbol = _interface(state.path, own.kind.value, f"{own.sent}/to_{own.receiver}")
        state.delivered[symbol] = sent, Symbol(state.machines[own.path], SymbolKind.MACHINE, own.receiver)
    inputs = []
    for channel, name, content in links.machines:
        path = state.fresh_beside(state.path, name, "ascxml")
        state.channels[path] = (name, channel.element.span)
        values = tuple(TextEdit(attribute.value_span, value) for attribute, value in channel.values)
        whole = CopiedText(0, len(content), channel.element.span, is_exact=False)
        state.texts[path] = ExpandedText(path, state.path, content, values, (whole,))
        inputs.append(f'<input type="node-ascxml" src="{relative(path, "")}" />')
    state.drawn.update((channel.drawn, None) for channel in channels if channel.drawn is not None)
    if inputs:
        yield _listed(document, inputs)


def _note_interface(state: ExpansionState, kind: str, name: Name) -> None:
    """Record the name of a topic or service in the system file."""
    slash = len(name.value) - len(name.value.removeprefix("/")) if kind == SymbolKind.TOPIC.value else 0
    span = Span(name.span.start + slash, name.span.end)
    symbol = _interface(state.path, kind, name.value)
    state.note_place(state.path, symbol, span, defines=False)


def _interface(system: str, kind: str, name: str) -> Symbol:
    """The symbol of a topic or service of a system."""
    if kind == SymbolKind.TOPIC.value:
        return Symbol(system, SymbolKind.TOPIC, sanitise(name))
    return Symbol(system, SymbolKind.SERVICE, name)


def _listed(document: Document, inputs: list[str]) -> TextEdit:
    """The edit that lists further machines in a system file."""
    root = document.root
    assert root is not None
    section = root.find(SystemSection.NODE_MODELS.value)
    lines = "".join(f"\n        {text}" for text in inputs)
    if section is None:
        end = root.open_span.end
        return TextEdit(Span(end, end), f"\n    <node_models>{lines}\n    </node_models>")
    if section.close_span is None:
        return TextEdit(section.span, f"<node_models>{lines}\n    </node_models>")
    end = section.elements[-1].span.end if section.elements else section.open_span.end
    return TextEdit(Span(end, end), lines)
