# SPDX-License-Identifier: Apache-2.0
"""Translates scripts of BehaviorTree.CPP to assignments and conditions (docs/spec/mocks.md#scripts).

All entries that a script reads are read at once before the script, and all entries that it assigns are written after
it. Nothing else is executed in between.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NoReturn

from roaml.expr.operators import Operator, UnaryOperator
from roaml.expr.tree import Boolean as BooleanExpr
from roaml.expr.tree import Conditional as ConditionalExpr
from roaml.expr.tree import Expr
from roaml.expr.tree import Unary as UnaryExpr
from roaml.lower.build import binary, both, equal, floor, integer, name
from roaml.lower.programs.entries import BoardEntry, EntryKind, constant, read_literal
from roaml.lower.programs.refusal import INVALID_SCRIPT
from roaml.record import Record, field, replace
from roaml.script import tree as syntax
from roaml.text import NO_SPAN, Span


class ScriptRefusal(Exception):  # noqa: N818 - the script may be correct
    """Raised if a script cannot be translated. `span` is the position of the cause, and `unset` the name of the entry
    that nothing sets, if this is the cause."""

    def __init__(self, span: Span, reason: str, unset: str = "") -> None:
        super().__init__(reason)
        self.span = span
        self.reason = reason
        self.unset = unset


class CompiledScript(Record, frozen=True, eq=False):
    """A script that is translated to assignments.

    Attributes:
        reads: the entries that are read before the script.
        assignments: variables of the automaton with their new values, in order.
        writes: the entries that are written after the script.
        conditions: conditions that must hold before the assignments; otherwise the library throws an exception.
        truth: the condition that the value of the script is true; `None` if its value is not used.
    """

    reads: tuple[BoardEntry, ...]
    assignments: tuple[tuple[str, Expr], ...]
    writes: tuple[BoardEntry, ...]
    conditions: tuple[Expr, ...]
    truth: Expr | None


def _is_text(name: str) -> str:
    """Why the entry `name` with numbers is not a number in a script, and what to do."""
    return (
        f"`{name}` is a text, because `SetBlackboard` stores its constant as a text; "
        f'to use `{name}` as a number, set it with a script, such as `<Script code="{name} := 4"/>`'
    )


_JOINED = "texts cannot be joined in the translation"


class _Value(Record, frozen=True):
    """A translated expression. `kind` is the kind of its value; `None` for a condition. `text_of` is the name of the
    entry if its numbers are stored as texts."""

    expr: Expr
    kind: EntryKind | None
    text_of: str = ""


def compiled(
    parsed: syntax.Script,
    entry: Callable[[str], BoardEntry | None],
    unset: Callable[[str], str],
    *,
    is_condition: bool,
) -> CompiledScript:
    """The translation of a script.

    Args:
        entry: returns the entry to which a name refers; `None` if nothing sets it.
        unset: returns the message for a name to which no entry belongs.
        is_condition: whether the value of the script is used.

    Raises:
        ScriptRefusal: the script cannot be translated.
    """
    return _Compiler(entry, unset).script(parsed, is_condition=is_condition)


class _Compiler(Record):
    entry: Callable[[str], BoardEntry | None]
    unset: Callable[[str], str]
    reads: dict[str, BoardEntry] = field(default_factory=dict)
    writes: dict[str, BoardEntry] = field(default_factory=dict)
    assignments: list[tuple[str, Expr]] = field(default_factory=list)
    conditions: list[Expr] = field(default_factory=list)

    def script(self, parsed: syntax.Script, *, is_condition: bool) -> CompiledScript:
        value: _Value | None = None
        for statement in parsed.statements:
            value = self.value(statement)
        truth: Expr | None = None
        if is_condition and value is not None:
            truth = self.truth(value, parsed.statements[-1].span)
        return CompiledScript(
            tuple(self.reads.values()),
            tuple(self.assignments),
            tuple(self.writes.values()),
            tuple(self.conditions),
            truth,
        )

    def refuse(self, expr: syntax.Expr, reason: str) -> NoReturn:
        raise ScriptRefusal(expr.span, reason)

    def find(self, expr: syntax.Name) -> BoardEntry:
        entry = self.entry(expr.name)
        if entry is None:
            raise ScriptRefusal(expr.span, self.unset(expr.name), expr.name)
        return entry

    def value(self, expr: syntax.Expr) -> _Value:
        match expr:
            case syntax.Number(value=number):
                kind = EntryKind.INTEGER if isinstance(number, int) else EntryKind.REAL
                return _Value(constant(kind, number), kind)
            case syntax.Boolean(value=truth):
                return _Value(BooleanExpr(NO_SPAN, truth), None)
            case syntax.String(value=text):
                return _Value(constant(EntryKind.TEXT, text), EntryKind.TEXT)
            case syntax.Name():
                entry = self.find(expr)
                if entry.text is not None:
                    return _Value(constant(EntryKind.TEXT, entry.text), EntryKind.TEXT)
                if entry.variable not in self.writes:
                    self.reads[entry.variable] = entry
                return _Value(name(entry.local), entry.kind, expr.name if entry.is_text else "")
            case syntax.Unary():
                return self.unary(expr)
            case syntax.Binary():
                return self.binary(expr)
            case syntax.Comparison():
                return self.comparison(expr)
            case syntax.Conditional():
                return self.conditional(expr)
            case syntax.Assignment():
                return self.assignment(expr)
            case syntax.ErrorExpr():
                raise ScriptRefusal(expr.span, INVALID_SCRIPT)

    def unary(self, expr: syntax.Unary) -> _Value:
        operand = self.value(expr.operand)
        match expr.operator:
            case "!":
                return _Value(UnaryExpr(NO_SPAN, UnaryOperator.NOT, self.truth(operand, expr.operand.span)), None)
            case "-":
                number = self.number(operand, expr.operand)
                return _Value(UnaryExpr(NO_SPAN, UnaryOperator.NEGATE, number.expr), number.kind)
        raise ScriptRefusal(expr.span, f"`{expr.operator}` works on bits, which JANI does not support")

    def binary(self, expr: syntax.Binary) -> _Value:
        left, right = self.value(expr.left), self.value(expr.right)
        match expr.operator:
            case "&&" | "||" as operator:
                symbol = Operator.AND if operator == "&&" else Operator.OR
                sides = self.truth(left, expr.left.span), self.truth(right, expr.right.span)
                return _Value(binary(sides[0], symbol, sides[1]), None)
            case "&" | "|" | "^" as operator:
                self.refuse(expr, f"`{operator}` works on bits, which JANI does not support")
            case "..":
                self.refuse(expr, _JOINED)
        if EntryKind.TEXT in (left.kind, right.kind):
            self.refuse(expr, _JOINED)
        first, second = self.number(left, expr.left), self.number(right, expr.right)
        symbol = {"+": Operator.ADD, "-": Operator.SUBTRACT, "*": Operator.MULTIPLY, "/": Operator.DIVIDE}[
            expr.operator
        ]
        kind = (
            EntryKind.REAL if expr.operator == "/" or EntryKind.REAL in (first.kind, second.kind) else EntryKind.INTEGER
        )
        return _Value(binary(first.expr, symbol, second.expr), kind)

    def comparison(self, expr: syntax.Comparison) -> _Value:
        values = [self.value(operand) for operand in expr.operands]
        result: Expr | None = None
        for position, operator in enumerate(expr.operators):
            left, right = self.comparable(expr, values[position], values[position + 1])
            if left.kind is EntryKind.TEXT and operator not in ("==", "!="):
                self.refuse(
                    expr,
                    f"texts cannot be compared with `{operator}` in the translation; only `==` and `!=` are possible",
                )
            symbol = next(known for known in Operator if known.symbol == operator)
            result = both(result, binary(left.expr, symbol, right.expr))
        assert result is not None
        return _Value(result, None)

    def comparable(self, expr: syntax.Expr, left: _Value, right: _Value) -> tuple[_Value, _Value]:
        if left.kind is EntryKind.TEXT and right.kind is EntryKind.TEXT:
            return left, right
        if left.text_of or right.text_of:
            if EntryKind.TEXT in (left.kind, right.kind) or (left.text_of and right.text_of):
                self.refuse(expr, _is_text(left.text_of or right.text_of))
            left, right = replace(left, text_of=""), replace(right, text_of="")
        if EntryKind.TEXT in (left.kind, right.kind):
            return self.with_text(expr, left, right)
        return self.number(left, expr), self.number(right, expr)

    def with_text(self, expr: syntax.Expr, left: _Value, right: _Value) -> tuple[_Value, _Value]:
        """The sides of a comparison of a text with a number, in which the text is read as a number."""
        sides = []
        for side in (left, right):
            text = getattr(side.expr, "value", None)
            if side.kind is EntryKind.TEXT:
                kind, literal = read_literal(text) if isinstance(text, str) else (EntryKind.TEXT, "")
                if kind is EntryKind.TEXT:
                    self.refuse(
                        expr, "the comparison of a number with a text that is not a number cannot be translated"
                    )
                sides.append(_Value(constant(kind, literal), kind))
            else:
                sides.append(self.number(side, expr))
        return sides[0], sides[1]

    def conditional(self, expr: syntax.Conditional) -> _Value:
        test = self.value(expr.test)
        before = len(self.assignments)
        yes, no = self.value(expr.yes), self.value(expr.no)
        if len(self.assignments) > before:
            self.refuse(expr, "an assignment inside `? :` cannot be translated; use a condition of the node instead")
        condition = (
            UnaryExpr(NO_SPAN, UnaryOperator.NOT, equal(test.expr, constant(EntryKind.TEXT, "")))
            if test.kind is EntryKind.TEXT
            else self.truth(test, expr.test.span)
        )
        if EntryKind.TEXT in (yes.kind, no.kind):
            if yes.kind is not no.kind:
                self.refuse(expr, "the two results of `? :` must both be texts or both be numbers")
            return _Value(ConditionalExpr(NO_SPAN, condition, yes.expr, no.expr), EntryKind.TEXT)
        first, second = self.number(yes, expr.yes), self.number(no, expr.no)
        kind = EntryKind.REAL if EntryKind.REAL in (first.kind, second.kind) else EntryKind.INTEGER
        return _Value(ConditionalExpr(NO_SPAN, condition, first.expr, second.expr), kind)

    def assignment(self, expr: syntax.Assignment) -> _Value:
        value = self.value(expr.value)
        entry = self.find(expr.target)
        current = _Value(name(entry.local), entry.kind)
        if expr.operator not in (":=", "="):
            if entry.variable not in self.writes:
                self.reads[entry.variable] = entry
            operation = syntax.Binary(expr.span, expr.operator[0], expr.operator_span, expr.target, expr.value)
            value = self.binary(operation)
        converted = self.converted(expr, value, entry)
        self.assignments.append((entry.local, converted))
        self.writes[entry.variable] = entry
        return current

    def converted(self, expr: syntax.Assignment, value: _Value, entry: BoardEntry) -> Expr:
        """A value that is converted to the type of the entry to which it is assigned."""
        if entry.kind is EntryKind.TEXT or value.kind is EntryKind.TEXT:
            if entry.kind is value.kind:
                return value.expr
            text = getattr(value.expr, "value", None)
            if value.kind is EntryKind.TEXT and isinstance(text, str) and read_literal(text)[0] is not EntryKind.TEXT:
                return constant(entry.kind, read_literal(text)[1])
            self.refuse(
                expr, f"the entry `{expr.target.name}` is {entry.kind.value}, but the assigned value has another type"
            )
        if value.text_of:
            value = replace(value, text_of="")
        elif entry.is_text:
            self.refuse(expr, _is_text(expr.target.name))
        number = self.number(value, expr.value)
        if entry.kind is EntryKind.INTEGER and number.kind is EntryKind.REAL:
            if self.assignments:
                reason = f"a real number is assigned to the integer `{expr.target.name}` after another assignment"
                self.refuse(expr, f"{reason}; use separate scripts")
            whole = floor(number.expr)
            self.conditions.append(equal(whole, number.expr))
            return whole
        return number.expr

    def number(self, value: _Value, expr: syntax.Expr) -> _Value:
        if value.kind is None:
            as_number = ConditionalExpr(NO_SPAN, value.expr, integer(1), integer(0))
            return _Value(as_number, EntryKind.INTEGER)
        if value.kind is EntryKind.TEXT:
            self.refuse(expr, "a number is needed here, but the value is a text")
        if value.text_of:
            self.refuse(expr, _is_text(value.text_of))
        return value

    def truth(self, value: _Value, span: Span) -> Expr:
        if value.kind is None:
            return value.expr
        if value.kind is EntryKind.TEXT:
            raise ScriptRefusal(span, "the value is a text, which is neither true nor false")
        if value.text_of:
            raise ScriptRefusal(span, _is_text(value.text_of))
        return UnaryExpr(NO_SPAN, UnaryOperator.NOT, equal(value.expr, integer(0)))
