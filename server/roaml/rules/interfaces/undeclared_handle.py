# SPDX-License-Identifier: Apache-2.0
"""The rule `undeclared-handle`, which undeclared_handle.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.edit.elements import after, first_in
from roaml.language import HL_SCXML
from roaml.language.validate import misspelled_attribute
from roaml.model.build_machine import INTERFACE_ATTRIBUTES
from roaml.model.machine import Declaration, Handler, Machine, RosSend
from roaml.model.syntax import Name
from roaml.model.vocabulary import DECLARING_ELEMENTS
from roaml.roles import SymbolKind
from roaml.rules.rule import MachineContext, Rule, close_names, did_you_mean, replacements
from roaml.rules.support import misspelled
from roaml.rules.support.interfaces import other_kind
from roaml.suggest import alternatives
from roaml.text import Span, TextEdit
from roaml.xml_syntax import Element


def check(context: MachineContext) -> Iterator[Finding]:
    machine = context.machine
    undeclared: dict[tuple[str, tuple[SymbolKind, ...]], list[tuple[Element, Name]]] = {}
    used: set[str] = set()
    for element, handle, kinds in _uses(machine):
        right = [d.handle.value for d in machine.declarations if d.handle and d.kind in kinds]
        if handle is None:
            yield from _without_name(element, kinds, right)
            continue
        used.add(handle.value)
        if handle.value not in right and not _may_be_declared(machine, handle.value, kinds):
            undeclared.setdefault((handle.value, kinds), []).append((element, handle))
    for (name, kinds), uses in undeclared.items():
        right = [d.handle.value for d in machine.declarations if d.handle and d.kind in kinds]
        unused = [d for d in machine.declarations if d.handle and d.kind in kinds and d.handle.value not in used]
        wrong = _misspelled_declaration(context, name, unused, len(uses))
        if wrong is not None:
            yield _declared_otherwise(wrong, [handle for _, handle in uses])
        else:
            yield from (_undeclared(context, element, handle, kinds, right) for element, handle in uses)


def _misspelled_declaration(
    context: MachineContext, name: str, unused: list[Declaration], uses: int
) -> Declaration | None:
    """The declaration that is misspelled if an undeclared name is spelled correctly; `None` if the name is probably the
    misspelled one. A declaration that nothing refers to is misspelled if several elements use the name, or if the other
    machines know only the interface `name`."""
    similar = close_names(name, [d.handle.value for d in unused if d.handle], 1)
    for declaration in unused:
        if declaration.handle is not None and declaration.handle.value in similar:
            kind, declared = declaration.kind, declaration.handle.value
            is_known = _elsewhere(context, name, kind) is not None
            is_other_known = _elsewhere(context, declared, kind) is not None
            if is_known > is_other_known or (uses > 1 and is_known == is_other_known):
                return declaration
    return None


def _declared_otherwise(declaration: Declaration, uses: list[Name]) -> Finding:
    assert declaration.handle is not None
    handle, name = declaration.handle, uses[0].value
    elements = "an element uses" if len(uses) == 1 else f"{len(uses)} elements use"
    tag = DECLARING_ELEMENTS[declaration.kind]
    message = (
        f"nothing uses the `<{tag}>` `{handle.value}`, but {elements} `{name}`, which is not declared; did you mean "
        f"`{name}`?"
    )
    related = (Related(use.span, "used here") for use in uses)
    return RULE.at(handle.span, message, *replacements(handle.span, (name,)), related=related)


def _without_name(element: Element, kinds: tuple[SymbolKind, ...], right: list[str]) -> Iterator[Finding]:
    attribute = element.get("name")
    if misspelled_attribute(element, "name", HL_SCXML.elements[element.name].attributes) or (
        attribute is not None and not attribute.has_value
    ):
        return
    tags = " or ".join(f"`<{DECLARING_ELEMENTS[kind]}>`" for kind in kinds)
    message = f"`<{element.name}>` needs `name`, the name of a {tags}"
    span = attribute.span if attribute else Span(element.name_span.end, element.name_span.end)
    new = "" if attribute else " "
    fixes = [
        Fix(f'Write `name="{name}"`', (TextEdit(span, f'{new}name="{name}"'),), preferred=len(right) == 1)
        for name in right[:3]
    ]
    yield RULE.at(element.name_span, message, *fixes)


def _undeclared(
    context: MachineContext, element: Element, handle: Name, kinds: tuple[SymbolKind, ...], right: list[str]
) -> Finding:
    machine = context.machine
    wrong = next((d for d in machine.declarations if d.handle and d.handle.value == handle.value), None)
    if wrong is None or wrong.handle is None:
        close = close_names(handle.value, right)
        message = f"there is no `<{DECLARING_ELEMENTS[kinds[0]]}>` named `{handle.value}`"
        message += alternatives(close, right, "declared name") or "; declare it"
        declare = _declare(context, handle.value, kinds[0], preferred=not close)
        return RULE.at(handle.span, message, *replacements(handle.span, close), *declare)
    is_tag, needed_tag = DECLARING_ELEMENTS[wrong.kind], DECLARING_ELEMENTS[kinds[0]]
    message = f"`{handle.value}` is a `<{is_tag}>`; `<{element.name}>` needs a `<{needed_tag}>`"
    meant = tuple(right) if len(right) == 1 else _same_interface(machine, wrong, kinds)
    related = (Related(wrong.handle.span, "declared here"),)
    return RULE.at(handle.span, message + did_you_mean(meant), *replacements(handle.span, meant), related=related)


def _declare(context: MachineContext, name: str, kind: SymbolKind, *, preferred: bool) -> Iterator[Fix]:
    """A fix that declares a timer, or the topic, service or action that other machines of the system declare with this
    name."""
    document, root = context.document, context.machine.element
    if kind is SymbolKind.TIMER:
        text, preferred = f'<ros_time_rate rate_hz="1" name="{name}" />', False
    else:
        declared = _elsewhere(context, name, kind)
        if declared is None:
            return
        interface, type_ = declared
        attribute = next(a for a in INTERFACE_ATTRIBUTES if a in HL_SCXML.elements[DECLARING_ELEMENTS[kind]].attributes)
        text = f'<{DECLARING_ELEMENTS[kind]} name="{name}" {attribute}="{interface}" type="{type_}" />'
    siblings = [d.element for d in context.machine.declarations if d.element in root.elements]
    edit = after(document, siblings[-1], text) if siblings else first_in(document, root, text)
    yield Fix(f"Declare `{name}` as `<{DECLARING_ELEMENTS[kind]}>`", (edit,), preferred)


def _elsewhere(context: MachineContext, name: str, kind: SymbolKind) -> tuple[str, str] | None:
    """The name and type that another machine declares for a topic, service or action `name`."""
    for automaton in context.system.automata if context.system else ():
        for use in automaton.outline.interfaces:
            written = automaton.interface_name(use)
            alike = use.kind in (kind, other_kind(kind)) and automaton not in context.automata
            if written is not None and alike and name.strip("/") in (written.strip("/"), use.handle) and use.type:
                return written, use.type
    return None


def _same_interface(machine: Machine, wrong: Declaration, kinds: tuple[SymbolKind, ...]) -> tuple[str, ...]:
    """The handles of the right kind for the topic, service or action that a handle of the wrong kind refers to."""
    return tuple(
        d.handle.value
        for d in machine.declarations
        if d.handle and d.kind in kinds and isinstance(d.interface, Name) and isinstance(wrong.interface, Name)
        if d.interface.value.lstrip("/") == wrong.interface.value.lstrip("/")
    )


def _may_be_declared(machine: Machine, name: str, kinds: tuple[SymbolKind, ...]) -> bool:
    """Whether a declaration without a name, or a misspelled element, may be the missing declaration."""
    if any(d.kind in kinds and d.handle is None for d in machine.declarations):
        return True
    named = [e for e in machine.element.elements if any(a.value == name for a in e.attributes)]
    return any(misspelled.among(named, DECLARING_ELEMENTS[kind], HL_SCXML) for kind in kinds)


def _uses(machine: Machine) -> Iterator[tuple[Element, Name | None, tuple[SymbolKind, ...]]]:
    """Every element that refers to a declaration, with the name that it uses and the kinds of declarations that it
    accepts."""
    users: list[Handler | RosSend] = []
    for chart in machine.charts:
        users += [h for state in chart.states for h in state.handlers if h.effective]
        users += [s for s in chart.statements if isinstance(s, RosSend)]
    for user in users:
        attribute = user.type.attributes.get("name")
        if attribute is not None and attribute.refers:
            yield user.element, user.handle, attribute.refers
    for thread in machine.threads:
        yield thread.element, thread.server, HL_SCXML.elements["ros_action_thread"].attributes["name"].refers


RULE = Rule(
    "undeclared-handle",
    Severity.ERROR,
    "A ROS interface or timer is used but not declared.",
    machine=check,
    whole=True,
)
