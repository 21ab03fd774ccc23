# SPDX-License-Identifier: Apache-2.0
"""Edits of state machines: states and transitions are added and deleted, and the initial state is set."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from xml.sax.saxutils import quoteattr

from roaml.edit.elements import after, last_in, removals, set_attribute, without_attribute
from roaml.ide.diagrams.actions import Wording, guard, trigger_text
from roaml.ide.picture_edits.answers import ActionRefusal, EditAnswer, Option, UserQuestion
from roaml.ide.picture_edits.parts import HandlerPart, StatePart
from roaml.ide.rename.new_name import state_problem
from roaml.language import HL_SCXML, ElementType
from roaml.model.machine import Chart, Handler, Machine, State, Target
from roaml.model.syntax import Name
from roaml.project.analysis import Analysis
from roaml.roles import ProtocolPart, SymbolKind
from roaml.text import Edit
from roaml.xml_syntax import Document, Element, Text

_OF_PLUGINS = (ProtocolPart.BT_TICK, ProtocolPart.BT_HALT)
_OF_CHILDREN = (ProtocolPart.CHILD_STATUS, ProtocolPart.CHILD_HALTED)


def add_state(document: Document, chart: Chart, before: State | None, answers: Sequence[str]) -> EditAnswer:
    """Add a state after `before`, or after the last state."""
    if not answers:
        return UserQuestion("The name of the new state")
    name = answers[0].strip()
    reason = state_problem(name) or (f"a state `{name}` already exists" if name in _states(chart) else "")
    if reason:
        return ActionRefusal(reason)
    previous = before or (chart.states[-1] if chart.states else None)
    line = f'<state id="{name}" />'
    if previous is None:
        return (last_in(document, chart.element, line),)
    space = ("",) if _has_empty_lines(chart) else ()
    return (after(document, previous.element, *space, line),)


def add_transition(
    analysis: Analysis, path: str, document: Document, part: StatePart, answers: Sequence[str]
) -> EditAnswer:
    """Add a transition as the last child of a state. The answers are the target and the trigger."""
    if not answers:
        own = part.state.id.value if part.state.id else ""
        names = sorted(_states(part.chart), key=lambda name: name == own)
        return UserQuestion("The target of the transition", tuple(Option(name, name) for name in names))
    target, *others = answers
    if target not in _states(part.chart):
        return ActionRefusal(f"there is no state `{target}`")
    triggers = dict(_triggers(analysis, path, part.machine, part.chart))
    if not others:
        return UserQuestion("The trigger of the transition", tuple(Option(text, tag) for tag, text in triggers.items()))
    if others[0] not in triggers:
        return ActionRefusal("this trigger does not exist any more; try again on the new picture")
    name = others[0].partition(" ")[0]
    targets = " ".join(f"{attribute}={quoteattr(target)}" for attribute in _target_attributes(HL_SCXML.elements[name]))
    return (last_in(document, part.state.element, f"<{others[0]} {targets} />"),)


def set_initial(chart: Chart, state: State) -> EditAnswer:
    if state.id is None:
        return ActionRefusal("the state has no name; add the attribute `id`")
    return (set_attribute(chart.element, "initial", state.id.value),)


def delete_state(document: Document, part: StatePart) -> EditAnswer:
    """Remove a state with the transitions to it. If it is the initial state, the first other state becomes initial."""
    chart, state = part.chart, part.state
    others = [other for other in chart.states if other is not state]
    if not others:
        return ActionRefusal("this is the only state, and a state machine needs at least one")
    name = state.id.value if state.id else ""
    if any(other.id is not None and other.id.value == name for other in others):
        return tuple(removals(document, [state.element]))
    unwanted: list[Element] = [state.element]
    edits: list[Edit] = []
    for handler in (handler for other in others for handler in other.handlers):
        reached = [target for target in handler.targets if target.state is not None and target.state.value == name]
        if reached:
            elements, changes = _without_targets(document, handler, reached)
            unwanted += elements
            edits += changes
    if chart.initial is not None and chart.initial.value == name:
        first = next((other.id.value for other in others if other.id is not None), "")
        edits.append(set_attribute(chart.element, "initial", first))
    return (*edits, *removals(document, unwanted))


def delete_transition(document: Document, part: HandlerPart) -> EditAnswer:
    """Remove a transition, or one of its random targets."""
    targets = [part.target] if part.target is not None else list(part.handler.targets)
    elements, edits = _without_targets(document, part.handler, targets)
    return (*edits, *removals(document, elements))


def choose_transition(
    machine: Machine, state: State, answers: Sequence[str]
) -> UserQuestion | HandlerPart | ActionRefusal:
    """The transition of a state that the user chooses; a question if the state has several."""
    if not state.handlers:
        return ActionRefusal("the state has no transitions")
    if not answers and len(state.handlers) > 1:
        wording = Wording(machine)
        texts = (_text(wording, handler) for handler in state.handlers)
        return UserQuestion("The transition", tuple(Option(text, str(index)) for index, text in enumerate(texts)))
    index = int(answers[0]) if answers and answers[0].isdecimal() else 0
    if index >= len(state.handlers):
        return ActionRefusal("this transition does not exist any more; try again on the new picture")
    return HandlerPart(state.handlers[index])


def _without_targets(
    document: Document, handler: Handler, targets: Sequence[Target]
) -> tuple[list[Element], list[Edit]]:
    """The elements to remove, and the changes of other elements, so that a handler loses `targets`. If all remaining
    targets have a probability, the attribute of the last target is removed. This target receives the rest, so that the
    probabilities have the sum 1."""
    rest = [target for target in handler.targets if target not in targets]
    elements = [target.element for target in targets if target.element is not None]
    # Without a `<target>`, the targets are attributes that a transition needs.
    if not rest or len(elements) < len(targets):
        return [handler.element], []
    last = rest[-1].element
    probability = last.get("prob") if last is not None else None
    is_complete = any(target.probability is None for target in rest)
    edits = [] if is_complete or probability is None else [without_attribute(document.text, probability)]
    return elements, list(edits)


def _states(chart: Chart) -> tuple[str, ...]:
    return tuple(dict.fromkeys(state.id.value for state in chart.states if state.id))


def _text(wording: Wording, handler: Handler) -> str:
    targets = ", ".join(dict.fromkeys(target.state.value for target in handler.targets if target.state))
    ends = f"→ {targets}" if targets else ""
    return " ".join(filter(None, (wording.trigger(handler), guard(handler), ends)))


def _has_empty_lines(chart: Chart) -> bool:
    """Whether an empty line is between two states."""
    nodes = chart.element.nodes
    states = {id(state.element) for state in chart.states[1:]}
    spaces = (before for before, node in pairwise(nodes) if id(node) in states)
    return any(isinstance(space, Text) and space.value.count("\n") > 1 for space in spaces)


def _triggers(analysis: Analysis, path: str, machine: Machine, chart: Chart) -> Iterator[tuple[str, str]]:
    """The start tags of transitions without their targets, and their texts: those for all declared interfaces, for the
    parts of the tree protocol and the plain events that the machine already handles, for the plain events that its
    systems send, and for a transition without an event."""
    used = {handler.trigger for own in machine.charts for state in own.states for handler in state.handlers}
    for name in HL_SCXML.elements["state"].children:
        type_ = HL_SCXML.elements.get(name)
        part = type_.receives if type_ is not None else None
        if type_ is None or part is None or type_.ignored or not _target_attributes(type_):
            continue
        if (part is ProtocolPart.THREAD_START) > bool(chart.scope):
            continue
        handle = type_.attributes.get("name")
        if handle is not None:
            for declaration in machine.declarations:
                if declaration.kind in handle.refers and declaration.handle is not None:
                    value = declaration.handle.value
                    interface = declaration.interface
                    subject = interface.value if isinstance(interface, Name) else value
                    yield f"{name} name={quoteattr(value)}", f"{trigger_text(part, subject)}{_result(type_)}"
        elif part in _OF_PLUGINS and part in used:
            yield name, trigger_text(part, "")
        elif part in _OF_CHILDREN and part in used:
            yield f'{name} id="0"', trigger_text(part, "0")
    events = [
        handler.event.value for own in machine.charts for s in own.states for handler in s.handlers if handler.event
    ]
    for owner in analysis.systems_of(path):
        system = analysis.system(owner) if owner is not None else None
        events += [event for event, plain in system.events.items() if plain.senders] if system is not None else []
    for event in dict.fromkeys(events):
        yield f"transition event={quoteattr(event)}", event
    yield "transition", "no event"


def _result(type_: ElementType) -> str:
    """Which result of an action an element handles; "" if it handles something else."""
    return f" ({type_.name.split('_')[-2]})" if type_.receives is ProtocolPart.RESULT else ""


def _target_attributes(type_: ElementType) -> tuple[str, ...]:
    """The attributes that name the target of a transition, or all its targets if there are several."""
    return tuple(name for name, attribute in type_.attributes.items() if SymbolKind.STATE in attribute.refers)
