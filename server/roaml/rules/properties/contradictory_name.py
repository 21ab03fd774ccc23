# SPDX-License-Identifier: Apache-2.0
"""The rule `contradictory-name`, which contradictory_name.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.edit.elements import rename_tag
from roaml.expr.tree import Name as Variable
from roaml.expr.tree import walk as walk_expr
from roaml.jani.expressions import Binary, Integer, Name
from roaml.jani.operators import BinaryOperator
from roaml.jani.properties import Property, walk
from roaml.model.property_file import WrittenProperty
from roaml.model.property_links import LinkedFile
from roaml.model.syntax import Expression
from roaml.model.tree import TreeNode, nodes
from roaml.observers.properties import Pattern, ScopeKind
from roaml.regex import regex
from roaml.rules.rule import PropertiesContext, Rule, TreeContext, replacements
from roaml.rules.support.words import words_of
from roaml.text import TextEdit
from roaml.xml_syntax.escapes import escape

_SEQUENCE, _FALLBACK = "Sequence", "Fallback"


def _tree(context: TreeContext) -> Iterator[Finding]:
    """Report sequences that are named as fallbacks, and the other way round."""
    for tree in context.file.trees:
        children_of_fallbacks = {c for n in nodes(tree) if _kind(n) == _FALLBACK for c in n.children}
        for node in nodes(tree):
            kind = _kind(node)
            if not kind or node.name is None or not node.children:
                continue
            other = _FALLBACK if kind == _SEQUENCE else _SEQUENCE
            words = words_of(node.name.value)
            # The last word says what it is: a "fallback route" is a route. A sequence that a fallback ticks last can be
            # called its fallback.
            if words[-1:] != [other.lower()] or kind.lower() in words or node in children_of_fallbacks:
                continue
            type_ = node.element.name
            message = f"the name `{node.name.value}` is that of a `{other}`, but this is a `{node.type_name}`"
            is_known = node.compact and type_.replace(kind, other) in _TYPES
            fixes = (rename_tag(node.element, type_.replace(kind, other)),) if is_known else ()
            yield RULE.at(node.element.name_span, message, *fixes, related=[Related(node.name.span, "the name")])


_TYPES = frozenset(f"{prefix}{kind}" for prefix in ("", "Reactive", "Async") for kind in (_SEQUENCE, _FALLBACK))


def _kind(node: TreeNode) -> str:
    """`Sequence` or `Fallback` for the nodes of BehaviorTree.CPP that are one; otherwise ""."""
    name = node.type_name
    if name in _TYPES or name == "SequenceWithMemory":
        return _SEQUENCE if _SEQUENCE in name else _FALLBACK
    return ""


_OPPOSITES = {
    "never": ((Pattern.EXISTENCE,), Pattern.ABSENCE),
    "eventually": ((Pattern.ABSENCE, Pattern.UNIVERSALITY), Pattern.EXISTENCE),
}
"""A word in the name of a property -> the patterns that it contradicts, and the one that it names."""

_NEGATIONS = frozenset(
    ("always", "blocked", "fail", "fails", "forgets", "idle", "lost", "misses", "never", "no", "not", "stays", "stops")
)
"""Words with which a name says the opposite: a robot that "never fails to arrive" arrives eventually."""


def _xml(file: LinkedFile) -> Iterator[Finding]:
    """Report properties whose names contradict their patterns. Expectations may turn a pattern into its opposite."""
    for written in file.file.properties:
        if written.id is None or written.pattern is None:
            continue
        yield from _order(written, written.id.value)
        if written.expect is not None:
            continue
        words = words_of(written.id.value)
        is_global = all(s.type is None or s.type.value == ScopeKind.GLOBALLY.value for s in written.scopes)
        for word, (contradicted, named) in _OPPOSITES.items():
            if not is_global or word not in words or not _NEGATIONS.isdisjoint(w for w in words if w != word):
                continue
            if written.pattern.value in {pattern.value for pattern in contradicted}:
                message = (
                    f"the name of this property says `{word}`, but its pattern is `{written.pattern.value}`; did you "
                    f"mean `{named.value}`?"
                )
                fixes = replacements(written.pattern.span, (named.value,))
                yield RULE.at(written.pattern.span, message, *fixes, severity=Severity.WARNING)


_EFFECT_FIRST = (("only", "when"), ("only", "after"), ("only", "if"), ("only", "while"))
"""Words between the name of an effect and the name of what must precede it."""

_CAUSE_FIRST = (("leads", "to"), ("then",), ("causes",), ("triggers",), ("before",), ("precedes",))
"""Words between the name of a cause, or of what must precede, and the name of its effect."""


def _order(written: WrittenProperty, name: str) -> Iterator[Finding]:
    """Report the two events of a response or precedence that are in the other order in the name of the property, as in
    `docks_only_when_low`: one of them names a word on one side only, and the other one does not contradict it."""
    pattern = written.pattern.value if written.pattern is not None else ""
    if pattern not in (Pattern.RESPONSE.value, Pattern.PRECEDENCE.value) or len(written.conditions) != 2:
        return
    words = words_of(name)
    for joint, is_exchanged in [*((j, True) for j in _EFFECT_FIRST), *((j, False) for j in _CAUSE_FIRST)]:
        at = next((i for i in range(1, len(words)) if tuple(words[i : i + len(joint)]) == joint), None)
        if at is None or (joint == ("before",) and pattern != Pattern.PRECEDENCE.value):
            continue
        sides = (set(words[:at]), set(words[at + len(joint) :]))
        first, second = (_words_in(condition) for condition in written.conditions)
        earlier, later = reversed(sides) if is_exchanged else sides
        fitting = len(first & earlier) + len(second & later)
        crossed = len(first & later) + len(second & earlier)
        if crossed and not fitting:
            message = (
                f"the name `{name}` states the events in the other order: the first event is the one that comes "
                "first; exchange the events"
            )
            a, b = written.conditions
            fix = Fix("Exchange the events", (TextEdit(a.span, escape(b.text)), TextEdit(b.span, escape(a.text))))
            yield RULE.at(a.span, message, fix, severity=Severity.WARNING, related=[Related(b.span, "the other event")])
        return


def _words_in(condition: Expression) -> set[str]:
    """The words of the variables in a condition."""
    return {word for node in walk_expr(condition.tree) if isinstance(node, Variable) for word in words_of(node.name)}


_STATUS = regex(r"bt_\d+_response__status\Z")
_STATUSES = {
    1: ("SUCCESS", frozenset(("success", "succeeds", "succeeded"))),
    2: ("FAILURE", frozenset(("failure", "fails", "failed"))),
    3: ("RUNNING", frozenset(("running", "runs"))),
}


def _jani(context: PropertiesContext) -> Iterator[Finding]:
    """Report properties whose names end with a status, and which compare that of a tree with another one."""
    for property_ in context.properties:
        words = words_of(property_.name)
        named = [number for number, (_, names) in _STATUSES.items() if names.intersection(words[-1:])]
        compared = [*_compared(property_)] if _NEGATIONS.isdisjoint(words[:-1]) else []
        if len(named) != 1 or len({number.value for _, number in compared}) != 1:
            continue
        (_, number), *_ = compared
        if number.origin is not None and number.value in _STATUSES and number.value != named[0]:
            message = (
                f"the name `{property_.name}` says {_STATUSES[named[0]][0]}, which is {named[0]}, but {number.value} "
                f"is {_STATUSES[number.value][0]}"
            )
            fixes = replacements(number.origin.span, (f"{named[0]}",))
            yield RULE.at(number.origin.span, message, *fixes, severity=Severity.WARNING)


def _compared(property_: Property) -> Iterator[tuple[Name, Integer]]:
    """The numbers with which a property compares the status of a tree."""
    for part in walk(property_.expression):
        if isinstance(part, Binary) and part.operator is BinaryOperator.EQUAL:
            for name, number in ((part.left, part.right), (part.right, part.left)):
                if isinstance(name, Name) and isinstance(number, Integer) and _STATUS.match(name.identifier):
                    yield name, number


RULE = Rule(
    "contradictory-name",
    Severity.INFORMATION,
    "The name of a node or property contradicts what it is.",
    tree=_tree,
    properties=_jani,
    xml_properties=_xml,
)
