# SPDX-License-Identifier: Apache-2.0
"""Properties as text, in the notation of PRISM and Storm: `Pmax=? [ F<=100 done ]`, as JSON of a JANI property.

- `P=?` asks for the minimum, as properties in XML do; `P>=0.9` is about all schedulers, so it compares the minimum, and
  `P<=0.1` the maximum.
- A bound without a unit is one of steps, as in PRISM for models without real time. A bound with a unit (`F<=10 s`) is
  about the clock of a translated system.
- Names contain letters, digits, `_` and `.`; other names are written in double quotes. `"deadlock"` and `"init"` are
  the labels of PRISM.
- `[ F a || G b ]` is about the traces in which `G b` holds, as in Storm: `||` directly before `F`, `G` or `X` is not a
  disjunction.
- `F`, `G` and `X` apply to everything that follows, up to a `U`, `W`, `R` or a closing bracket, as in PRISM.
"""

from __future__ import annotations

from typing import Any, TypeAlias

from roaml.durations import UNITS
from roaml.jani.selection import PropertyError
from roaml.record import Record, replace
from roaml.regex import regex

Json: TypeAlias = Any

_TOKEN = regex(
    r"\s*(?:(?P<number>\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+(?:[eE][+-]?\d+)?)|(?P<quoted>\"[^\"]*\")"
    r"|(?P<name>[^\W\d][\w.]*)|(?P<mark><=>|=>|<=|>=|!=|==|&&|\|\||[-+*/()\[\]{},?:=<>&|!⇒⇔≤≥≠¬∧∨]))"
)
_SPELLINGS = {
    "&&": "&", "∧": "&", "||": "|", "∨": "|", "==": "=", "≠": "!=", "≤": "<=", "≥": ">=", "⇒": "=>", "⇔": "<=>",
    "¬": "!",
}  # fmt: skip
_JANI = {"&": "∧", "|": "∨", "=>": "⇒", "<=": "≤", ">=": "≥", "!=": "≠"}
_HEAD = regex(r"(?P<kind>[PR])(?P<extreme>min|max)?")
_FUNCTIONS = {
    "min": "min", "max": "max", "mod": "%", "pow": "pow", "log": "log", "floor": "floor", "ceil": "ceil",
}  # fmt: skip
_TIME = "time"
"""The reward that is the time of the model, in s."""
_GIVEN = "||"
"""The text of the token `||` that precedes the condition under which a property is asked."""
_ASKED = regex(r"(?:=\s*\?|[<>]=?\s*[\d.]+)\s*\[")
"""What a property in this notation contains, whatever it asks for."""
_OTHER_HEADS = {
    "T": 'the expected time is `R{"time"}min=? [ F … ]`',
    "E": 'an expected value is `R{…}min=? [ F … ]`, with the reward in braces, such as `"steps"` or `"time"`',
    "S": "probabilities in the long run are not supported",
}
"""The first letter of a property in the notations of other tools -> what to write instead."""
_TEMPORAL = frozenset("FGXUWR")
_BINARY_LEVELS = (("<=>",), ("=>",), ("|",), ("&",))
_RELATIONS = frozenset(("=", "!=", "<", "<=", ">", ">="))
_STEP_REWARD = "The steps are those of the model: each transition of an automaton is one."
_STEPS = "A bound without a unit counts steps of the model, not seconds; `F<=5 s` has one."
"""The remark on the bounds of a system with a clock."""
MAX_DEPTH = 100


class PropertyTextError(PropertyError):
    """Raised for a text that is not a property. The message contains the reason and the place."""


class _Token(Record, frozen=True):
    kind: str
    text: str
    start: int


class _Bound(Record, frozen=True):
    """A bound of a path operator: of the number of steps, or of the time in ns."""

    lower: Json | None
    upper: Json | None
    is_lower_exclusive: bool
    is_upper_exclusive: bool
    unit_ns: int


def is_property_text(text: str) -> bool:
    """Whether a text is meant as a property in this notation, and not as the name of one."""
    return "[" in text and (_HEAD.match(text.strip()) is not None or _ASKED.search(text) is not None)


class ReadProperty(Record, frozen=True):
    """A property as a value for JSON.

    Attributes:
        given: the probability of the path that the considered traces satisfy; `None` if all traces are considered.
        reward: the name in quotes that is the whole reward; "" if it is another expression.
        remark: what a reader of the text may mistake, in sentences: the unit of its value or of its bounds, and that
            it has a condition; "" for nothing.
    """

    expression: Json
    given: Json | None
    reward: str
    remark: str


def read_property_text(text: str, clock: tuple[str, str] | None = None) -> ReadProperty:
    """The JANI property that a text states.

    Args:
        clock: the variables with the seconds and nanoseconds of the time, for bounds with a unit.

    Raises:
        PropertyTextError: the text is not a property.
    """
    return _Parser(text, clock).property()


def _operation(symbol: str, left: Json, right: Json) -> Json:
    if symbol == "<=>":
        return _operation("&", _operation("=>", left, right), _operation("=>", right, left))
    return {"op": _JANI.get(symbol, symbol), "left": left, "right": right}


def _filter(function: str, values: Json) -> Json:
    return {"op": "filter", "fun": function, "values": values, "states": {"op": "initial"}}


def _at_reach(operator: str, value: Json, reach: Json) -> Json:
    """The expected value of an expression in the first state in which `reach` holds, as the sum of a reward that only
    the step to this state earns."""
    earned = {"op": "ite", "if": reach, "then": value, "else": 0}
    return {"op": operator, "exp": earned, "accumulate": ["steps"], "reach": reach}


def _negation(operand: Json) -> Json:
    return {"op": "¬", "exp": operand}


class _Parser:
    def __init__(self, text: str, clock: tuple[str, str] | None) -> None:
        self.text = text
        self.clock = clock
        self.tokens = list(_tokens(text))
        self.place = 0
        self.depth = 0
        self.remarks: list[str] = []

    # ------------------------------------------------------------ tokens

    @property
    def token(self) -> _Token:
        return self.tokens[self.place]

    def next(self) -> _Token:
        token = self.token
        self.place = min(self.place + 1, len(self.tokens) - 1)
        return token

    def takes(self, *marks: str) -> str:
        """The mark or word that follows, if it is one of these; "" otherwise."""
        token = self.token
        if token.text in marks and token.kind in ("mark", "name"):
            self.next()
            return token.text
        return ""

    def expect(self, mark: str) -> None:
        if not self.takes(mark):
            raise self.problem(f"expected `{mark}`")

    def problem(self, problem: str, instead: str = "") -> PropertyTextError:
        token = self.token
        where = f"before `{token.text}`" if token.text else "at the end"
        raise PropertyTextError(
            f"`{self.text.strip()}` is not a property: {problem} {where} (column {token.start + 1})"
            f"{'; ' if instead else ''}{instead}"
        )

    # ------------------------------------------------------------ properties

    def property(self) -> ReadProperty:
        head = self.next()
        match = _HEAD.fullmatch(head.text)
        if match is None:
            self.place = 0
            instead = _OTHER_HEADS.get(head.text.removesuffix("min").removesuffix("max"), "")
            raise self.problem("expected `P`, `Pmin`, `Pmax`, `R`, `Rmin` or `Rmax`", instead)
        is_reward, extreme = match["kind"] == "R", match["extreme"] or ""
        is_quoted = is_reward and self.tokens[self.place + 1].kind == "quoted"
        reward = self.reward() if is_reward else None
        extreme = self.takes("min", "max") or extreme
        relation, threshold = self.asked()
        if not extreme:
            extreme = "max" if relation in ("<", "<=") else "min"
        self.expect("[")
        value = self.expectation(f"E{extreme}", reward) if is_reward else {"op": f"P{extreme}", "exp": self.path()}
        begin = self.token.start + len(_GIVEN)
        given = self.path() if self.takes(_GIVEN) else None
        if given is not None:
            path = self.text[begin : self.token.start].strip()
            self.remarks.insert(
                0,
                f"Assumption: only traces that satisfy `{path}` count; `||` before F, G or X begins an assumption.",
            )
        self.expect("]")
        if self.token.text:
            raise self.problem("unexpected text")
        values = value if relation == "" else _operation(relation, value, threshold)
        function = "values" if relation == "" else "∀"
        condition = None if given is None else _filter("values", {"op": "Pmin", "exp": given})
        return ReadProperty(
            _filter(function, values), condition, str(reward) if is_quoted else "", " ".join(self.remarks)
        )

    def asked(self) -> tuple[str, Json]:
        """The comparison with a number; "" for `=?`."""
        relation = self.takes("=", "<", "<=", ">", ">=")
        if not relation:
            raise self.problem("expected `=?`, or a comparison such as `>=0.9`,")
        if relation == "=" and self.takes("?"):
            return "", None
        return relation, self.sum()

    def reward(self) -> Json:
        """The reward in braces: an expression, `"steps"` or `"time"`. Another text in quotes is the name of a
        variable."""
        if not self.takes("{"):
            raise self.problem('expected the reward in braces, such as `R{"steps"}`,')
        reward = 1 if self.token.text in ("steps", '"steps"') and self.next() else self.formula()
        self.expect("}")
        return reward

    def expectation(self, operator: str, reward: Json) -> Json:
        accumulate = ["steps"] if reward == 1 else ["steps", "exit"]
        if reward == 1:
            self.remarks.append(_STEP_REWARD)
        value = {"op": operator, "exp": reward, "accumulate": accumulate}
        if self.takes("C"):
            self.expect("<=")
            number, unit = self.sum(), self.unit()
            if unit == 0:
                return {**value, "step-instant": number}
            return {**value, "reach": self.since(number, unit)}
        if self.takes("I"):
            self.expect("=")
            number, unit = self.sum(), self.unit()
            if unit == 0:
                return {"op": operator, "exp": reward, "step-instant": number}
            return _at_reach(operator, reward, self.since(number, unit))
        if not self.takes("F"):
            raise self.problem("expected `F`, `C<=` or `I=` in a reward")
        reach = self.formula()
        if reward != _TIME:
            return {**value, "reach": reach}
        seconds, nanoseconds = self.known_clock()
        self.remarks.append("The time is in s.")
        fraction = {"op": "/", "left": nanoseconds, "right": 10**9}
        return _at_reach(operator, {"op": "+", "left": seconds, "right": fraction}, reach)

    def since(self, number: Json, unit_ns: int) -> Json:
        """The condition that the clock shows at least a number of time units."""
        self.known_clock()
        return self.compared(">=", number, unit_ns)

    def known_clock(self) -> tuple[str, str]:
        if self.clock is None:
            raise PropertyTextError(
                f"`{self.text.strip()}` is about the time of the model, but the model has no clock; count steps instead"
            )
        return self.clock

    # ------------------------------------------------------------ paths

    def path(self) -> Json:
        """A path formula: unary operators, then at most one binary operator."""
        left = self.unary_path()
        operator = self.takes("U", "W", "R")
        if not operator:
            return left
        bound = self.bound()
        right = self.unary_path()
        return self.bounded(operator, left, right, bound)

    def unary_path(self) -> Json:
        operator = self.takes("F", "G", "X")
        if not operator:
            return self.formula()
        bound = self.bound()
        self.enter()
        operand = self.unary_path()
        self.depth -= 1
        if bound is None:
            return {"op": operator, "exp": operand}
        if operator == "X":
            raise self.problem("`X` has no bound")
        return self.bounded(operator, None, operand, bound)

    def bounded(self, operator: str, left: Json | None, right: Json, bound: _Bound | None) -> Json:
        if bound is None:
            return {"op": operator, "left": left, "right": right}
        if bound.unit_ns == 0:
            if self.clock is not None and _STEPS not in self.remarks:
                self.remarks.append(_STEPS)
            interval: Json = {}
            if bound.lower is not None:
                interval["lower"] = bound.lower
                if bound.is_lower_exclusive:
                    interval["lower-exclusive"] = True
            if bound.upper is not None:
                interval["upper"] = bound.upper
                if bound.is_upper_exclusive:
                    interval["upper-exclusive"] = True
            operands = {"exp": right} if left is None else {"left": left, "right": right}
            return {"op": operator, **operands, "step-bounds": interval}
        within = self.within(bound)
        match operator:
            case "F":
                return {"op": "F", "exp": _operation("&", right, within)}
            case "G":
                return {"op": "G", "exp": _operation("=>", within, right)}
            case "U":
                return {"op": "U", "left": left, "right": _operation("&", right, within)}
        raise self.problem(f"`{operator}` has no bound on time")

    def bound(self) -> _Bound | None:
        """The bound after a path operator; `None` if there is none."""
        if self.takes("["):
            lower = self.sum()
            self.expect(",")
            upper = self.sum()
            self.expect("]")
            return _Bound(lower, upper, False, False, self.unit())
        relation = self.takes("<=", "<", ">=", ">")
        if not relation:
            return None
        number = self.atom()
        is_upper, is_exclusive = relation[0] == "<", len(relation) == 1
        lower, upper = (None, number) if is_upper else (number, None)
        return _Bound(lower, upper, is_exclusive and not is_upper, is_exclusive and is_upper, self.unit())

    def unit(self) -> int:
        """The unit of a bound on time in ns; 0 if the bound is one of steps."""
        unit = self.takes(*UNITS)
        return UNITS.get(unit, 0)

    def within(self, bound: _Bound) -> Json:
        """The condition that the time of the model is within a bound."""
        if self.clock is None:
            raise PropertyTextError(
                f"`{self.text.strip()}` has a bound on time, but the model has no clock; leave out the unit to "
                "count steps"
            )
        parts = []
        if bound.upper is not None:
            parts.append(self.compared("<" if bound.is_upper_exclusive else "<=", bound.upper, bound.unit_ns))
        if bound.lower is not None:
            parts.append(self.compared(">" if bound.is_lower_exclusive else ">=", bound.lower, bound.unit_ns))
        return parts[0] if len(parts) == 1 else _operation("&", *parts)

    def compared(self, relation: str, number: Json, unit_ns: int) -> Json:
        """A comparison of the time of the model with a number of time units."""
        assert self.clock is not None
        if not isinstance(number, (int, float)):
            raise PropertyTextError(f"`{self.text.strip()}`: the bound on time must be a number")
        seconds, nanoseconds = divmod(round(number * unit_ns), 10**9)
        second, nanosecond = self.clock
        strict = relation[0]
        same = _operation("&", _operation("=", second, seconds), _operation(relation, nanosecond, nanoseconds))
        return _operation("|", _operation(strict, second, seconds), same)

    # ------------------------------------------------------------ formulas

    def enter(self) -> None:
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise PropertyTextError("the property is nested too deeply")

    def formula(self, level: int = 0) -> Json:
        """A formula whose operators bind at least as strongly as a level."""
        if level == len(_BINARY_LEVELS):
            return self.negated()
        self.enter()
        left = self.formula(level + 1)
        while operator := self.takes(*_BINARY_LEVELS[level]):
            # `=>` is right-associative.
            right = self.formula(level if operator == "=>" else level + 1)
            left = _operation(operator, left, right)
        self.depth -= 1
        return left

    def negated(self) -> Json:
        if self.takes("!"):
            self.enter()
            operand = self.negated()
            self.depth -= 1
            return _negation(operand)
        if self.token.kind == "name" and self.token.text in ("F", "G", "X"):
            return self.unary_path()
        left = self.sum()
        if self.token.kind == "mark" and self.token.text in _RELATIONS:
            relation = self.next().text
            return _operation(relation, left, self.sum())
        return left

    def sum(self) -> Json:
        left = self.product()
        while operator := self.takes("+", "-"):
            left = {"op": operator, "left": left, "right": self.product()}
        return left

    def product(self) -> Json:
        left = self.atom()
        while operator := self.takes("*", "/"):
            left = {"op": operator, "left": left, "right": self.atom()}
        return left

    def atom(self) -> Json:
        token = self.next()
        if token.kind == "number":
            return float(token.text) if any(mark in token.text for mark in ".eE") else int(token.text)
        if token.text == "-":
            operand = self.atom()
            return -operand if isinstance(operand, (int, float)) else {"op": "-", "left": 0, "right": operand}
        if token.text == "(":
            self.enter()
            inner = self.path()
            self.depth -= 1
            self.expect(")")
            return inner
        if token.kind == "quoted":
            name = token.text[1:-1]
            return {"op": {"init": "initial"}.get(name, name)} if name in ("deadlock", "init") else name
        if token.kind == "name" and token.text not in _TEMPORAL:
            if token.text in _FUNCTIONS and self.takes("("):
                return self.call(token.text)
            return {"true": True, "false": False}.get(token.text, token.text)
        self.place -= 1 if token.text else 0
        raise self.problem("expected a variable, a number or a bracket")

    def call(self, name: str) -> Json:
        arguments = [self.formula()]
        while self.takes(","):
            arguments.append(self.formula())
        self.expect(")")
        symbol = _FUNCTIONS[name]
        if name in ("floor", "ceil"):
            if len(arguments) == 1:
                return {"op": symbol, "exp": arguments[0]}
        elif name in ("min", "max"):
            result = arguments[0]
            for argument in arguments[1:]:
                result = {"op": symbol, "left": result, "right": argument}
            return result
        elif len(arguments) == 2:
            return {"op": symbol, "left": arguments[0], "right": arguments[1]}
        raise self.problem(f"`{name}` has a wrong number of arguments")


def _tokens(text: str) -> list[_Token]:
    tokens = []
    place = 0
    while text[place:].strip():
        match = _TOKEN.match(text, place)
        if match is None:
            start = len(text) - len(text[place:].lstrip())
            raise PropertyTextError(f"`{text.strip()}` is not a property: unknown character (column {start + 1})")
        kind = match.lastgroup or ""
        word = match[kind]
        tokens.append(_Token(kind, _SPELLINGS.get(word, word) if kind == "mark" else word, match.start(kind)))
        place = match.end()
    tokens.append(_Token("end", "", len(text)))
    return [
        replace(token, text=_GIVEN) if _is_given(text, token, after) else token
        for token, after in zip(tokens, [*tokens[1:], tokens[-1]], strict=True)
    ]


def _is_given(text: str, token: _Token, after: _Token) -> bool:
    """Whether a token is `||` before a path, which is not a disjunction."""
    is_double = token.kind == "mark" and text.startswith(_GIVEN, token.start)
    return is_double and after.kind == "name" and after.text in ("F", "G", "X")
