# SPDX-License-Identifier: Apache-2.0
"""Text -> expression tree, by operator precedence (Pratt 1973), for any text.

- Never fails: every error is a finding with a span, and the tree contains an `ErrorExpr` there.
- Accepts the grammar of docs/spec/expressions.md#grammar and, beyond the reference translator, `===`, `!==`, unary `+`
  and `?:` (docs/spec/differences.md#accepted-expressions).
- Reports valid ECMAScript outside the subset as "unsupported-expression", not as a syntax error.
"""

from __future__ import annotations

import math
import re
import sys
from functools import lru_cache

from roaml.diagnostics import Finding, Fix
from roaml.exhaustive import Vocabulary
from roaml.expr.operators import BINARY, UNARY, UNARY_PRECEDENCE, Operator, UnaryOperator
from roaml.expr.tree import (
    ArrayLiteral,
    Binary,
    Boolean,
    Call,
    Conditional,
    ErrorExpr,
    Expr,
    Index,
    Member,
    Name,
    Number,
    ObjectLiteral,
    ObjectMember,
    String,
    Unary,
    placed,
)
from roaml.expr.words import PREFIXES, STATEMENTS
from roaml.record import Record, replace
from roaml.regex import regex
from roaml.text import Decoded, Span, TextEdit

MAX_DEPTH = 150
"""The maximum depth of a tree, so that functions over trees may recurse."""

MAX_FINDINGS = 20
"""The maximum number of errors that are reported in one expression."""

SYNTAX = "expression-syntax"
UNSUPPORTED = "unsupported-expression"


class ExpressionTokenKind(Vocabulary):
    """The kind of a token. The values are the names of groups in `_TOKEN`."""

    NUMBER = "number"
    NAME = "name"
    STRING = "string"
    TEMPLATE = "template"
    PUNCTUATOR = "punctuator"
    JUNK = "junk"


class ExpressionToken(Record, frozen=True):
    """A token of an expression. `start` and `end` are offsets in the decoded text."""

    kind: ExpressionTokenKind
    text: str
    start: int
    end: int


_TOKEN = regex(
    r"""\s*(?:
      (?P<number>0[xX][0-9a-fA-F]+ | (?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)
    | (?P<name>[^\W\d][\w$]*|\$[\w$]*)
    | (?P<string>"(?:[^"\\]|\\.)*" | '(?:[^'\\]|\\.)*')
    | (?P<template>`[^`]*`?)
    | (?P<punctuator>===|!==|\*\*=?|>>>=?|<<=?|>>=?|[-+*/%&|^]=|==|!=|<=|>=|&&|\|\||\+\+|--|=>|=<|<>
        | [-+*/%<>=!&|^~?:.,;()\[\]{}])
    | (?P<junk>["'].*|\S)
    )""",
    re.VERBOSE | re.DOTALL,
)
# The most common expressions: a name, a member of a name, and a decimal number.
_SIMPLE_PATH = regex(r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*){0,8}\Z", re.ASCII)
_SIMPLE_NUMBER = regex(r"(?:0|[1-9]\d{0,14})(\.\d{1,15})?\Z", re.ASCII)
_ESCAPE = regex(r"\\(?:u\{([0-9a-fA-F]+)\}|u([0-9a-fA-F]{4})|x([0-9a-fA-F]{2})|(\r\n|.))", re.DOTALL)
_ESCAPES = {"n": "\n", "t": "\t", "r": "\r", "b": "\b", "f": "\f", "v": "\v", "0": "\0", "\n": "", "\r\n": ""}

_MAX_REMEMBERED_LENGTH = 500
"""The maximum number of characters of an expression that is cached."""

_SURROGATE = regex("[\ud800-\udfff]")

_BITS = "bit operations are not supported"
_STORE = "use `<assign>` to store a value"
_FOREIGN_OPERATORS = {
    "**": "use `Math.pow(x, y)`",
    "&": "write `&&` for a logical AND",
    "|": "write `||` for a logical OR",
    "^": _BITS,
    "<<": _BITS,
    ">>": _BITS,
    ">>>": _BITS,
    "=": "write `==` to compare; " + _STORE,
    "<>": "write `!=` to compare",
    "=<": "write `<=` to compare",
    "=>": "write `>=` to compare; functions are not supported",
    "in": "write the comparison explicitly",
    "instanceof": "objects are not supported",
} | dict.fromkeys(("+=", "-=", "*=", "/=", "%=", "&=", "|=", "^=", "<<=", ">>=", ">>>=", "**="), _STORE)
_REPLACEMENTS = {"&": "&&", "|": "||", "=": "==", "<>": "!=", "=<": "<="}
_WORD_OPERATORS = {"and": Operator.AND, "or": Operator.OR}
_STEPS = ("++", "--")
_QUOTES = {'"': "&quot;", "'": "&apos;"}
_POSTFIX = frozenset((".", "[", "(", *_STEPS))
_LITERALS = {"true": True, "false": False}
_WORDS = PREFIXES | STATEMENTS | _LITERALS.keys() | {"this"}
_CLOSERS = frozenset((")", "]", "}"))
_OPENERS = frozenset(("(", "[", "{"))
_PRIMARY = (Call, Index, Member, Name, Number)
"""Expressions that need no parentheses as arguments."""
_KINDS = {kind.value: kind for kind in ExpressionTokenKind}
_OPERAND_KINDS = frozenset(ExpressionTokenKind) - {ExpressionTokenKind.PUNCTUATOR, ExpressionTokenKind.JUNK}


def tokens(text: str) -> list[ExpressionToken]:
    """The tokens of an expression; together with white space they cover the whole text."""
    text_tokens = []
    for match in _TOKEN.finditer(text, 0, len(text.rstrip())):
        group = match.lastgroup or "junk"
        start, end = match.span(group)
        text_tokens.append(ExpressionToken(_KINDS[group], match[group], start, end))
    return text_tokens


def parse(source: Decoded) -> tuple[Expr, tuple[Finding, ...]]:
    """The expression in `source` and its syntax errors."""
    text = source.text
    if len(text) <= _MAX_REMEMBERED_LENGTH and (sound := _sound(text)) is not None:
        return placed(sound, source), ()
    return _parse(source)


def _parse(source: Decoded) -> tuple[Expr, tuple[Finding, ...]]:
    text = source.text
    if _SIMPLE_PATH.match(text) and (path := text.split("."))[0] not in _WORDS:
        return _path(source, path), ()
    if number := _SIMPLE_NUMBER.match(text):
        is_real = number[1] is not None
        return Number(source.span(0, len(text)), float(text) if is_real else int(text), is_real), ()
    parser = _Parser(source)
    expr = parser.whole()
    return expr, tuple(parser.findings)


@lru_cache(maxsize=5000)
def _sound(text: str) -> Expr | None:
    """The tree of an expression; `None` if it has errors. The spans in the tree are offsets in `text`.

    The result is cached: files repeat the same expressions, and after each keystroke nearly all of them are unchanged.
    """
    expr, findings = _parse(Decoded(text, 0))
    return None if findings else expr


def _path(source: Decoded, names: list[str]) -> Expr:
    end = len(names[0])
    expr: Expr = Name(source.span(0, end), names[0])
    for name in names[1:]:
        start, end = end + 1, end + 1 + len(name)
        expr = Member(source.span(0, end), expr, name, source.span(start, end))
    return expr


def _power(base: Expr, exponent: Expr) -> Fix:
    edits = (
        TextEdit(Span(base.span.start, base.span.start), "Math.pow("),
        TextEdit(Span(base.span.end, exponent.span.start), ", "),
        TextEdit(Span(exponent.span.end, exponent.span.end), ")"),
    )
    return Fix("Use `Math.pow`", edits)


class _TooDeepError(Exception):
    """Ends the recursion of the parser at `MAX_DEPTH`; `_Parser.whole` catches it."""


class _Parser:
    def __init__(self, source: Decoded) -> None:
        self.source = source
        self.tokens = tokens(source.text)
        self.at = 0
        self.depth = 0
        self.gap = 0  # the start of the token before which a part was last reported as missing
        self.findings: list[Finding] = []
        self.reported: set[Span] = set()

    def whole(self) -> Expr:
        everything = self.source.span(0, len(self.source.text))
        if not self.tokens:
            self.report(everything, "an expression is missing")
            return ErrorExpr(everything)
        try:
            expr = self.expression(0)
        except _TooDeepError:
            del self.findings[:]
            self.report(everything, f"the expression is nested more than {MAX_DEPTH} levels deep")
            return ErrorExpr(everything)
        if (rest := self.peek()) is not None:
            self.superfluous(rest)
        return expr

    def superfluous(self, token: ExpressionToken) -> None:
        """Report text after a complete expression."""
        span = self.span(token)
        remove = Fix("Remove it", (TextEdit(span, ""),), preferred=False)
        if token.text == ",":
            self.report(span, "`,` is not supported: an expression is a single value", UNSUPPORTED)
        elif token.text == ";":
            last = (remove,) if token is self.tokens[-1] else ()
            self.report(span, "an expression must be a single value; statements are not supported", UNSUPPORTED, *last)
        elif token.text in _CLOSERS:
            self.report(span, f"`{token.text}` closes no bracket; remove it", SYNTAX, remove)
        else:
            self.report(span, f"an operator is missing before `{token.text[:20]}`")

    def expression(self, precedence: int) -> Expr:
        """An expression whose operators all have at least this precedence."""
        start_depth, first = self.depth, self.at
        self.deeper()
        left = self.operand()
        while (token := self.peek()) is not None:
            if token.kind is ExpressionTokenKind.PUNCTUATOR:
                operator = BINARY.get(token.text)
            else:
                operator = _WORD_OPERATORS.get(token.text.lower()) if token.kind is ExpressionTokenKind.NAME else None
            if operator is not None:
                if operator.precedence < precedence:
                    break
                if token.kind is ExpressionTokenKind.NAME:
                    self.written(token, operator.symbol)
                self.at += 1
                self.deeper()
                right = self.expression(operator.precedence + 1)
                left = Binary(self.since(first), operator, self.span(token), left, right)
            elif token.text == "?" and precedence == 0:
                self.at += 1
                left = self.conditional(left, first)
            elif token.text in _FOREIGN_OPERATORS and precedence == 0:
                left = self.foreign(left, first, token)
            else:
                break
        self.depth = start_depth
        return left

    def foreign(self, left: Expr, first: int, token: ExpressionToken) -> Expr:
        """Report a binary operator of ECMAScript or of another language that is not supported."""
        span = self.span(token)
        replacement = _REPLACEMENTS.get(token.text)
        fixes = (Fix(f"Write `{replacement}`", (TextEdit(span, _in_xml(replacement)),)),) if replacement else ()
        hint = _FOREIGN_OPERATORS[token.text]
        number = len(self.findings)
        self.report(span, f"`{token.text}` is not supported: {hint}", UNSUPPORTED, *fixes)
        self.at += 1
        self.deeper()
        right = self.expression(1)
        alone = len(self.findings) == number + 1
        if token.text == "**" and alone and isinstance(left, _PRIMARY) and isinstance(right, _PRIMARY):
            self.findings[number] = replace(self.findings[number], fixes=(_power(left, right),))
        return ErrorExpr(self.since(first), (left, right))

    def written(self, token: ExpressionToken, symbol: str) -> None:
        """Report that an operator must be written as `symbol`."""
        span = self.span(token)
        message = f"`{token.text}` is not an operator; write `{symbol}`"
        self.report(span, message, SYNTAX, Fix(f"Write `{symbol}`", (TextEdit(span, _in_xml(symbol)),)))

    def conditional(self, test: Expr, first: int) -> Expr:
        then = self.expression(0)
        otherwise = self.expression(0) if self.accept(":") else self.missing("`:` with the second value of `?`")
        return Conditional(self.since(first), test, then, otherwise)

    def operand(self) -> Expr:
        token = self.peek()
        if token is None:
            return self.missing("a value")
        first = self.at
        if token.kind is ExpressionTokenKind.PUNCTUATOR and token.text in UNARY:
            self.at += 1
            operand = self.expression(UNARY_PRECEDENCE)
            return Unary(self.since(first), UNARY[token.text], operand)
        return self.postfix(self.primary(token), first)

    def postfix(self, expr: Expr, first: int) -> Expr:
        """Parse the member accesses, indices and calls after the operand `expr`, which begins with token `first`."""
        while (
            (token := self.peek()) is not None
            and token.text in _POSTFIX
            and token.kind is ExpressionTokenKind.PUNCTUATOR
        ):
            self.at += 1
            self.deeper()
            if token.text == ".":
                expr = self.member(expr, first, token)
            elif token.text == "[":
                index = self.expression(0)
                self.closing("]", token)
                expr = Index(self.since(first), expr, index)
            elif token.text == "(":
                arguments = self.items(")", token)
                expr = Call(self.since(first), expr, arguments)
            else:
                message = f"`{token.text}` is not supported; use `<assign>` to change a variable"
                self.report(self.span(token), message, UNSUPPORTED)
                expr = ErrorExpr(self.since(first), (expr,))
        return expr

    def member(self, expr: Expr, first: int, dot: ExpressionToken) -> Expr:
        name = self.peek()
        if name is not None and name.kind is ExpressionTokenKind.NAME:
            self.at += 1
            return Member(self.since(first), expr, name.text, self.span(name))
        end = self.span(dot).end
        self.report(self.span(dot), "a name is missing after the `.`")
        return Member(self.since(first), expr, "", Span(end, end))

    def primary(self, token: ExpressionToken) -> Expr:
        span = self.span(token)
        if token.kind is ExpressionTokenKind.NAME:
            self.at += 1
            return self.word(token, span)
        if token.kind is ExpressionTokenKind.NUMBER:
            self.at += 1
            return self.number(token, span)
        if token.kind is ExpressionTokenKind.STRING:
            self.at += 1
            return String(span, _string_value(token.text[1:-1]))
        if token.text == "(":
            self.at += 1
            inner = self.expression(0)
            self.closing(")", token)
            return inner
        if token.text == "[":
            first = self.at
            self.at += 1
            elements = self.items("]", token)
            return ArrayLiteral(self.since(first), elements)
        if token.text == "{":
            return self.object(token)
        return self.no_operand(token, span)

    def word(self, token: ExpressionToken, span: Span) -> Expr:
        text, first = token.text, self.at - 1
        if text in _LITERALS:
            return Boolean(span, _LITERALS[text])
        if text in STATEMENTS:
            self.report(span, f"`{text}` is not supported: an expression is a single value", UNSUPPORTED)
            self.at = len(self.tokens)
            return ErrorExpr(span)
        if text == "this":
            self.report(span, "`this` is not supported; use the name of the variable", UNSUPPORTED)
            return ErrorExpr(span)
        following = self.peek()
        if text in PREFIXES:
            self.report(span, f"`{text}` is not supported in expressions", UNSUPPORTED)
            parts = (self.expression(UNARY_PRECEDENCE),) if following is not None else ()
            return ErrorExpr(self.since(first), parts)
        if text == "not" and following is not None and (following.kind in _OPERAND_KINDS or following.text == "("):
            self.written(token, "!")
            operand = self.expression(UNARY_PRECEDENCE)
            return Unary(self.since(first), UnaryOperator.NOT, operand)
        return Name(span, text)

    def no_operand(self, token: ExpressionToken, span: Span) -> Expr:
        self.deeper()
        if token.kind is ExpressionTokenKind.TEMPLATE:
            self.at += 1
            self.report(span, "template strings are not supported; write the string in single quotes", UNSUPPORTED)
        elif token.text == "~" or token.text in _STEPS:
            self.at += 1
            hint = _BITS if token.text == "~" else "use `<assign>` to change a variable"
            self.report(span, f"`{token.text}` is not supported: {hint}", UNSUPPORTED)
            return self.operand()
        elif token.kind is ExpressionTokenKind.JUNK:
            self.at += 1
            if token.text[0] in "\"'":
                return self.unclosed_string(token, span)
            self.report(span, f"`{token.text}` is not allowed in an expression; remove it")
            return self.operand() if self.peek() is not None else ErrorExpr(span)
        elif token.text in ("/", "/=") and (end := self.regular_expression()):
            span = span.cover(self.span(self.tokens[end - 1]))
            self.at = end
            self.report(span, "regular expressions are not supported; compare strings with `==`", UNSUPPORTED)
        else:
            return self.missing("a value")
        return ErrorExpr(span)

    def regular_expression(self) -> int:
        """The index of the token after the regular expression that begins at the current token; 0 if none begins
        there."""
        for at in range(self.at + 1, len(self.tokens)):
            if self.tokens[at].text == "/":
                flags = at + 1 < len(self.tokens) and self.tokens[at + 1].start == self.tokens[at].end
                return at + 2 if flags and self.tokens[at + 1].kind is ExpressionTokenKind.NAME else at + 1
        return 0

    def unclosed_string(self, token: ExpressionToken, span: Span) -> Expr:
        quote = token.text[0]
        opening = self.source.span(token.start, token.start + 1)
        written = quote if opening.end - opening.start == 1 else _QUOTES[quote]
        close = Fix(f"Insert `{quote}`", (TextEdit(Span(span.end, span.end), written),), preferred=False)
        self.report(span, f"the string has no closing `{quote}`", SYNTAX, close)
        return String(span, _string_value(token.text[1:]))

    def number(self, token: ExpressionToken, span: Span) -> Expr:
        following = self.peek()
        if following is not None and following.kind is ExpressionTokenKind.NAME and following.start == token.end:
            self.at += 1
            self.report(self.span(following), f"`{token.text}{following.text}` is neither a number nor a name")
        value = _number_value(token.text)
        if value is None:
            self.report(span, "the number is too large; the maximum is 1.8e308")
            return ErrorExpr(span)
        return Number(span, value, isinstance(value, float))

    def items(self, closer: str, opener: ExpressionToken) -> tuple[Expr, ...]:
        """Comma-separated expressions up to `closer`, which is consumed."""
        operands: list[Expr] = []
        while (token := self.peek()) is not None and token.text != closer:
            operands.append(self.expression(0))
            if not self.accept(","):
                break
        self.closing(closer, opener)
        return tuple(operands)

    def object(self, opener: ExpressionToken) -> Expr:
        members: list[ObjectMember] = []
        first = self.at
        self.at += 1
        while (key := self.peek()) is not None and key.text != "}":
            if key.kind not in (ExpressionTokenKind.STRING, ExpressionTokenKind.NAME, ExpressionTokenKind.NUMBER):
                self.report(self.span(key), "a member name in quotes is missing")
                break
            self.at += 1
            name = key.text[1:-1] if key.kind is ExpressionTokenKind.STRING else key.text
            if not self.accept(":"):
                self.report(self.span(key), f"`:` and a value are missing after `{key.text}`")
                value: Expr = ErrorExpr(Span(self.span(key).end, self.span(key).end))
            else:
                value = self.expression(0)
            members.append(ObjectMember(name, self.span(key), value))
            if not self.accept(","):
                break
        self.closing("}", opener)
        return ObjectLiteral(self.since(first), tuple(members))

    # --------------------------------------------------------------- helpers

    def peek(self) -> ExpressionToken | None:
        return self.tokens[self.at] if self.at < len(self.tokens) else None

    def accept(self, text: str) -> bool:
        token = self.peek()
        if token is not None and token.text == text and token.kind is ExpressionTokenKind.PUNCTUATOR:
            self.at += 1
            return True
        return False

    def closing(self, closer: str, opener: ExpressionToken) -> None:
        """Consume `closer` and superfluous tokens before it, or report that `opener` is never closed."""
        if self.accept(closer):
            return
        previous = self.span(self.tokens[self.at - 1]).end
        token = self.peek()
        if token is not None and token.text not in _CLOSERS:
            self.superfluous(token)
            self.skip_to_closer()
            if self.accept(closer):
                return
        insert = Fix(f"Insert `{closer}`", (TextEdit(Span(previous, previous), closer),), preferred=token is None)
        self.report(self.span(opener), f"`{opener.text}` is never closed with `{closer}`", SYNTAX, insert)

    def skip_to_closer(self) -> None:
        """Skip tokens up to the next closing bracket whose opening bracket precedes the current token."""
        opened = 0
        while (token := self.peek()) is not None:
            if token.text in _OPENERS:
                opened += 1
            elif token.text in _CLOSERS:
                if opened == 0:
                    break
                opened -= 1
            self.at += 1

    def missing(self, operand: str) -> Expr:
        """Report that `operand` is missing before the next token, or at the end."""
        token = self.peek()
        if token is not None:
            span = self.span(token)
            self.report(span, f"{operand} is missing before `{token.text[:20]}`")
            self.gap = token.start
            return ErrorExpr(Span(span.start, span.start))
        last = self.span(self.tokens[-1])
        self.report(last, f"{operand} is missing after `{self.tokens[-1].text[:20]}`")
        return ErrorExpr(Span(last.end, last.end))

    def deeper(self) -> None:
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise _TooDeepError

    def since(self, first: int) -> Span:
        """The span from token `first` to the last token that was read, or to the position where a part is missing."""
        return self.source.span(self.tokens[first].start, max(self.tokens[self.at - 1].end, self.gap))

    def span(self, token: ExpressionToken) -> Span:
        return self.source.span(token.start, token.end)

    def report(self, span: Span, message: str, code: str = SYNTAX, *fixes: Fix) -> None:
        if span not in self.reported and len(self.findings) < MAX_FINDINGS:
            self.reported.add(span)
            self.findings.append(Finding(code, span, message, fixes=fixes))


def _in_xml(symbol: str) -> str:
    """`symbol` with `&` and `<` escaped for XML."""
    return symbol.replace("&", "&amp;").replace("<", "&lt;")


def _number_value(text: str) -> int | float | None:
    """The value of a number, an int if it is whole and written without a point
    (docs/spec/expressions.md#number-literals); `None` if it is too large."""
    if text[:2] in ("0x", "0X"):
        value = int(text, 16)
    elif len(text) > 1 and text[0] == "0" and text.isdigit() and not set(text) & {"8", "9"}:
        value = int(text, 8)
    else:
        real = float(text)
        if "." in text or not real.is_integer():
            return real if math.isfinite(real) else None
        return int(text) if text.isdigit() else int(real)
    return value if value.bit_length() <= sys.float_info.max_exp else None


def _string_value(text: str) -> str:
    """The value of a string literal, given without its quotes."""
    value = _ESCAPE.sub(_resolve_escape, text)
    if _SURROGATE.search(value):
        return value.encode("utf-16", "surrogatepass").decode("utf-16", "replace")
    return value


def _resolve_escape(match: re.Match[str]) -> str:
    braced, four, two, single = match.groups()
    if digits := braced or four or two:
        code = int(digits, 16)
        return chr(code) if code <= 0x10FFFF else "\ufffd"
    return _ESCAPES.get(single, single)
