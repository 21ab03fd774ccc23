# SPDX-License-Identifier: Apache-2.0
"""Which fixes of a finding are offered: those that remove it, and add no error and no warning to the systems of the
changed files.

Each fix is made in a copy of the workspace, which is checked. The result is remembered as long as the files stay the
same, because editors request the fixes again whenever the caret moves.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Collection, Iterable, Iterator

from roaml.diagnostics import Diagnostic, Severity
from roaml.ide.code_actions.action import CodeAction, WorkspaceEdit
from roaml.model.kinds import FileKind
from roaml.model.system import System, SystemAutomaton
from roaml.project.workspace import Snapshot
from roaml.text import Span, apply_edits

_HIDING = frozenset(
    (
        *("xml-syntax", "duplicate-attribute", "undefined-entity", "stray-text", "foreign-namespace", "document-type"),
        *("json-syntax", "json-schema", "jani-syntax", "jani-name", "jani-type", "toml-syntax", "invalid-setting"),
        *("interface-syntax", "mock-syntax", "script-syntax", "script-name", "script-type", "expression-syntax"),
        *("unknown-element", "unknown-attribute", "unknown-type", "unknown-field", "unknown-member", "unknown-node"),
        *("unknown-port", "unknown-remap", "unknown-ros-type", "unknown-function", "unknown-event-parameter"),
        *("unknown-property-port", "unknown-property-variable", "undeclared-port", "undeclared-parameter"),
        *("missing-attribute", "missing-element", "missing-file", "missing-include", "missing-port", "missing-value"),
        *("misplaced-element", "invalid-child", "invalid-location", "invalid-name", "machine-name", "node-kind"),
        *("unsupported-event", "unsupported-expression", "unsupported-scxml-element", "deprecated-spelling"),
        *("event-data-unavailable", "length-of-struct", "parameter-declaration", "struct-declaration"),
        *("tree-format", "tree-name", "tree-structure", "wrong-file-kind", "input-count", "missing-type"),
    )
)
"""The rules about parts that cannot be read, or only in part. What other rules say about such a part is hidden until it
is fixed, so a fix may reveal findings."""


MAX_TRIED = 10
"""The maximum number of fixes of a finding that are tried and offered, because each takes a check."""

_CONSEQUENCES = frozenset(("unused-parameter",))
"""The rules about what nothing uses, maybe because of a mistake in another file: its removal would hide the mistake."""


def harmless(snapshot: Snapshot, code: str, actions: Iterable[CodeAction]) -> Iterator[CodeAction]:
    """The fixes of a finding of the rule `code` that add no error and no warning, in their order.

    If each fix of a rule about unreadable parts adds some, all of its fixes are offered, because they may only reveal
    them. What nothing uses is not removed while its system has errors or warnings of other rules.
    """
    actions = tuple(itertools.islice(actions, MAX_TRIED))
    if code in _CONSEQUENCES and any(_has_others(snapshot, action) for action in actions):
        return
    without = [action for action in actions if action.resources or not _adds_findings(snapshot, action)]
    yield from without or (actions if code in _HIDING else ())


def _has_others(snapshot: Snapshot, action: CodeAction) -> bool:
    """Whether the systems of the file of a fix have errors or warnings of other rules."""
    assert action.diagnostic is not None
    problems = _problems(snapshot, _members(snapshot, (action.diagnostic.path,)))
    return any(code not in _CONSEQUENCES for _, code in problems)


def _adds_findings(snapshot: Snapshot, action: CodeAction) -> bool:
    """Whether a file that a fix changes, or another one of its systems, has an additional error or warning after it, or
    still has the finding."""
    diagnostic = action.diagnostic
    assert diagnostic is not None
    members = _members(snapshot, (diagnostic.path,))
    content = tuple(map(snapshot.analysis.source, members))
    known: dict[tuple[str, Span, str, str], bool] = snapshot.analysis.memo.get(
        "fixes that add findings", diagnostic.path, (members, content), dict
    )
    fix = (diagnostic.code, diagnostic.span, diagnostic.message, action.title)
    if fix not in known:
        known[fix] = _harms(snapshot, diagnostic, action.make())
    return known[fix]


def _harms(snapshot: Snapshot, diagnostic: Diagnostic, change: WorkspaceEdit) -> bool:
    sources = {path: snapshot.analysis.source(path) for path in change.edits}
    texts = {path: apply_edits(s.text, tuple(sorted(change.edits[path]))) for path, s in sources.items() if s}
    after = snapshot.with_texts(texts)
    paths = dict.fromkeys((*_affected(snapshot, texts), *_affected(after, texts)))
    if any(_problems(after, (path,)) - _problems(snapshot, (path,)) for path in paths):
        return True
    own, place = (diagnostic.path,), (diagnostic.path, diagnostic.code)
    return diagnostic.severity >= Severity.WARNING and _problems(after, own)[place] >= _problems(snapshot, own)[place]


def _affected(snapshot: Snapshot, changed: Collection[str]) -> Iterator[str]:
    """The files whose findings depend on changed files: all members of their systems; but if all changed files are
    machines, only those machines that exchange data with them."""
    analysis, members = snapshot.analysis, _members(snapshot, changed)
    yield from changed
    near = set(changed)
    for main in dict.fromkeys(main for path in changed for main in analysis.memberships.get(path, ())):
        system = analysis.system(main)
        if system is None or not all(map(system.automata_of, changed)):
            yield from members
            return
        near |= {other.path for name in changed for own in system.automata_of(name) for other in _partners(system, own)}
    yield from (path for path in members if path in near or analysis.kind(path) is not FileKind.MACHINE)


def _partners(system: System, automaton: SystemAutomaton) -> Iterator[SystemAutomaton]:
    """The automata that exchange messages, requests, goals or events with an automaton."""
    for use in automaton.outline.interfaces:
        channel = system.channel(automaton, use)
        if channel is not None:
            yield from (endpoint.automaton for endpoint in (*channel.sources, *channel.users))
    for name in (*(e.event for e in automaton.outline.sent), *(e.event for e in automaton.outline.received)):
        event = system.events.get(name)
        if event is not None:
            yield from (other for other, _ in (*event.senders, *event.receivers))


def _members(snapshot: Snapshot, paths: Iterable[str]) -> tuple[str, ...]:
    """The files, and all files of their systems."""
    analysis = snapshot.analysis
    paths = tuple(paths)
    systems = dict.fromkeys(system for path in paths for system in analysis.memberships.get(path, ()))
    return tuple(dict.fromkeys((*paths, *(member for system in systems for member in analysis.files_of(system)))))


def _problems(snapshot: Snapshot, paths: Iterable[str]) -> Counter[tuple[str, str]]:
    found = ((path, d) for path in paths for d in snapshot.checker.diagnostics(path))
    return Counter((path, d.code) for path, d in found if d.severity >= Severity.WARNING)
