# SPDX-License-Identifier: Apache-2.0
"""Formulas as text: `H ({ level < 30 } S[:5] { alarm })` (docs/spec/xml-properties.md#formulas).

- Parsing never raises: the first syntax error is returned as a problem with its place, and there is no formula then.
- A text in braces is an atom. It is not parsed here; equal texts are the same atom.
- Operators by decreasing precedence: `!`, `H` and `O`; `S`; `&&`; `||`; `->`. `S`, `&&` and `||` are left-associative,
  `->` is right-associative.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

from roaml.exhaustive import Vocabulary
from roaml.observers.properties import And, Atom, Constant, Formula, Not, Or, Since, Window, historically, implies, once
from roaml.record import Record
from roaml.regex import regex
from roaml.text import Span

MAX_DEPTH = 100
"""The maximum nesting depth of parentheses and operators."""
MAX_OPERATORS = 200
"""The maximum number of binary operators in a formula."""


class Notation(Record, frozen=True):
    """The result of parsing a formula.

    Attributes:
        formula: the formula; `None` if there are problems.
        atoms: the spans of the texts in braces, without the braces.
        problems: spans and messages.
    """

    formula: Formula | None
    atoms: tuple[Span, ...]
    problems: tuple[tuple[Span, str], ...]


def read(text: str) -> Notation:
    """The formula in `text`; spans are offsets in it."""
    parser = _Parser(text)
    try:
        formula: Formula | None = parser.whole()
    except _ProblemError as error:
        return Notation(None, tuple(parser.atoms), ((error.span, error.message),))
    return Notation(formula, tuple(parser.atoms), ())


class _ProblemError(Exception):
    def __init__(self, span: Span, message: str) -> None:
        super().__init__(message)
        self.span = span
        self.message = message


class _TokenKind(Vocabulary):
    AND = "and"
    OR = "or"
    NOT = "not"
    IMPLIES = "implies"
    SINCE = "since"
    HISTORICALLY = "historically"
    ONCE = "once"
    OPEN = "("
    CLOSE = ")"
    TRUE = "true"
    FALSE = "false"
    ATOM = "{…}"
    BOUNDS = "[…]"
    OTHER = "other"
    END = "end"


class _Token(Record, frozen=True):
    kind: _TokenKind
    text: str
    span: Span


_SPELLINGS = {
    "&&": _TokenKind.AND,
    "and": _TokenKind.AND,
    "||": _TokenKind.OR,
    "or": _TokenKind.OR,
    "!": _TokenKind.NOT,
    "not": _TokenKind.NOT,
    "->": _TokenKind.IMPLIES,
    "implies": _TokenKind.IMPLIES,
    "S": _TokenKind.SINCE,
    "since": _TokenKind.SINCE,
    "H": _TokenKind.HISTORICALLY,
    "historically": _TokenKind.HISTORICALLY,
    "O": _TokenKind.ONCE,
    "once": _TokenKind.ONCE,
    "(": _TokenKind.OPEN,
    ")": _TokenKind.CLOSE,
    "true": _TokenKind.TRUE,
    "false": _TokenKind.FALSE,
}
_BINARY = frozenset((_TokenKind.AND, _TokenKind.OR, _TokenKind.IMPLIES, _TokenKind.SINCE))
_BRACES = {"atom": _TokenKind.ATOM, "bounds": _TokenKind.BOUNDS}
_TOKEN = regex(
    r"(?P<space>\s+)"
    r"|(?P<atom>\{(?:[^{}'\"]|'[^']*'|\"[^\"]*\")*\})"
    r"|(?P<bounds>\[[^\[\]]*\])"
    r"|(?P<word>&&|\|\||->|[!()]|[A-Za-z_]+)"
    r"|(?P<other>.)",
    re.DOTALL,
)
_BOUNDS = regex(r"\[\s*(\d{0,18})\s*:\s*(\d{0,18})\s*\]", re.ASCII)


def _tokens(text: str) -> Iterator[_Token]:
    for match in _TOKEN.finditer(text):
        group, span = match.lastgroup or "other", Span(*match.span())
        if group == "word":
            yield _Token(_SPELLINGS.get(match[0], _TokenKind.OTHER), match[0], span)
        elif group != "space":
            yield _Token(_BRACES.get(group, _TokenKind.OTHER), match[0], span)
    yield _Token(_TokenKind.END, "", Span(len(text), len(text)))


class _Parser:
    def __init__(self, text: str) -> None:
        self.text = text
        self.tokens = list(_tokens(text))
        self.at = 0
        self.depth = 0
        self.operators = 0
        self.atoms = [Span(t.span.start + 1, t.span.end - 1) for t in self.tokens if t.kind is _TokenKind.ATOM]

    @property
    def next(self) -> _Token:
        return self.tokens[self.at]

    def take(self) -> _Token:
        token = self.next
        if token.kind is not _TokenKind.END:
            self.at += 1
        return token

    def accept(self, kind: _TokenKind) -> bool:
        if self.next.kind is not kind:
            return False
        self.take()
        self.operators += kind in _BINARY
        if self.operators > MAX_OPERATORS:
            raise _ProblemError(self.next.span, f"the formula has more than {MAX_OPERATORS} binary operators")
        return True

    def whole(self) -> Formula:
        formula = self.implication()
        if self.next.kind is not _TokenKind.END:
            raise _ProblemError(
                self.next.span, f"expected an operator or the end of the formula before `{self.next.text}`"
            )
        return formula

    def implication(self) -> Formula:
        left = self.disjunction()
        if self.accept(_TokenKind.IMPLIES):
            return self.deeper(lambda: implies(left, self.implication()))
        return left

    def disjunction(self) -> Formula:
        formula = self.conjunction()
        while self.accept(_TokenKind.OR):
            formula = Or(formula, self.conjunction())
        return formula

    def conjunction(self) -> Formula:
        formula = self.since()
        while self.accept(_TokenKind.AND):
            formula = And(formula, self.since())
        return formula

    def since(self) -> Formula:
        formula = self.unary()
        while self.accept(_TokenKind.SINCE):
            window = self.window()
            formula = Since(formula, self.unary(), window)
        return formula

    def unary(self) -> Formula:
        return self.deeper(self._unary)

    def _unary(self) -> Formula:
        token = self.take()
        match token.kind:
            case _TokenKind.NOT:
                return Not(self.unary())
            case _TokenKind.HISTORICALLY:
                window = self.window()
                return historically(self.unary(), window)
            case _TokenKind.ONCE:
                window = self.window()
                return once(self.unary(), window)
            case _TokenKind.TRUE | _TokenKind.FALSE:
                return Constant(token.kind is _TokenKind.TRUE)
            case _TokenKind.ATOM:
                content = token.text[1:-1].strip()
                if not content:
                    raise _ProblemError(
                        token.span, "there is no condition in these braces; write for example `{ level < 30 }`"
                    )
                return Atom(content)
            case _TokenKind.OPEN:
                formula = self.implication()
                if not self.accept(_TokenKind.CLOSE):
                    raise _ProblemError(self.next.span, "expected `)`")
                return formula
            case _TokenKind.BOUNDS:
                raise _ProblemError(token.span, "bounds are only allowed after `S`, `H` or `O`: `O[:5] { alarm }`")
            case _TokenKind.END:
                raise _ProblemError(token.span, "expected a condition in braces: `{ level < 30 }`")
        raise _ProblemError(token.span, f"expected a condition in braces instead of `{token.text}`: `{{ level < 30 }}`")

    def window(self) -> Window:
        if self.next.kind is not _TokenKind.BOUNDS:
            return Window()
        token = self.take()
        match = _BOUNDS.fullmatch(token.text)
        if match is None:
            raise _ProblemError(token.span, "bounds must be whole clock steps: `[1:5]`, `[:5]` or `[1:]`")
        lower, upper = int(match[1] or 0), int(match[2]) if match[2] else None
        if upper is not None and upper < lower:
            raise _ProblemError(token.span, f"the lower bound {lower} is greater than the upper bound {upper}")
        return Window(lower, upper)

    def deeper(self, parse: Callable[[], Formula]) -> Formula:
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise _ProblemError(self.next.span, f"the formula is nested more than {MAX_DEPTH} levels deep")
        formula = parse()
        self.depth -= 1
        return formula
