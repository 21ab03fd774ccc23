# SPDX-License-Identifier: Apache-2.0
"""Findings about a text, as plain values.

- A `Finding` is about one file and has no path: parsers and rules produce it, and it can be memoised.
- A place in *another* file is identified by a `Symbol`, so a memoised finding stays correct when the other file is
  edited; `roaml.project` resolves the symbol when a `Diagnostic` is published.
"""

from __future__ import annotations

import enum
from collections.abc import Callable

from roaml.facts import Facts
from roaml.record import PartlyCompared, Record
from roaml.roles import SymbolKind
from roaml.text import Edit, Location, SourceFile, Span, TextEdit, computed

RENAMED_CODES = {
    "entry-type-conflict": "blackboard-type-conflict",
    "entry-never-written": "blackboard-never-written",
    "missing-node-port": "missing-port",
    "node-port-value": "port-value",
    "tree-model-mismatch": "node-model",
    "unknown-node-port": "unknown-port",
    "unknown-plugin": "unknown-node",
}
"""Former code of a rule -> its code now. Comments, settings, options and baselines may contain former codes until the
release after the one that renames them."""


def current_code(code: str) -> str:
    """The code of a rule whose code, now or formerly, is `code`."""
    return RENAMED_CODES.get(code, code)


class Severity(enum.IntEnum):
    """The severity of a finding; a greater value is more severe."""

    HINT = 0
    INFORMATION = 1
    WARNING = 2
    ERROR = 3

    @property
    def label(self) -> str:
        return self.name.lower()


class Tag(enum.Enum):
    """How an editor shows the text of a finding (LSP `DiagnosticTag`)."""

    UNNECESSARY = "unnecessary"
    DEPRECATED = "deprecated"


class Symbol(Record, frozen=True):
    """A definition in a file, identified by its name instead of its position. `kind` is the kind of the
    symbol.

    `scope` distinguishes equal names, for example by the thread that contains a state. It is empty for most kinds.
    """

    path: str
    kind: SymbolKind
    name: str
    scope: str = ""


class Related(Record, frozen=True):
    """A further place that explains a finding: a span in the same file, or a symbol in any file. Only a finding that is
    computed again whenever a file changes may contain a location in this file."""

    place: Span | Symbol | Location
    message: str


class Fix(PartlyCompared, frozen=True):
    """A change of the finding's own file that removes the finding. New lines are written with `\\n`.

    A check creates many fixes, of which few are applied, so expensive edits are computed only when they are read.
    Fixes with equal titles are equal.

    Attributes:
        title: a phrase in the imperative.
        plan: the edits, or a function that computes all of them.
        preferred: whether the fix is the obvious one, as in LSP's `isPreferred`.
        safe: whether the fix removes nothing that has an effect and guesses nothing, so that it may be applied without
            a review.
    """

    UNCOMPARED = frozenset({"plan"})

    title: str
    plan: tuple[Edit, ...] | Callable[[], tuple[TextEdit, ...]]
    preferred: bool = True
    safe: bool = False

    @property
    def edits(self) -> tuple[TextEdit, ...]:
        return computed(self.plan) if isinstance(self.plan, tuple) else self.plan()


class Finding(Record, frozen=True):
    """A problem at a span. Without `severity`, the default severity of the rule applies.

    `facts` is the data for fixes that change other files. The message is for people only. `tolerated`: the parser of
    BehaviorTree.CPP accepts this violation of XML.
    """

    code: str
    span: Span
    message: str
    severity: Severity | None = None
    fixes: tuple[Fix, ...] = ()
    related: tuple[Related, ...] = ()
    tags: tuple[Tag, ...] = ()
    facts: Facts | None = None
    tolerated: bool = False


class RelatedPlace(PartlyCompared, frozen=True):
    """A `Related` whose place has been resolved to a location in a file. `source` is the text of this file."""

    UNCOMPARED = frozenset({"source"})

    location: Location
    message: str
    source: SourceFile | None = None


class Diagnostic(PartlyCompared, frozen=True):
    """A published finding: with its file, its final severity and all places resolved.

    `source` is the text that contains the span. `str(diagnostic)` is one line, `PATH:LINE:COLUMN: SEVERITY: MESSAGE
    [CODE]`; lines and columns start at 1, and columns count code points.
    """

    UNCOMPARED = frozenset({"source"})

    path: str
    code: str
    severity: Severity
    span: Span
    message: str
    fixes: tuple[Fix, ...] = ()
    related: tuple[RelatedPlace, ...] = ()
    tags: tuple[Tag, ...] = ()
    facts: Facts | None = None
    source: SourceFile | None = None

    def __str__(self) -> str:
        place = self.path
        if self.source is not None:
            position = self.source.lines.position(self.span.start)
            place = f"{self.path}:{position.line + 1}:{position.column + 1}"
        return f"{place}: {self.severity.label}: {self.message} [{self.code}]"
