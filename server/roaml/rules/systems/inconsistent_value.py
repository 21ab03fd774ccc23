# SPDX-License-Identifier: Apache-2.0
"""The rule `inconsistent-value`, which inconsistent_value.md describes."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.model.property_file import WrittenProperty
from roaml.model.property_links import LinkedFile
from roaml.model.property_problems import ProblemKind
from roaml.model.series import Alike, KeyedText, OddNumber, odd_numbers
from roaml.model.syntax import Name
from roaml.model.tree import TreeNode, nodes
from roaml.record import Record
from roaml.rules.rule import Rule, SystemContext, TreeContext, listing, replacements
from roaml.rules.support.odd_values import odd_inputs, odd_ports
from roaml.rules.support.words import words_of
from roaml.text import Span, TextEdit


def _tree(context: TreeContext) -> Iterator[Finding]:
    reported: set[Span] = set()
    for finding in (*_numbers(context), *_names(context)):
        if finding.span not in reported:
            reported.add(finding.span)
            yield finding


def _numbers(context: TreeContext) -> Iterator[Finding]:
    for tree in context.file.trees:
        ordered = tuple(nodes(tree))
        branches: dict[TreeNode, Alike | None] = {}
        for node in reversed(ordered):  # children before their parents
            branches[node] = _branch(node, [branches[child] for child in node.children])
        for node in ordered:
            alike = (branch for child in node.children if (branch := branches[child]) is not None)
            yield from _findings(odd_numbers(alike))
        leaves = (Alike((node.type_name,), tuple(_texts(node))) for node in ordered if not node.children)
        yield from _findings(odd_numbers(leaves))


_MAX_SHAPE = 60
"""How many parts the shape of a branch has at most that is compared with others."""


def _branch(node: TreeNode, children: Sequence[Alike | None]) -> Alike | None:
    """A node and those below it; `None` if they are too many."""
    shape = [node.type_name]
    texts = [*_texts(node)]
    for child in children:
        if child is None or len(shape) + len(child.shape) > _MAX_SHAPE:
            return None
        shape += ("(", *child.shape, ")")
        texts += child.texts
    return Alike(tuple(shape), tuple(texts))


class _Named(Record, frozen=True):
    """A constant of a port, and the name of its node."""

    name: Name
    value: Name

    @property
    def form(self) -> tuple[str, str] | None:
        """The texts before and after the name of the node in the value; `None` if the value does not contain it."""
        before, found, after = self.value.value.partition(self.name.value)
        return (before, after) if found else None


def _names(context: TreeContext) -> Iterator[Finding]:
    """Report values that belong to the name of another node, or to another port, while the values of all other nodes of
    this type belong to the names of these nodes."""
    by_type: dict[str, dict[str, list[_Named]]] = defaultdict(lambda: defaultdict(list))
    for tree in context.file.trees:
        for node in nodes(tree):
            for setting in node.ports if node.name is not None and not node.children else ():
                if node.name is not None and node.name.value and setting.variable is None:
                    by_type[node.type_name][setting.key.value].append(_Named(node.name, setting.value))
    for ports in by_type.values():
        yield from _unlike_form(ports)
        for key, constants in ports.items():
            yield from _unlike_words(key, constants)


_MIN_NAMES = 3
"""How many nodes of a type must have values that belong to their names before another value is suspicious."""


def _unlike_form(ports: Mapping[str, Sequence[_Named]]) -> Iterator[Finding]:
    """Report the values that do not contain the name of the node, as those of all others do."""
    forms: dict[str, tuple[str, str]] = {}
    for key, constants in ports.items():
        for form, count in Counter(known.form for known in constants if known.form is not None).most_common(1):
            if count >= _MIN_NAMES:
                forms[key] = form
    names = {known.name.value for constants in ports.values() for known in constants}
    expected = {before + name + after for before, after in forms.values() for name in names}
    odd: dict[Span, list[_Misnamed]] = defaultdict(list)
    for key, form in forms.items():
        unlike = [known for known in ports[key] if known.form != form]
        if len(unlike) == 1 and unlike[0].value.value in expected:
            odd[unlike[0].name.span].append(_Misnamed(key, unlike[0], unlike[0].name.value.join(form)))
    yield from map(_misnamed, odd.values())


def _unlike_words(key: str, constants: Sequence[_Named]) -> Iterator[Finding]:
    """Report the value that the name of its node contradicts: the name contains words that only another value has, as
    the names of the nodes with that value do."""
    words = {known.value.value: frozenset(words_of(known.value.value)) for known in constants}
    if not 2 <= len(words) <= _MAX_VALUES:
        return
    common = frozenset.intersection(*words.values())
    own = {value: of_value - common for value, of_value in words.items()}
    right: Counter[str] = Counter()
    wrong: list[tuple[_Named, str]] = []
    for known in constants:
        in_name = frozenset(words_of(known.name.value))
        meant = [value for value in own if in_name & own[value]]
        if meant == [known.value.value]:
            right[known.value.value] += 1
        elif len(meant) == 1:
            wrong.append((known, meant[0]))
    if len(wrong) == 1 and sum(right.values()) >= _MIN_NAMES and right[wrong[0][1]] and right[wrong[0][0].value.value]:
        yield _misnamed([_Misnamed(key, *wrong[0])])


_MAX_VALUES = 50
"""How many different values of a port are compared with the names of nodes."""


class _Misnamed(NamedTuple):
    """A constant of a port that belongs to another node or port, and the text that it should have."""

    key: str
    known: _Named
    fixed: str


def _misnamed(values: Sequence[_Misnamed]) -> Finding:
    """The finding for the values of a node. Its fix changes all of them: two are often exchanged."""
    key, known, fixed = values[0]
    message = (
        f"`{key}` of `{known.name.value}` is `{known.value.value}`, unlike at all other nodes of this type, whose "
        f"values match their names; did you mean `{fixed}`?"
    )
    edits = tuple(TextEdit(value.known.value.span, value.fixed) for value in values)
    fix = Fix(f"Change to {listing([value.fixed for value in values])}", edits)
    return RULE.at(known.value.span, message, fix, related=[Related(known.name.span, "the name of the node")])


def _texts(node: TreeNode) -> Iterator[KeyedText]:
    """The texts with digits in the name and the ports of a node. Ports have an order, so that nodes that set them in
    another order are alike."""
    ports = sorted(node.ports, key=lambda port: port.key.value)
    for key, text in (("name", node.name), *((port.key.value, port.value) for port in ports)):
        if text is not None and any(map(str.isdigit, text.value)):
            yield KeyedText(key, text)


def _system(context: SystemContext) -> Iterator[Finding]:
    # inconsistent-parameter reports parameters of instances, repeated-namespace their namespaces.
    return _findings(odd_inputs(context.files))


def _properties(file: LinkedFile) -> Iterator[Finding]:
    # Rules that know more report these.
    known = {problem.span for problem in file.problems if problem.kind in _REPORTED}
    findings = (*_findings(odd_ports(file)), *_findings(odd_numbers(map(_property, file.file.properties))))
    return (finding for finding in findings if finding.span not in known)


_REPORTED = (ProblemKind.REPEATED_ID, ProblemKind.MISLEADING)


def _property(written: WrittenProperty) -> Alike:
    conditions = tuple(KeyedText("event", Name(condition.text, condition.span)) for condition in written.conditions)
    name = (KeyedText("id", written.id),) if written.id is not None else ()
    return Alike((written.pattern.value if written.pattern is not None else "",), (*name, *conditions))


def _findings(values: Iterable[OddNumber]) -> Iterator[Finding]:
    for odd in values:
        message = (
            f"`{odd.text.value}` does not match `{odd.other.value}` beside it, unlike in all similar elements; did you "
            f"mean `{odd.fixed}`?"
        )
        related = [Related(odd.other.span, f"has the number {odd.expected}")]
        span = odd.text.span
        is_plain = span.end - span.start == len(odd.text.value)  # without escapes
        yield RULE.at(span, message, *(replacements(span, (odd.fixed,)) if is_plain else ()), related=related)


RULE = Rule(
    "inconsistent-value",
    Severity.WARNING,
    "A value contradicts another one of the same element, unlike in all similar elements.",
    tree=_tree,
    system=_system,
    xml_properties=_properties,
)
