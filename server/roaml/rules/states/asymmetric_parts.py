# SPDX-License-Identifier: Apache-2.0
"""The rule `asymmetric-parts`, which asymmetric_parts.md describes."""

from __future__ import annotations

import itertools
from collections import defaultdict
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from roaml.diagnostics import Finding, Related, Severity
from roaml.model.machine import Assign, Chart, RosSend, State, Statement, bodies
from roaml.regex import regex
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.words import difference
from roaml.text import Span

_MIN_SYMMETRIC = 2
"""How many pairs of parts must be symmetric before another pair is suspicious."""
_MAX_PARTS = 40
"""The number of parts of a state that are compared with each other; more are a table."""
_MAX_LENGTH = 2000
"""The number of characters of a part that is compared."""
_MIN_TOKENS = 10
"""The number of tokens of a part, below which every two are symmetric."""

_COMMENT = regex(r"<!--(?s:.*?)-->")
_TOKEN = regex(r"&\w+;|[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+|[^\s\w]")
_KINDS = {"!": "not", "true": "bool", "false": "bool", "&lt;": "order", "&gt;": "order", "<": "order", ">": "order"}
_KINDS |= {"+": "sum", "-": "sum"}
"""A token in which two symmetric parts must not differ -> its kind. Numbers may belong to one of them."""


class _Part(NamedTuple):
    """A part of a machine: the name of what it handles, sends or assigns, and its place."""

    kind: str
    name: str
    span: Span


class _Token(NamedTuple):
    text: str
    span: Span


class _Pair(NamedTuple):
    """Two parts that correspond to each other. `odd` contains the tokens in which they differ, as far as both have one,
    with the other words exchanged; `known` the tokens of the first part that have a kind."""

    first: _Part
    second: _Part
    odd: tuple[_Token | None, _Token | None] | None
    place: Span
    known: frozenset[str]


def check(context: MachineContext) -> Iterator[Finding]:
    """Report the only pair of corresponding parts that is not symmetric, if others of the same two words are."""
    for chart in context.machine.charts:
        pairs: dict[frozenset[str], list[_Pair]] = defaultdict(list)
        for parts in _groups(chart):
            for first, second in _corresponding(parts):
                words = difference(first.name, second.name)
                pair = _compared(context.source.text, first, second, words) if words is not None else None
                if words is not None and pair is not None:
                    pairs[frozenset(words)].append(pair)
        for of_words in pairs.values():
            yield from _asymmetric(of_words)


def _asymmetric(pairs: Sequence[_Pair]) -> Iterator[Finding]:
    symmetric = [pair for pair in pairs if pair.odd is None]
    asymmetric = [pair for pair in pairs if pair.odd is not None]
    if len(symmetric) < _MIN_SYMMETRIC or len(asymmetric) != 1:
        return
    (pair,) = asymmetric
    odd = [token.text for token in pair.odd or () if token is not None]
    # Whether a token should be symmetric is only known from a pair in which such a token is.
    if not odd or not all(any(_KINDS.get(text) in map(_KINDS.get, p.known) for p in symmetric) for text in odd):
        return
    if _are_directions(pair, symmetric):
        return
    other, own = ((token.text if token is not None else "") for token in pair.odd or ())
    what = f"has `{own}` where `{pair.first.name}` has `{other}`" if own and other else _missing(pair, own, other)
    message = (
        f"this part of `{pair.second.name}` {what}, but all other parts of both are alike except for their names; "
        "change one of them"
    )
    yield RULE.at(pair.place, message, related=[Related(pair.first.span, f"the part of `{pair.first.name}`")])


def _are_directions(pair: _Pair, symmetric: Sequence[_Pair]) -> bool:
    """Whether two parts differ in a sign, of which other pairs have both: as the wheels of a robot, which have the same
    sign forwards and backwards, and opposite ones when the robot turns."""
    signs = {token.text if token is not None else "" for token in pair.odd or ()}
    seen = {sign for other in symmetric for sign in other.known & {"+", "-"} or {""}}
    return signs <= {"+", "-", ""} and signs <= seen


def _missing(pair: _Pair, own: str, other: str) -> str:
    return f"has `{own}`, unlike that of `{pair.first.name}`" if own else f"lacks the `{other}` of `{pair.first.name}`"


def _groups(chart: Chart) -> Iterator[Sequence[_Part]]:
    """The parts that may correspond to each other: the handlers of a state, and the statements of a body."""
    for state in chart.states:
        yield [*_handlers(state)][:_MAX_PARTS]
    for _, _, body in bodies(chart):
        yield [part for statement in body[:_MAX_PARTS] if (part := _statement(statement)) is not None]


def _handlers(state: State) -> Iterator[_Part]:
    for handler in state.handlers:
        name = handler.handle or handler.event
        if handler.trigger is not None and name is not None:
            yield _Part(handler.trigger.value, name.value, handler.element.span)


def _statement(statement: Statement) -> _Part | None:
    match statement:
        case RosSend(handle=handle) if handle is not None:
            return _Part(statement.element.name, handle.value, statement.element.span)
        case Assign(location=location) if location is not None:
            return _Part("assign", location.text.strip(), statement.element.span)
    return None


def _corresponding(parts: Sequence[_Part]) -> Iterator[tuple[_Part, _Part]]:
    """The parts of two similar names in their order, if both have as many."""
    by_name: dict[tuple[str, str], list[_Part]] = defaultdict(list)
    for part in parts:
        by_name[part.kind, part.name].append(part)
    for (key, firsts), (other, seconds) in itertools.combinations(by_name.items(), 2):
        if key[0] == other[0] and len(firsts) == len(seconds):
            yield from zip(firsts, seconds, strict=True)


def _compared(text: str, first: _Part, second: _Part, words: tuple[str, str]) -> _Pair | None:
    """The pair of two parts; `None` if they differ in more than one token."""
    if max(part.span.end - part.span.start for part in (first, second)) > _MAX_LENGTH:
        return None
    left, right = _tokens(text, first.span), _tokens(text, second.span)
    a, b = words
    exchanged = [{a: b, b: a}.get(token.text, token.text) for token in left]
    begin = 0
    while begin < min(len(left), len(right)) and exchanged[begin] == right[begin].text:
        begin += 1
    end = 0
    while end < min(len(left), len(right)) - begin and exchanged[-1 - end] == right[-1 - end].text:
        end += 1
    odd = left[begin : len(left) - end], right[begin : len(right) - end]
    if max(map(len, odd)) > 1 or len(left) < _MIN_TOKENS:
        return None
    known = frozenset(token.text for token in left if token.text in _KINDS)
    place = right[min(begin, len(right) - 1)].span
    tokens = (odd[0][0] if odd[0] else None, odd[1][0] if odd[1] else None)
    return _Pair(first, second, tokens if any(odd) else None, place, known)


def _tokens(text: str, span: Span) -> list[_Token]:
    written = text[span.start : span.end]
    written = _COMMENT.sub(lambda match: " " * len(match.group()), written)
    found = _TOKEN.finditer(written)
    return [_Token(m.group().lower(), Span(span.start + m.start(), span.start + m.end())) for m in found]


RULE = Rule(
    "asymmetric-parts",
    Severity.WARNING,
    "Two parts of a machine differ in more than their names, unlike all others of these names.",
    machine=check,
    whole=True,
)
