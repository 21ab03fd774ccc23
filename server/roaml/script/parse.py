# SPDX-License-Identifier: Apache-2.0
"""Parser of scripts, by operator precedence (Pratt 1973), for any text (docs/spec/scripts.md#grammar).

- It never raises: each syntax error is a `ScriptProblem` with a place, and the tree contains an `ErrorExpr` there.
- It reports at most one problem in each statement: after an error it skips to the next `;`.
- It takes linear time and recurses at most `MAX_DEPTH` levels deep.
"""

from __future__ import annotations

import enum
import re

from roaml.exhaustive import Vocabulary
from roaml.record import Record, replace
from roaml.regex import regex
from roaml.script.tree import (
    Assignment,
    Binary,
    Boolean,
    Comparison,
    Conditional,
    ErrorExpr,
    Expr,
    Name,
    Number,
    Script,
    String,
    Unary,
)
from roaml.text import Decoded, Span

MAX_DEPTH = 150
"""The maximum nesting depth of a script."""

MAX_PROBLEMS = 20
"""The maximum number of errors that are reported in one script."""

_INT64 = range(-(2**63), 2**63)

ASSIGNMENTS = (":=", "=", "+=", "-=", "*=", "/=")
COMPARISONS = ("==", "!=", "<", ">", "<=", ">=")
UNARY = ("-", "~", "!")
BINARY = {
    "*": 9, "/": 9, "+": 8, "-": 8, "..": 8, "&": 7, "|": 6, "^": 6, "&&": 4, "||": 3,
}  # fmt: skip
"""The precedences of the binary operators except comparisons, whose precedence is 5."""
BINARY_BEFORE_4_9 = {**BINARY, "||": 4}
_RIGHT_BEFORE_4_9 = ("*", "/", "+", "-")
"""The operators that were right-associative before version 4.9."""
_FAMILIES = (
    ("arithmetic", ("*", "/", "+", "-")),
    ("operators on bits", ("&", "|", "^", "~", "!")),
    ("`..`", ("..",)),
)
"""The operators that could not be mixed without brackets before version 4.9, and how messages name them."""

_COMPARISON, _CONDITIONAL, _ASSIGNMENT = 5, 2, 1

_TOKEN = regex(
    r"""(?P<space>\s+)
      | (?P<number>0[xX][0-9A-Fa-f]+ | [0-9]+(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?)
      | (?P<name>[A-Za-z_@][A-Za-z0-9_]*)
      | (?P<string>'[^']*')
      | (?P<strange>\+\+|<<|>>|[=!]==)
      | (?P<operator>:=|[-+*/=!<>]=|&&|\|\||\.\.|[-+*/~!&|^<>?:=();])
      | (?P<junk>'[^']*|"[^"]*"?|[0-9.]+|[^\s\w@'"]+?(?=[\s\w@'"();]|\Z)|.)
    """,
    re.VERBOSE | re.DOTALL | re.ASCII,
)

_INSTEAD = {
    "%": "the script language does not support remainders",
    "++": "write `+= 1`",
    "<<": "the script language does not support shifts",
    ">>": "the script language does not support shifts",
    "===": "write `==`",
    "!==": "write `!=`",
}
_BEFORE = "versions of BehaviorTree.CPP before 4.9"
_WORDS = {"and": "&&", "or": "||", "not": "!"}


class ScriptGrammar(enum.Enum):
    """The grammar of scripts, which depends on the version of BehaviorTree.CPP (docs/spec/scripts.md#before)."""

    CURRENT = "4.9 and newer"
    BEFORE_4_9 = "before 4.9"


class ScriptProblem(Record, frozen=True):
    """An error in a script.

    Attributes:
        replacement: the text that was probably intended instead of the text in `span`, or "".
        number: the name that must be a number for the operator in `operator`, but is a string; "" in other errors.
    """

    span: Span
    message: str
    replacement: str = ""
    number: str = ""
    operator: str = ""


class _TokenKind(Vocabulary):
    """The kind of a token. The values, except that of `END`, are names of groups in `_TOKEN`."""

    NUMBER = "number"
    NAME = "name"
    STRING = "string"
    OPERATOR = "operator"
    JUNK = "junk"
    END = "end"


_KINDS = {**{kind.value: kind for kind in _TokenKind}, "strange": _TokenKind.JUNK}


class _Token(Record, frozen=True):
    """A token of a script. `start` and `end` are offsets in the decoded text."""

    kind: _TokenKind
    text: str
    start: int
    end: int


class _ScriptError(Exception):
    """Raised for a syntax error in a statement, whose remaining text is then skipped; never leaves this module."""

    def __init__(self, token: _Token, message: str, replacement: str = "") -> None:
        super().__init__(message)
        self.token = token
        self.message = message
        self.replacement = replacement


def parse(source: Decoded, grammar: ScriptGrammar = ScriptGrammar.CURRENT) -> tuple[Script, tuple[ScriptProblem, ...]]:
    """The script in a text, and its syntax errors, at most `MAX_PROBLEMS`."""
    return _Parser(source, grammar).script()


def _tokens(text: str) -> list[_Token]:
    tokens = [
        _Token(_KINDS[match.lastgroup or "junk"], match[0], *match.span())
        for match in _TOKEN.finditer(text)
        if match.lastgroup != "space"
    ]
    return [*tokens, _Token(_TokenKind.END, "", len(text), len(text))]


class _Parser:
    def __init__(self, source: Decoded, grammar: ScriptGrammar) -> None:
        self.source = source
        self.is_old = grammar is ScriptGrammar.BEFORE_4_9
        self.precedences = BINARY_BEFORE_4_9 if self.is_old else BINARY
        self.family = ""
        """Before version 4.9: the family of the operators that were read since the last bracket."""
        self.tokens = _tokens(source.text)
        self.at = 0
        self.depth = 0
        self.height = 0
        """The height of the tree of the expression that was read last."""
        self.problems: list[ScriptProblem] = []

    @property
    def token(self) -> _Token:
        return self.tokens[self.at]

    def span(self, start: _Token, end: _Token | None = None) -> Span:
        return self.source.span(start.start, (end or start).end)

    def since(self, start: _Token) -> Span:
        """The span from a token to the one that was read last."""
        return self.source.span(start.start, max(start.end, self.tokens[self.at - 1].end))

    def next(self) -> _Token:
        token = self.token
        if token.kind is not _TokenKind.END:
            self.at += 1
        return token

    def is_at_end(self) -> bool:
        return self.token.kind is _TokenKind.END

    def takes(self, *texts: str) -> bool:
        if self.token.kind is _TokenKind.OPERATOR and self.token.text in texts:
            self.at += 1
            return True
        return False

    # ------------------------------------------------------------ statements

    def script(self) -> tuple[Script, tuple[ScriptProblem, ...]]:
        span = self.source.span(0, len(self.source.text))
        statements: list[Expr] = []
        if self.token.kind is _TokenKind.END:
            self.problems.append(ScriptProblem(span, "the script is empty"))
        elif self.token.text == ";":
            self.problems.append(ScriptProblem(self.span(self.token), "a script cannot begin with `;`"))
        while not self.is_at_end():
            if self.is_old and statements:
                self.separator()
            if not self.takes(";") and not self.is_at_end():
                statements.append(self.statement())
        return Script(span, tuple(statements)), tuple(self.problems[:MAX_PROBLEMS])

    def separator(self) -> None:
        """Read the `;` between two statements, which versions before 4.9 require. They allow no `;` after the last
        statement."""
        token = self.token
        if not self.takes(";"):
            self.problems.append(ScriptProblem(self.span(token), f"{_BEFORE} require a `;` before `{token.text}`"))
        elif self.is_at_end() or self.token.text == ";":
            self.problems.append(
                ScriptProblem(self.span(token), f"{_BEFORE} require a statement after each `;`; remove this `;`")
            )

    def statement(self) -> Expr:
        start = self.token
        self.depth = 0
        self.family = ""
        try:
            expr = self.expression(_ASSIGNMENT)
            if self.token.text in (")", ":") or self.token.kind is _TokenKind.JUNK or self._begins_nothing():
                raise self.unexpected()
        except _ScriptError as error:
            place = error.token
            self.problems.append(ScriptProblem(self.span(place), error.message, error.replacement))
            while self.token.kind is not _TokenKind.END and self.token.text != ";":
                self.at += 1
            return ErrorExpr(self.since(start))
        return expr

    def _begins_nothing(self) -> bool:
        """Whether the next token can neither continue this statement nor begin another one."""
        token = self.token
        return token.kind is _TokenKind.OPERATOR and token.text not in (";", "(", *UNARY)

    def unexpected(self) -> _ScriptError:
        token = self.token
        text = token.text
        if token.kind is _TokenKind.END:
            return _ScriptError(token, "the script ends where a value is expected")
        if token.kind is _TokenKind.JUNK:
            return self._junk(token)
        if text in ASSIGNMENTS:
            return _ScriptError(token, f"`{text}` needs the name of an entry on its left")
        if text == ")":
            return _ScriptError(
                token, "this `)` closes no bracket; remove it" if self.depth <= 1 else "a value is missing before `)`"
            )
        if text == ":":
            return _ScriptError(token, "this `:` has no `?`; write `condition ? a : b`")
        return _ScriptError(token, f"a value is missing before `{text}`")

    def _junk(self, token: _Token) -> _ScriptError:
        text = token.text
        if text.startswith('"'):
            plain = text.strip('"')
            return _ScriptError(token, "a string needs single quotes", "" if "'" in plain else f"'{plain}'")
        if text.startswith("'"):
            return _ScriptError(token, "the string has no closing `'`")
        if text[0] in "0123456789.":
            return _ScriptError(token, f"`{text}` is not a number: a point needs digits on both sides")
        why = _INSTEAD.get(text)
        return _ScriptError(
            token,
            f"the script language does not support `{text}`" if why is None else f"unknown operator `{text}`: {why}",
        )

    # ----------------------------------------------------------- expressions

    def expression(self, least: int) -> Expr:
        """An expression whose operators have at least the precedence `least`."""
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise self._too_deep()
        start = self.token
        left = self.operand()
        while (strength := self._strength()) is not None and strength >= least:
            height = self.height
            left = self._operation(start, left, strength)
            self._grow(max(height, self.height))
        self.depth -= 1
        return left

    def _grow(self, height: int) -> None:
        """Set the height of the expression that was read last. `height` is that of its highest part."""
        self.height = height + 1
        if self.height > MAX_DEPTH:
            raise self._too_deep()

    def _too_deep(self) -> _ScriptError:
        return _ScriptError(self.token, f"the script is nested more than {MAX_DEPTH} levels deep")

    def _strength(self) -> int | None:
        token = self.token
        if token.kind is not _TokenKind.OPERATOR:
            return None
        if token.text in self.precedences:
            return self.precedences[token.text]
        if token.text in COMPARISONS:
            return _COMPARISON
        if token.text == "?":
            return _CONDITIONAL
        return _ASSIGNMENT if token.text in ASSIGNMENTS else None

    def _operation(self, start: _Token, left: Expr, strength: int) -> Expr:
        operator = self.token
        if strength == _ASSIGNMENT:
            if not isinstance(left, Name):
                raise self.unexpected()
            self.at += 1
            value = self.expression(_CONDITIONAL if self.is_old else _ASSIGNMENT)
            self.refuse_chain(*ASSIGNMENTS)
            return Assignment(self.since(start), operator.text, self.span(operator), left, value)
        self.at += 1
        if strength == _CONDITIONAL:
            family, self.family = self.family, ""
            yes = self.expression(_CONDITIONAL)
            self.family = family
            height = self.height
            if not self.takes(":"):
                raise _ScriptError(self.token, "`?` needs a `:` with the other value")
            no = self.expression(_CONDITIONAL + self.is_old)
            self.refuse_chain("?")
            self.height = max(height, self.height)
            return Conditional(self.since(start), left, yes, no)
        if strength == _COMPARISON:
            operators, operands = [operator.text], [left, self.expression(_COMPARISON + 1)]
            while self.token.kind is _TokenKind.OPERATOR and self.token.text in COMPARISONS:
                height = self.height
                operators.append(self.next().text)
                operands.append(self.expression(_COMPARISON + 1))
                self.height = max(height, self.height)
            return Comparison(self.since(start), tuple(operators), self.span(operator), tuple(operands))
        self.enter_family(operator)
        is_right = self.is_old and operator.text in _RIGHT_BEFORE_4_9
        right = self.expression(strength if is_right else strength + 1)
        return Binary(self.since(start), operator.text, self.span(operator), left, right)

    def refuse_chain(self, *operators: str) -> None:
        """Report an operator that cannot follow another one of its kind before version 4.9."""
        if self.is_old and self.token.kind is _TokenKind.OPERATOR and self.token.text in operators:
            raise _ScriptError(self.token, f"{_BEFORE} allow a second `{self.token.text}` only in brackets")

    def enter_family(self, operator: _Token) -> None:
        """Record the family of an operator. Before version 4.9, an expression without brackets has operators of at most
        one family."""
        family = next((name for name, operators in _FAMILIES if operator.text in operators), "")
        if self.is_old and family and self.family not in ("", family):
            message = f"{_BEFORE} cannot mix `{operator.text}` with {self.family}; use brackets"
            raise _ScriptError(operator, message)
        self.family = family or self.family

    def operand(self) -> Expr:
        token = self.token
        if token.kind is _TokenKind.OPERATOR and token.text in UNARY:
            return self._unary()
        if token.kind is _TokenKind.OPERATOR and token.text == "(":
            self.at += 1
            family, self.family = self.family, ""
            inner = self.expression(_ASSIGNMENT)
            self.family = family
            if not self.takes(")"):
                raise _ScriptError(token, "this `(` is never closed")
            return inner
        self.height = 1
        match token.kind:
            case _TokenKind.NUMBER:
                return self._number()
            case _TokenKind.NAME:
                self.at += 1
                if token.text in ("true", "false"):
                    return Boolean(self.span(token), token.text == "true")
                return self._name(token)
            case _TokenKind.STRING:
                self.at += 1
                return String(self.span(token), token.text[1:-1])
        raise self.unexpected()

    def _unary(self) -> Expr:
        token = self.next()
        self.enter_family(token)
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise self._too_deep()
        operand = self.operand()
        self.depth -= 1
        self._grow(self.height)
        return Unary(self.since(token), token.text, operand)

    def _name(self, token: _Token) -> Expr:
        if token.text == "@":
            raise _ScriptError(token, "`@` must be followed by the name of an entry of the root blackboard")
        follows = self.token
        if token.text in _WORDS and follows.kind in (_TokenKind.NAME, _TokenKind.NUMBER, _TokenKind.STRING):
            raise _ScriptError(
                token, f"`{token.text}` is not an operator; write `{_WORDS[token.text]}`", _WORDS[token.text]
            )
        if follows.text == "(" and follows.start == token.end and token.text not in _WORDS:
            raise _ScriptError(token, f"the script language has no functions, so `{token.text}(` is not a call")
        return Name(self.span(token), token.text)

    def _number(self) -> Expr:
        token = self.next()
        follows = self.token
        if (
            follows.start == token.end
            and follows.kind in (_TokenKind.NAME, _TokenKind.NUMBER, _TokenKind.JUNK)
            and follows.text[0] != '"'
        ):
            word = replace(token, text=token.text + follows.text, end=follows.end)
            self.at += 1
            raise _ScriptError(word, f"`{word.text}` is neither a number nor a name")
        text = token.text
        if text[:2] in ("0x", "0X"):
            value: int | float = int(text, 16)
        elif text.isdigit():
            if len(text) > 20:
                raise _ScriptError(token, f"`{text[:20]}…` does not fit into 64 bits")
            value = int(text)
        else:
            value = float(text)
        if isinstance(value, int) and value not in _INT64:
            raise _ScriptError(token, f"`{text}` does not fit into 64 bits")
        return Number(self.span(token), value)
