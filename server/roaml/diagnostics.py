# SPDX-License-Identifier: Apache-2.0
"""Findings about a text, as plain values.

- A `Finding` is about one file and has no path: parsers and rules produce it, and it can be memoised.
- A place in *another* file is identified by a `Symbol`, never by a span, so a memoised finding stays correct when the
  other file is edited; `roaml.project` resolves the symbol when a `Diagnostic` is published.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass
from typing import NamedTuple

from roaml.facts import Facts
from roaml.roles import SymbolKind
from roaml.text import Location, Span, TextEdit


class Severity(enum.IntEnum):
    """How important a finding is; a greater value is more important."""

    HINT = 0
    INFORMATION = 1
    WARNING = 2
    ERROR = 3

    @property
    def label(self) -> str:
        return self.name.lower()


class Tag(enum.Enum):
    """How an editor may show the text of a finding (LSP `DiagnosticTag`)."""

    UNNECESSARY = "unnecessary"
    DEPRECATED = "deprecated"


class Symbol(NamedTuple):
    """A named thing in a file, independent of its position. `kind` is the kind of symbol that the schemas define for
    the value.

    `scope` distinguishes equal names (for example by the thread that contains a state); it is empty for most kinds.
    """

    path: str
    kind: SymbolKind
    name: str
    scope: str = ""


@dataclass(frozen=True, slots=True)
class Related:
    """A further place that explains a finding: a span in the same file, or a symbol in any file."""

    place: Span | Symbol
    message: str


@dataclass(frozen=True, slots=True)
class Fix:
    """A change of the finding's own file that fixes it. New lines are written with `\\n`.

    Attributes:
        title: in the imperative.
        preferred: whether it is the one obvious fix.
        safe: whether it removes nothing that has an effect and guesses nothing, so it may be applied without a review.
    """

    title: str
    edits: tuple[TextEdit, ...]
    preferred: bool = True
    safe: bool = False


@dataclass(frozen=True, slots=True)
class Finding:
    """Something to say about a span. Without `severity` the rule's own severity holds.

    `facts` are what fixes read that reach into other files. The message is for people only.
    """

    code: str
    span: Span
    message: str
    severity: Severity | None = None
    fixes: tuple[Fix, ...] = ()
    related: tuple[Related, ...] = ()
    tags: tuple[Tag, ...] = ()
    facts: Facts | None = None


@dataclass(frozen=True, slots=True)
class RelatedPlace:
    """A `Related` whose place has been resolved."""

    location: Location
    message: str


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """A finding as it is published: with its file, its final severity and all places resolved."""

    path: str
    code: str
    severity: Severity
    span: Span
    message: str
    fixes: tuple[Fix, ...] = ()
    related: tuple[RelatedPlace, ...] = ()
    tags: tuple[Tag, ...] = ()
    facts: Facts | None = None
