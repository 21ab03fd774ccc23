# SPDX-License-Identifier: Apache-2.0
"""Expands numbers that the handlers of a machine draw from distributions to targets with probabilities
(docs/spec/distributions.md#values).

A handler draws all of its numbers when it is taken: each combination of values becomes a target, with a copy of the
body in which the values replace the draws. One copy is the text of the user; the others are inserted before it.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from typing import NamedTuple

from roaml.distributions.data import read_histogram
from roaml.distributions.laws import HISTOGRAM, LAWS, MAX_VALUES, LawError
from roaml.distributions.outcomes import Outcomes, decimal_text, outcomes
from roaml.exact_number import exact_number
from roaml.expansion.instances import removed_attribute
from roaml.expansion.problems import ExpansionProblem, Problems
from roaml.expansion.text import CopiedText, ExpandedText
from roaml.expansion.values import Content, ParameterValue, evaluate
from roaml.expr.parse import parse as parse_expression
from roaml.expr.tree import Call, Expr, Name, walk
from roaml.language import HL_SCXML
from roaml.language.grammar import ElementType
from roaml.record import Record
from roaml.roles import ValueRole
from roaml.text import Decoded, Span, TextEdit, apply_edits
from roaml.xml_syntax import Document, Element, parse

_VALUES = ("assign", "field", "param", "bt_set_output")
"""The elements whose values can contain draws: those in which `Math.random()` is allowed."""
_EXPRESSIONS = (ValueRole.EXPRESSION, ValueRole.CONSTANT, ValueRole.LOCATION)
_OUTSIDE_OF_HANDLERS = ("onentry", "onexit", "datamodel")


class DrawnNumber(Record, frozen=True):
    """A number that a machine or a channel draws (docs/spec/distributions.md#error).

    Attributes:
        path: the file of the user.
        span: the call of the distribution.
        text: the call, with the values of parameters.
        values: the number of different values.
        shift: how far a value is from the drawn number at most, unless this is cut.
        cut: an upper bound of the probability of the numbers that are cut.
        unit: the unit of `shift`; "" if the number has none.
    """

    path: str
    span: Span
    text: str
    values: int
    shift: Fraction
    cut: float
    unit: str = ""


class _Draw(NamedTuple):
    """A call of a distribution in a value. `literals` are those of its values."""

    span: Span
    outcomes: Outcomes
    literals: tuple[str, ...]


class _Piece(NamedTuple):
    """A part of an inserted text; see `CopiedText`."""

    text: str
    source: Span
    is_exact: bool = False


def expand_draws(
    text: ExpandedText, problems: Problems, read: Callable[[str], str | None]
) -> tuple[ExpandedText, tuple[DrawnNumber, ...]]:
    """A machine in which targets with probabilities replace the draws, and these draws. An invalid draw is a
    problem, and a number replaces it.

    Args:
        text: the machine without parameters.
        problems: receives the problems, at their places in the file of the user.
        read: the name of a file, as the machine writes it -> its text; `None` if it cannot be read.
    """
    return _Machine(text, parse(text.text), problems, read).expanded()


class _Machine:
    def __init__(
        self, text: ExpandedText, document: Document, problems: Problems, read: Callable[[str], str | None]
    ) -> None:
        self._before = text
        self._read = read
        self._document = document
        self._problems = problems
        self._edits: list[tuple[Span, tuple[_Piece, ...]]] = []
        self._numbers: list[DrawnNumber] = []

    def expanded(self) -> tuple[ExpandedText, tuple[DrawnNumber, ...]]:
        root = self._document.root
        if root is not None:
            self._outside(root, HL_SCXML.elements.get(root.name))
        if not self._edits:
            return self._before, ()
        edits: list[TextEdit] = []
        copies: list[CopiedText] = []
        shift = 0
        for span, pieces in sorted(self._edits, key=lambda edit: edit[0]):
            offset = span.start + shift
            for piece in pieces:
                copies.append(CopiedText(offset, offset + len(piece.text), piece.source, piece.is_exact))
                offset += len(piece.text)
            edits.append(TextEdit(span, "".join(piece.text for piece in pieces)))
            shift += len(edits[-1].new_text) - (span.end - span.start)
        before, plain = self._before, tuple(edits)
        text = apply_edits(before.text, plain)
        earlier = before if before.edits else None
        return ExpandedText(before.path, before.source, text, plain, tuple(copies), earlier), tuple(self._numbers)

    # ------------------------------------------------------------------ places

    def _outside(self, element: Element, type_: ElementType | None) -> None:
        """Look for handlers, and for draws outside of them."""
        for _, call, _, _ in self._calls_at(element, type_):
            self._misplaced(call, "here; only the bodies of handlers draw numbers")
        for child, child_type in _children(element, type_):
            if element.name == "state" and child.name not in _OUTSIDE_OF_HANDLERS:
                self._handler(child, child_type)
            else:
                self._outside(child, child_type)

    def _handler(self, handler: Element, type_: ElementType | None) -> None:
        targets = [(child, child_type) for child, child_type in _children(handler, type_) if child.name == "target"]
        if targets:
            for _, call, _, _ in self._calls_at(handler, type_):
                self._misplaced(call, "in a condition; draw it in an earlier handler and assign it to a variable")
            self._targets([(target, self._draws(target, target_type)) for target, target_type in targets])
            return
        draws = self._draws(handler, type_)
        target = handler.get("target")
        if draws and target is not None and handler.close_span is not None:
            copies = self._copies(draws, Span(handler.open_span.end, handler.close_span.start))
            quoted = self._document.text[target.value_span.start - 1 : target.value_span.end + 1]
            opened = f"<target id={quoted}"
            closed = _Piece("</target>", Span(target.span.end, target.span.end))
            pieces: list[_Piece] = []
            for share, body in copies[:-1]:
                pieces.append(_Piece(f'{opened} prob="{decimal_text(share)}">', target.span))
                pieces += (*body, closed)
            pieces.append(_Piece(f"{opened}>", target.span))
            removed = removed_attribute(self._document, target)
            self._edits.append((removed.span, ()))
            self._insert(handler.open_span.end, pieces)
            self._keep(draws)
            self._insert(handler.close_span.start, [closed])

    def _targets(self, targets: Sequence[tuple[Element, list[_Draw]]]) -> None:
        """Expand the targets of a handler."""
        given = [_share(target) for target, _ in targets]
        rest = 1 - sum((share for share in given if share is not None), Fraction(0))
        for (target, draws), written in zip(targets, given, strict=True):
            share = rest if written is None else written
            if not draws or share <= 0 or target.close_span is None:
                continue
            prob = target.get("prob")
            opening = self._document.text[target.open_span.start : target.open_span.end]
            without = opening
            if prob is not None:
                removed = removed_attribute(self._document, prob).span
                start = target.open_span.start
                without = opening[: removed.start - start] + opening[removed.end - start :]
            copies = self._copies(draws, Span(target.open_span.end, target.close_span.start))
            pieces: list[_Piece] = []
            for part, body in copies[:-1]:
                shown = f'{without[:-1].rstrip()} prob="{decimal_text(float(share) * part)}">'
                end = Span(target.close_span.end, target.close_span.end)
                pieces += (_Piece(shown, target.open_span), *body, _Piece("</target>", end))
            self._insert(target.open_span.start, pieces)
            if prob is not None:
                kept = decimal_text(float(share) * copies[-1][0])
                self._edits.append((prob.value_span, (_Piece(kept, prob.value_span),)))
            self._keep(draws)

    def _copies(self, draws: Sequence[_Draw], body: Span) -> list[tuple[float, list[_Piece]]]:
        """The probability and the body for each combination of values."""
        text = self._document.text
        copies = []
        for numbers in itertools.product(*(range(len(draw.literals)) for draw in draws)):
            pieces, at = [], body.start
            for draw, number in zip(draws, numbers, strict=True):
                pieces.append(_Piece(text[at : draw.span.start], Span(at, draw.span.start), True))
                pieces.append(_Piece(draw.literals[number], draw.span))
                at = draw.span.end
            pieces.append(_Piece(text[at : body.end], Span(at, body.end), True))
            share = math.prod(d.outcomes.probabilities[n] for d, n in zip(draws, numbers, strict=True))
            copies.append((share, pieces))
        return copies

    def _keep(self, draws: Sequence[_Draw]) -> None:
        """Replace the draws in the text of the user by their last values."""
        for draw in draws:
            self._edits.append((draw.span, (_Piece(draw.literals[-1], draw.span),)))

    def _insert(self, at: int, pieces: Sequence[_Piece]) -> None:
        self._edits.append((Span(at, at), tuple(pieces)))

    # ------------------------------------------------------------------- draws

    def _draws(self, body: Element, type_: ElementType | None) -> list[_Draw]:
        """The draws in a handler without targets, or in a target, in their order; none if one is not valid."""
        draws: list[_Draw] = []
        invalid: list[Call] = []
        for element, call, role, is_value in self._calls_below(body, type_):
            if not is_value or element.name not in _VALUES or role is not ValueRole.EXPRESSION:
                self._misplaced(call, "here; assign it to a variable first")
                invalid.append(call)
            elif (draw := self._draw(call)) is not None:
                draws.append(draw)
            else:
                invalid.append(call)
        draws.sort(key=lambda draw: draw.span)
        count = math.prod(len(draw.literals) for draw in draws)
        if count > MAX_VALUES:
            message = (
                f"the numbers that are drawn here have {count:,} combinations of values; at most {MAX_VALUES:,} are "
                "possible; draw fewer numbers, or use greater steps"
            )
            self._add(ExpansionProblem.DISTRIBUTION, draws[-1].span, message)
        elif not invalid:
            return draws
        # Numbers replace the draws, so that nothing else is reported about them.
        self._keep(draws)
        self._edits += ((call.span, (_Piece("0", call.span),)) for call in invalid)
        return []

    def _draw(self, call: Call) -> _Draw | None:
        assert isinstance(call.function, Name)
        function = LAWS[call.function.name]
        values = [evaluate(argument, {}) for argument in call.arguments]
        if function.name == HISTOGRAM:
            return self._histogram(call, values)
        numbers = [value for value in values if isinstance(value, Fraction)]
        if len(numbers) < len(values):
            wrong = next(a for a, v in zip(call.arguments, values, strict=True) if not isinstance(v, Fraction))
            message = (
                f"`{self._text(wrong.span)}` is not a number, and not an expression of numbers and parameters, as "
                f"`{function.name}` needs"
            )
            self._add(ExpansionProblem.DISTRIBUTION, wrong.span, message)
            return None
        try:
            if function.is_continuous and len(numbers) == len(function.parameters):
                raise LawError(
                    f"it needs a step, to multiples of which its numbers are rounded; write `{function.signature}`"
                )
            step = numbers.pop() if function.is_continuous and len(numbers) > len(function.parameters) else None
            found = outcomes(function.law(numbers), step)
        except LawError as error:
            self._invalid(call, str(error))
            return None
        return self._drawn(call, found, step)

    def _histogram(self, call: Call, values: Sequence[Content | None]) -> _Draw | None:
        """A draw from the values in a file."""
        match values:
            case [str() as file]:
                step = None
            case [str() as file, Fraction() as step] if step > 0:
                pass
            case _:
                self._invalid(call, "it needs the name of a file in quotes, and optionally a step above 0")
                return None
        text = self._read(file)
        if text is None:
            self._invalid(call, f"there is no file `{file}` that can be read beside this one")
            return None
        try:
            found = outcomes(read_histogram(text), step)
        except LawError as error:
            self._invalid(call, f"`{file}`: {error}")
            return None
        return self._drawn(call, found, step)

    def _invalid(self, call: Call, reason: str) -> None:
        message = f"`{self._text(call.span)}` is not a distribution: {reason}"
        self._add(ExpansionProblem.DISTRIBUTION, call.span, message)

    def _drawn(self, call: Call, found: Outcomes, step: Fraction | None) -> _Draw:
        is_real = any(value.denominator != 1 for value in (*found.values, step or Fraction(1)))
        type_ = "float64" if is_real else "int64"
        literals = tuple(ParameterValue(type_, value).literal for value in found.values)
        origin = self._before.origin(call.span)
        self._numbers.append(
            DrawnNumber(self._before.source, origin, self._text(call.span), len(literals), found.shift, found.cut)
        )
        return _Draw(call.span, found, literals)

    def _calls_below(
        self, element: Element, type_: ElementType | None
    ) -> Iterator[tuple[Element, Call, ValueRole, bool]]:
        yield from self._calls_at(element, type_)
        for child, child_type in _children(element, type_):
            for inner, call, role, is_value in self._calls_below(child, child_type):
                yield element if inner.name == "expr" else inner, call, role, is_value

    def _calls_at(self, element: Element, type_: ElementType | None) -> Iterator[tuple[Element, Call, ValueRole, bool]]:
        """The calls of distributions in the expressions of an element: the element, the call, the role of the
        expression, and whether it is the attribute `expr` or the content of `<expr>`."""
        for attribute in element.attributes:
            role = type_.attributes.get(attribute.name) if type_ else None
            if attribute.has_value and role is not None and role.value in _EXPRESSIONS:
                for call in _calls(self._document.decoded(attribute.value_span)):
                    yield element, call, role.value, attribute.name == "expr"
        if (
            type_ is not None
            and type_.value in _EXPRESSIONS
            and (content := self._document.content(element)) is not None
        ):
            for call in _calls(content):
                yield element, call, type_.value, element.name == "expr"

    def _misplaced(self, call: Call, where: str) -> None:
        assert isinstance(call.function, Name)
        message = f"`{call.function.name}` is not allowed {where}"
        self._add(ExpansionProblem.MISPLACED, call.span, message)

    def _add(self, kind: ExpansionProblem, span: Span, message: str) -> None:
        self._problems.add(kind, self._before.origin(span), message)

    def _text(self, span: Span) -> str:
        return self._document.text[span.start : span.end]


def _children(element: Element, type_: ElementType | None) -> Iterator[tuple[Element, ElementType | None]]:
    for child in element.elements:
        local = type_.local.get(child.name) if type_ else None
        yield child, None if child.is_foreign else local or HL_SCXML.elements.get(child.name)


def _calls(decoded: Decoded) -> Iterator[Call]:
    """The calls of distributions in an expression that are not inside of others."""
    if "(" not in decoded.text:
        return
    tree, _ = parse_expression(decoded)
    inside: set[int] = set()
    for node in walk(tree):
        if _is_draw(node) and id(node) not in inside:
            inside |= {id(part) for part in walk(node)}
            assert isinstance(node, Call)
            yield node


def _is_draw(node: Expr) -> bool:
    match node:
        case Call(function=Name(name=name)):
            return name in LAWS
    return False


def _share(target: Element) -> Fraction | None:
    """The probability of a target; `None` if it has none, or if it is not a number."""
    prob = target.get("prob")
    return None if prob is None else exact_number(prob.value)
