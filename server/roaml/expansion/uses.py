# SPDX-License-Identifier: Apache-2.0
"""The places of a document that use parameters, and the texts that replace them (docs/spec/parameters.md#uses).

- In expressions, constants and numbers, the name of a parameter is replaced by its value.
- In any other attribute, in scripts and in texts, `$(var NAME)` is replaced, as in launch files of ROS 2.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from roaml.diagnostics import Fix
from roaml.expansion.declarations import PARAM, PARAMETER, SECTIONS
from roaml.expansion.problems import ExpansionProblem, Problems
from roaml.expansion.values import Content, ParameterValue, Scope, evaluate, number_text
from roaml.expr.operators import Operator
from roaml.expr.parse import parse
from roaml.expr.tree import Binary, Expr, Index, Member, Number, children, walk
from roaml.expr.tree import Name as NameExpr
from roaml.expr.types import ScalarKind
from roaml.language import BEHAVIOR_TREE, Grammar
from roaml.language.grammar import ElementType
from roaml.record import Record
from roaml.regex import regex
from roaml.roles import ValueRole
from roaml.suggest import close_names, did_you_mean
from roaml.text import Decoded, Span, TextEdit
from roaml.xml_syntax import Attribute, Document, Element

VARIABLE = regex(r"\$\(var\s+([^\s()]*)\s*\)")
"""The substitution `$(var NAME)`."""

_DIMENSION = regex(r"\[([^\[\]]*)\]")
_EXPRESSIONS = (ValueRole.EXPRESSION, ValueRole.CONSTANT, ValueRole.LOCATION)
_PLAIN_NUMBER = regex(r"\s*[-+]?[\d.]*([eE][-+]?\d+)?\s*\Z")


class ParameterUse(Record, frozen=True):
    """A use of a parameter. `span` is that of its name."""

    name: str
    span: Span


def uses_in(document: Document, attribute: Attribute, names: Iterable[str]) -> Iterator[ParameterUse]:
    """The uses of the parameters `names` in a constant expression, or in a text with `$(var NAME)`."""
    known = frozenset(names)
    decoded = document.decoded(attribute.value_span)
    if "$(var" in decoded.text:
        for match in VARIABLE.finditer(decoded.text):
            if match[1] in known:
                yield ParameterUse(match[1], decoded.span(*match.span(1)))
        return
    tree, _ = parse(decoded)
    yield from (ParameterUse(n.name, n.span) for n in names_in(tree) if n.name in known)


class ParameterUses:
    """The uses of parameters in one document, with the edits that replace them.

    Args:
        scope: the parameters that the document can use.
        problems: receives the uses of undeclared parameters.
        own: the names of the parameters that the document declares itself.
    """

    def __init__(
        self, document: Document, grammar: Grammar | None, scope: Scope, problems: Problems, own: frozenset[str]
    ) -> None:
        self.document = document
        self.scope = scope
        self.edits: list[TextEdit] = []
        self.uses: list[ParameterUse] = []
        self.hidden: set[str] = set()
        self._problems = problems
        self._own = own
        if document.root is not None:
            self._element(document.root, grammar, grammar.elements.get(document.root.name) if grammar else None, scope)

    # ------------------------------------------------------------- elements

    def _element(self, element: Element, grammar: Grammar | None, type_: ElementType | None, scope: Scope) -> None:
        inner = self._inside(element, scope)
        for attribute in element.attributes:
            role = type_.attributes.get(attribute.name) if type_ else None
            if attribute.has_value:
                decoded = self.document.decoded(attribute.value_span)
                if (element.name, attribute.name) in _RATES:
                    self._check_rate(decoded, attribute)
                self._text(decoded, attribute.value_span, role.value if role else None, inner, attribute)
        if type_ is not None and type_.value is not None and element.find("bt_get_input") is None:
            content = self.document.content(element)
            if content is not None:
                self._text(content, content.span(0, len(content.text)), type_.value, inner, None)
        for child in element.elements:
            is_setting = child.name == PARAM and element.name == "input"  # a `<param>` of a `<send>` uses parameters
            if (is_setting or child.name in (PARAMETER, SECTIONS[0])) and grammar is not BEHAVIOR_TREE:
                continue  # their values are read elsewhere
            child_type = None
            if grammar is not None and not child.is_foreign:
                child_type = (type_.local.get(child.name) if type_ else None) or grammar.elements.get(child.name)
            self._element(child, grammar, child_type, inner)

    def _inside(self, element: Element, scope: Scope) -> Scope:
        """The parameters that the content of an element can use: those that no variable of the chart hides."""
        models = [child for child in element.elements if child.name == "datamodel"]
        hidden = {data.get("id"): data for model in models for data in model.elements if data.name == "data"}
        names = {attribute.value.strip(): attribute for attribute in hidden if attribute is not None}
        for name, attribute in names.items():
            if name in scope and name not in self.hidden:
                self.hidden.add(name)
                where = "this file" if name in self._own else "the system"
                message = (
                    f"the variable `{name}` hides the parameter `{name}` of {where}, so the parameter has no effect "
                    "here; rename the variable, or remove it to use the parameter"
                )
                self._problems.add(ExpansionProblem.HIDDEN, attribute.value_span, message)
        return {name: value for name, value in scope.items() if name not in names} if names else scope

    # ---------------------------------------------------------------- texts

    def _text(
        self, decoded: Decoded, span: Span, role: ValueRole | None, scope: Scope, attribute: Attribute | None
    ) -> None:
        if "$(var" in decoded.text:
            self._substitute(decoded, span, role, scope, attribute)
        elif role in _EXPRESSIONS:
            self._expression(decoded, span, role, scope, attribute)
        elif role is ValueRole.NUMBER:
            if not _PLAIN_NUMBER.match(decoded.text):
                self._number(decoded, span, self.scope, attribute)  # variables are not possible here
        elif role is ValueRole.TYPE and "[" in decoded.text:
            for match in _DIMENSION.finditer(decoded.text):
                if match[1].strip() and not match[1].strip().isdecimal():
                    part = decoded.part(*match.span(1))
                    self._number(part, part.span(0, len(part.text)), self.scope, attribute)

    def _substitute(
        self, decoded: Decoded, span: Span, role: ValueRole | None, scope: Scope, attribute: Attribute | None
    ) -> None:
        """Replace `$(var NAME)`. In an expression, a string is inserted as a literal, and inside a literal as its
        characters."""
        is_expression = role in _EXPRESSIONS

        def replaced(match: re.Match[str]) -> str:
            name = match[1]
            value = scope.get(name) or self.scope.get(name)
            place = decoded.span(match.start(1), match.end(1))
            if value is None:
                self._unknown(name, place)
                return match[0]
            self.uses.append(ParameterUse(name, place))
            if not is_expression:
                return value.text
            return value.inside_literal if _is_in_literal(decoded.text, match.start()) else value.literal

        matches = list(VARIABLE.finditer(decoded.text))
        text = VARIABLE.sub(replaced, decoded.text)
        if is_expression or role is ValueRole.NUMBER or role is ValueRole.TYPE:
            text = self._rest(text, role, scope)
            self._edit(span, text, attribute)
            return
        for match in matches:
            name = match[1]
            value = scope.get(name) or self.scope.get(name)
            if value is not None:
                self._edit(decoded.span(*match.span()), value.text, attribute)

    def _rest(self, text: str, role: ValueRole | None, scope: Scope) -> str:
        """The text of an expression, number or type in which `$(var NAME)` has been replaced, with its names replaced
        as well."""
        inner = _Plain(text, scope)
        if role is ValueRole.NUMBER:
            return inner.number() or text
        if role is ValueRole.TYPE:
            return _DIMENSION.sub(lambda m: f"[{_Plain(m[1], scope).number() or m[1]}]", text)
        return inner.constant() if role is ValueRole.CONSTANT else inner.expression()

    def _expression(
        self, decoded: Decoded, span: Span, role: ValueRole, scope: Scope, attribute: Attribute | None
    ) -> None:
        if not any(name in decoded.text for name in scope):
            return
        tree, _ = parse(decoded)
        names = [n for n in names_in(tree) if n.name in scope]
        if role is ValueRole.LOCATION and (root := _root(tree)) is not None and root.name in scope:
            message = (
                f"`{root.name}` is a parameter, so it cannot be assigned; declare a variable with `<data>` and the "
                f"initial value `{root.name}`"
            )
            self._problems.add(ExpansionProblem.ASSIGNED, root.span, message)
            names = [n for n in names if n is not root]
        if not names:
            return
        self.uses += (ParameterUse(n.name, n.span) for n in names)
        if role is ValueRole.CONSTANT and (whole := evaluate(tree, scope)) is not None:
            self._edit(span, _literal(tree, whole, scope, is_whole=True), attribute)
            return
        for part, literal in _folded(tree, scope):
            self._edit(part.span, literal, attribute)

    def _number(self, decoded: Decoded, span: Span, scope: Scope, attribute: Attribute | None) -> None:
        unit = _UNIT.search(decoded.text)
        number = decoded.part(0, unit.start()) if unit else decoded
        tree, findings = parse(number)
        uses = [n for n in names_in(tree) if n.name in scope]
        if findings or not uses:
            return
        self.uses += (ParameterUse(n.name, n.span) for n in uses)
        value = evaluate(tree, scope)
        if value is not None and not isinstance(value, (str, bool)):
            text = number_text(value, is_real=False)
            self._edit(span, text + (unit[0] if unit else ""), attribute)

    def _check_rate(self, decoded: Decoded, attribute: Attribute) -> None:
        """Report a parameter that is a time, as its name says, and is used as a rate, and the inverse of a rate."""
        tree, _ = parse(decoded)
        match tree:
            case NameExpr(name=name) if _is_time(name):
                message, meant = f"`{name}` is a time, as its name says, but this is a rate in Hz", f"1 / {name}"
            case Binary(operator=Operator.DIVIDE, left=Number(value=1), right=NameExpr(name=name)) if _is_rate(name):
                message, meant = f"`{name}` is a rate, as its name says, so this is a time, not a rate in Hz", name
            case Binary(operator=Operator.DIVIDE, left=Number(value=number), right=NameExpr(name=name)) if (
                number in _PER_SECOND.values() and number != (needed := _per_second(name)) and needed is not None
            ):
                message = (
                    f"`{name}` is a time in {_last_word(name)}, as its name says, of which a second has {needed:,}"
                )
                meant = f"{needed} / {name}"
            case _:
                return
        if name in self.scope:
            fix = Fix(f"Change to `{meant}`", (TextEdit(attribute.value_span, meant),))
            self._problems.add(
                ExpansionProblem.INVERTED, attribute.value_span, f"{message}; did you mean `{meant}`?", fixes=(fix,)
            )

    def _edit(self, span: Span, text: str, attribute: Attribute | None) -> None:
        self.edits.append(TextEdit(span, _escaped(self.document.text, text, attribute)))

    def _unknown(self, name: str, span: Span) -> None:
        close = close_names(name, self.scope)
        message = f"there is no parameter `{name}`{did_you_mean(close) if close else '; declare it with `<parameter>`'}"
        self._problems.add(ExpansionProblem.UNKNOWN, span, message, close=close)


_STRING_LITERAL = regex(r"""'(?:[^'\\]|\\.)*'|"(?:[^"\\]|\\.)*\"""", re.DOTALL)


def _is_in_literal(text: str, position: int) -> bool:
    """Whether a position in an expression is inside a string literal."""
    return any(literal.start() < position < literal.end() for literal in _STRING_LITERAL.finditer(text))


_RATES = frozenset((("ros_time_rate", "rate_hz"), ("input", "tick_rate"), ("bt_tick_rate", "value")))
"""The attributes that contain a rate in Hz, with their elements."""
_RATE_WORDS = frozenset(("fps", "freq", "frequency", "hz", "per", "rate"))
_TIME_WORDS = frozenset(("delay", "duration", "interval", "period", "sec", "secs", "seconds", "time", "timeout"))


_PER_SECOND = {"s": 1, "sec": 1, "secs": 1, "seconds": 1, "ms": 1000, "millis": 1000, "us": 10**6, "ns": 10**9}
"""The last word in the name of a parameter -> how many of this unit are a second."""


def _last_word(name: str) -> str:
    return name.lower().split("_")[-1]


def _per_second(name: str) -> int | None:
    return _PER_SECOND.get(_last_word(name)) if not _is_rate(name) else None


def _is_rate(name: str) -> bool:
    return not _RATE_WORDS.isdisjoint(name.lower().split("_"))


def _is_time(name: str) -> bool:
    """Whether a parameter is a time in s, as its name says. The inverse of one in ms would be no rate in Hz, either."""
    return _last_word(name) in _TIME_WORDS and not _is_rate(name)


_UNIT = regex(r"\s+(?:s|ms|us|ns)\s*\Z")
"""The unit of a duration, such as `20 ms`, after an expression."""


class _Plain:
    """A text without escapes, in which names of parameters are replaced."""

    def __init__(self, text: str, scope: Scope) -> None:
        self._text = text
        self._scope = scope
        self._tree, findings = parse(Decoded(text, 0))
        self._broken = bool(findings)

    def number(self) -> str | None:
        unit = _UNIT.search(self._text)
        tree, findings = parse(Decoded(self._text[: unit.start()] if unit else self._text, 0))
        value = None if findings else evaluate(tree, self._scope)
        if value is None or isinstance(value, (str, bool)):
            return None
        return number_text(value, is_real=False) + (unit[0] if unit else "")

    def expression(self) -> str:
        text = self._text
        for part, literal in sorted(_folded(self._tree, self._scope), key=lambda fold: fold[0].span, reverse=True):
            text = text[: part.span.start] + literal + text[part.span.end :]
        return text

    def constant(self) -> str:
        value = None if self._broken else evaluate(self._tree, self._scope)
        return self.expression() if value is None else _literal(self._tree, value, self._scope, is_whole=True)


def _folded(tree: Expr, scope: Scope) -> Iterator[tuple[Expr, str]]:
    """The largest constant parts of an expression that use parameters, each with the literal of its value."""
    if isinstance(tree, NameExpr):
        if tree.name in scope:
            yield tree, scope[tree.name].literal
        return
    if any(use.name in scope for use in names_in(tree)):
        value = evaluate(tree, scope)
        if value is not None:
            yield tree, _literal(tree, value, scope)
            return
        for child in children(tree):
            yield from _folded(child, scope)


def _literal(tree: Expr, value: Content, scope: Scope, *, is_whole: bool = False) -> str:
    """The literal of the value of an expression. If it is not the whole expression, a negative number is in
    parentheses."""
    number = "float64" if _is_real(tree, scope) else "int64"
    constant = ParameterValue({bool: "bool", str: "string"}.get(type(value), number), value)
    return constant.text if is_whole and not isinstance(value, str) else constant.literal


def names_in(tree: Expr) -> Iterator[NameExpr]:
    """The names that an expression uses; the names of members are none of them."""
    return (node for node in walk(tree) if isinstance(node, NameExpr))


def _root(tree: Expr) -> NameExpr | None:
    """The variable that a location changes."""
    while isinstance(tree, (Member, Index)):
        tree = tree.object
    return tree if isinstance(tree, NameExpr) else None


def _is_real(tree: Expr, scope: Scope) -> bool:
    """Whether the type of a numeric expression is real: a part of it is."""
    parts = list(walk(tree))
    names = [scope[n.name] for n in parts if isinstance(n, NameExpr) and n.name in scope]
    return any(getattr(part, "is_real", False) for part in parts) or any(c.kind is ScalarKind.REAL for c in names)


_ENTITIES = {"&": "&amp;", "<": "&lt;", ">": "&gt;", "\n": "&#10;", "\t": "&#9;", '"': "&quot;", "'": "&apos;"}


def _escaped(document: str, text: str, attribute: Attribute | None) -> str:
    """`text` as a part of XML."""
    quote = "" if attribute is None else document[attribute.value_span.start - 1]
    return "".join(_ENTITIES[c] if c in "&<>" or c == quote or (quote and c in "\n\t") else c for c in text)
