# SPDX-License-Identifier: Apache-2.0
"""The knowledge about values on a path: the conditions that were true, and the constants that were assigned.

- A `Knowledge` is an immutable conjunction with one `Domain` for each term (`level`, `_res.success`, `a + b`,
  `v.length`). A term without a domain may have any value.
- It never excludes a possible value: an unsupported expression adds no knowledge.
- A pair of terms that are compared with each other also has a domain: a subset of `<`, `=`, `>`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple, TypeAlias

from roaml.expr.format import format_expr
from roaml.expr.infer import constant
from roaml.expr.operators import Operator, OperatorKind, UnaryOperator
from roaml.expr.tree import (
    Binary,
    Boolean,
    Call,
    Conditional,
    ErrorExpr,
    Expr,
    Member,
    Name,
    String,
    Unary,
    access_path,
    is_draw,
    walk,
)
from roaml.record import PartlyCompared, Record, field, replace

Constant: TypeAlias = bool | int | float | str

MAX_CONJUNCTIONS = 16
"""The maximum number of conjunctions into which a condition is split; a larger condition adds no knowledge."""


class Domain(Record, frozen=True):
    """The values that a term may have.

    Attributes:
        only: all values, if they can be listed; otherwise `None`.
        excluded: values that the term cannot have.
        low, high: the bounds of a number; `low_open` and `high_open` mean that the bound itself is excluded.
    """

    only: frozenset[Constant] | None = None
    excluded: frozenset[Constant] = frozenset()
    low: float = -math.inf
    high: float = math.inf
    low_open: bool = False
    high_open: bool = False

    @property
    def value(self) -> Constant | None:
        """The value that the term must have; `None` if several values are possible."""
        return next(iter(self.only)) if self.only is not None and len(self.only) == 1 else None

    def admits(self, value: Constant) -> bool:
        if value in self.excluded or (self.only is not None and value not in self.only):
            return False
        if isinstance(value, str):
            return True
        above = value > self.low or (value == self.low and not self.low_open)
        below = value < self.high or (value == self.high and not self.high_open)
        return above and below

    def narrowed(self, is_integer: bool) -> Domain | None:
        """The domain in its simplest form; `None` if it is empty. `is_integer` means that the values are integers."""
        if self.only is not None:
            only = frozenset(value for value in self.only if self.admits(value))
            return Domain(only) if only else None
        low, high, low_open, high_open = self.low, self.high, self.low_open, self.high_open
        if is_integer:
            if math.isfinite(low):
                low, low_open = math.floor(low) + 1 if low_open else math.ceil(low), False
                while low in self.excluded:
                    low += 1
            if math.isfinite(high):
                high, high_open = math.ceil(high) - 1 if high_open else math.floor(high), False
                while high in self.excluded:
                    high -= 1
        if low > high or (low == high and (low_open or high_open or low in self.excluded)):
            return None
        if low == high:
            return Domain(frozenset((low,)))
        excluded = self.excluded
        if math.isfinite(low) or math.isfinite(high):
            excluded = frozenset(e for e in excluded if isinstance(e, str) or low <= e <= high)
        return Domain(None, excluded, low, high, low_open, high_open)


TRUTH: Domain = Domain(frozenset((True, False)))
_RELATIONS = Domain(frozenset("<=>"))


class _Entry(Record, frozen=True):
    """A term and its domain. `roots` are the variables in the term."""

    term: str
    roots: frozenset[str]
    domain: Domain


class Knowledge(Record, frozen=True):
    entries: tuple[_Entry, ...] = ()
    """The entries of a conjunction, sorted by term."""

    def of(self, term: str) -> Domain | None:
        return next((entry.domain for entry in self.entries if entry.term == term), None)

    def without(self, variable: str) -> Knowledge:
        """The knowledge without the terms that contain the variable `variable`."""
        kept = tuple(entry for entry in self.entries if variable not in entry.roots)
        return self if len(kept) == len(self.entries) else Knowledge(kept)

    def within(self, variables: frozenset[str]) -> Knowledge:
        """The knowledge about the terms that contain only variables of `variables`."""
        kept = tuple(entry for entry in self.entries if entry.roots <= variables)
        return self if len(kept) == len(self.entries) else Knowledge(kept)

    def enumerates(self, before: Knowledge) -> bool:
        """Whether a term has been compared for equality with several constants since `before` and equals none of them.
        This is the case if conditions handle each value of an enumeration."""
        return any(
            entry.domain.only is None and len(entry.domain.excluded) > 1 and entry not in before.entries
            for entry in self.entries
        )

    def _with(self, term: str, roots: frozenset[str], domain: Domain) -> Knowledge:
        others = [entry for entry in self.entries if entry.term != term]
        return Knowledge(tuple(sorted((*others, _Entry(term, roots, domain)), key=lambda entry: entry.term)))


NOTHING = Knowledge()


class _Term(NamedTuple):
    """An expression whose value may be known. `text` is `None` if the expression cannot be read, or if its value may
    differ at each evaluation."""

    text: str | None
    roots: frozenset[str]
    constant: Constant | None
    followed: bool
    expr: Expr


class ConditionFacts(PartlyCompared, frozen=True):
    """Facts about the variables of a chart that hold on every path. They decide what is stored in a `Knowledge`.

    Attributes:
        whole: the variables whose values are integers.
        logical: the variables that are booleans.
        followed: the variables whose values are stored; `None` for all variables.
        counted: the variables for which the values of sums and remainders are computed and stored.
        constants: name of a constant, such as `SUCCESS` -> its value.
    """

    UNCOMPARED = frozenset({"_terms"})

    whole: frozenset[str] = frozenset()
    logical: frozenset[str] = frozenset()
    followed: frozenset[str] | None = None
    counted: frozenset[str] = frozenset()
    constants: Mapping[str, Constant] = field(default_factory=dict)
    _terms: dict[int, _Term] = field(default_factory=dict)

    def term(self, expr: Expr) -> _Term:
        """The term for an expression. It is cached by the identity of the expression, which outlives this object."""
        known = self._terms.get(id(expr))
        if known is None:
            if isinstance(expr, Boolean | String):
                value: Constant | None = expr.value
            elif isinstance(expr, Name) and expr.name in self.constants:
                value = self.constants[expr.name]
            else:
                value = constant(expr)
            roots = _roots(expr)
            followed = self.followed is None or roots <= self.followed
            known = self._terms[id(expr)] = _Term(_text(expr), roots, value, followed, expr)
        return known

    # ------------------------------------------------------------ conditions

    def assume(self, knowledge: Knowledge, condition: Expr, holds: bool = True) -> tuple[Knowledge, ...]:
        """The knowledge if `condition` holds, or if it does not hold (`holds` is false).

        The result is a disjunction: one of the returned conjunctions is true. It is empty if the condition cannot have
        this value.
        """
        ways = tuple(dict.fromkeys(self._assume(knowledge, condition, holds)))
        return ways if len(ways) <= MAX_CONJUNCTIONS else (knowledge,)

    def _assume(self, knowledge: Knowledge, condition: Expr, holds: bool) -> Iterator[Knowledge]:
        match condition:
            case Boolean():
                if condition.value == holds:
                    yield knowledge
            case Unary(operator=UnaryOperator.NOT):
                yield from self.assume(knowledge, condition.operand, not holds)
            case Binary(operator=Operator.AND | Operator.OR):
                both = (condition.operator is Operator.AND) == holds
                for first in self.assume(knowledge, condition.left, holds):
                    yield from self.assume(first, condition.right, holds) if both else (first,)
                if not both:
                    for first in self.assume(knowledge, condition.left, not holds):
                        yield from self.assume(first, condition.right, holds)
            case Conditional():
                for part, chosen in ((condition.then, True), (condition.otherwise, False)):
                    for tested in self.assume(knowledge, condition.test, chosen):
                        yield from self.assume(tested, part, holds)
            case Binary() if condition.operator.kind in (OperatorKind.ORDER, OperatorKind.EQUALITY):
                yield from self._compare(knowledge, condition, holds)
            case _:
                yield from self._narrow(knowledge, condition, TRUTH, Domain(frozenset((holds,))))

    def _compare(self, knowledge: Knowledge, condition: Binary, holds: bool) -> Iterator[Knowledge]:
        left, right, relation = condition.left, condition.right, _relation(condition.operator, holds)
        if self._is_logical(left) and self._is_logical(right) and condition.operator.kind is OperatorKind.EQUALITY:
            for value in (True, False):
                for first in self.assume(knowledge, left, value):
                    yield from self.assume(first, right, value if "=" in relation else not value)
            return
        left_value, right_value = self.value(knowledge, left), self.value(knowledge, right)
        if left_value is not None and right_value is not None:
            if _relations_between(left_value, right_value) & relation:
                yield knowledge
        elif right_value is not None:
            yield from self._bound(knowledge, left, relation, right_value)
        elif left_value is not None:
            yield from self._bound(knowledge, right, frozenset(_MIRROR[r] for r in relation), left_value)
        else:
            yield from self._relate(knowledge, left, right, relation)

    def _relate(self, knowledge: Knowledge, left: Expr, right: Expr, relation: frozenset[str]) -> Iterator[Knowledge]:
        (left_term, roots, _, followed, _), (right_term, more, _, both, _) = self.term(left), self.term(right)
        if left_term is None or right_term is None or not (followed and both):
            yield knowledge
            return
        if left_term == right_term:
            if "=" in relation:
                yield knowledge
            return
        if left_term > right_term:
            left_term, right_term, relation = right_term, left_term, frozenset(_MIRROR[r] for r in relation)
        yield from self._meet(knowledge, f"{left_term} ? {right_term}", roots | more, _RELATIONS, Domain(relation))

    def _bound(
        self, knowledge: Knowledge, term: Expr, relation: frozenset[str], value: Constant
    ) -> Iterator[Knowledge]:
        if isinstance(value, bool):
            domain = Domain(frozenset((value if "=" in relation else not value,)))
        elif isinstance(value, str):
            only = frozenset((value,))
            domain = Domain(only) if "=" in relation else Domain(excluded=only)
        elif relation == {"<", ">"}:
            domain = Domain(excluded=frozenset((value,)))
        else:
            domain = Domain(
                low=-math.inf if "<" in relation else value,
                high=math.inf if ">" in relation else value,
                low_open="=" not in relation and "<" not in relation,
                high_open="=" not in relation and ">" not in relation,
            )
        yield from self._narrow(knowledge, term, Domain(), domain)

    def _narrow(self, knowledge: Knowledge, expr: Expr, before: Domain, required: Domain) -> Iterator[Knowledge]:
        term = self.term(expr)
        if term.text is None or not term.followed:
            yield knowledge
        else:
            yield from self._meet(knowledge, term.text, term.roots, before, required)

    def _meet(
        self, knowledge: Knowledge, term: str, roots: frozenset[str], before: Domain, required: Domain
    ) -> Iterator[Knowledge]:
        known = knowledge.of(term) or before
        is_integer = roots <= self.whole and "/" not in term and "Math." not in term
        met = _both(known, required).narrowed(is_integer)
        if met is not None:
            yield knowledge if met == known and knowledge.of(term) else knowledge._with(term, roots, met)

    # ---------------------------------------------------------------- values

    def value(self, knowledge: Knowledge, expr: Expr) -> Constant | None:
        """The value of an expression; `None` if it is not known."""
        term = self.term(expr)
        if term.constant is not None or term.text is None:
            return term.constant
        domain = knowledge.of(term.text)
        return domain.value if domain is not None else None

    def values(self, knowledge: Knowledge, expr: Expr, calculates: bool = True) -> Domain:
        """The values that an expression may have. `calculates` means that sums and remainders are evaluated."""
        term = self.term(expr)
        if term.constant is not None:
            return Domain(frozenset((term.constant,)))
        known = knowledge.of(term.text) if term.text is not None else None
        if known is not None or not calculates:
            return known or Domain()
        match expr:
            case Binary(operator=Operator.REMAINDER) if (divisor := constant(expr.right)) and divisor > 0:
                return Domain(low=0, high=divisor - 1)
            case Binary(operator=Operator.ADD | Operator.SUBTRACT) if (step := constant(expr.right)) is not None:
                by = step if expr.operator is Operator.ADD else -step
                return _shifted(self.values(knowledge, expr.left), by)
        return Domain()

    def assign(self, knowledge: Knowledge, location: Expr, value: Expr | None) -> tuple[Knowledge, ...]:
        """The knowledge after an assignment. The result is a disjunction: the assignment of a condition gives separate
        results for true and false."""
        root = (access_path(location) or ("",))[0]  # in `free[id]`, `id` is only read
        if value is None or not isinstance(location, Name):
            return (knowledge.without(root),)
        if location.name in self.logical or isinstance(value, Boolean):
            splits = []
            for truth in (True, False):
                for known in self.assume(knowledge, value, truth):
                    after = known.without(root)
                    splits.append(after._with(root, frozenset((root,)), Domain(frozenset((truth,)))))
            return tuple(dict.fromkeys(splits))
        domain = self.values(knowledge, value, root in self.counted)
        after = knowledge.without(root)
        return (after if domain == Domain() else after._with(root, frozenset((root,)), domain),)

    def know(self, knowledge: Knowledge, term: str, domain: Domain) -> Knowledge:
        """The knowledge, extended by a domain of a variable or of a field of `_event.data`."""
        return knowledge._with(term, frozenset((term.partition(".")[0],)), domain)

    def _is_logical(self, expr: Expr) -> bool:
        match expr:
            case Boolean():
                return True
            case Name():
                return expr.name in self.logical
            case Unary():
                return expr.operator is UnaryOperator.NOT
            case Binary():
                return expr.operator.kind is not OperatorKind.ARITHMETIC
        return False


def _text(expr: Expr) -> str | None:
    if isinstance(expr, Name):
        return expr.name
    if any(isinstance(node, ErrorExpr) or is_draw(node) for node in walk(expr)):
        return None
    return format_expr(expr)


def _roots(expr: Expr) -> frozenset[str]:
    """The variables in an expression."""
    if isinstance(expr, Name):
        return frozenset((expr.name,))
    skipped = {
        node.function.object for node in walk(expr) if isinstance(node, Call) and isinstance(node.function, Member)
    }
    return frozenset(node.name for node in walk(expr) if isinstance(node, Name) and node not in skipped)


_MIRROR = {"<": ">", "=": "=", ">": "<"}
_HOLDING = {
    Operator.EQUAL: "=",
    Operator.NOT_EQUAL: "<>",
    Operator.LESS: "<",
    Operator.LESS_EQUAL: "<=",
    Operator.GREATER: ">",
    Operator.GREATER_EQUAL: ">=",
}


def _relation(operator: Operator, holds: bool) -> frozenset[str]:
    """The possible relations of two values (`<`, `=`, `>`) if a comparison holds, or if it does not."""
    relation = frozenset(_HOLDING[operator])
    return relation if holds else frozenset("<=>") - relation


def _relations_between(first: Constant, second: Constant) -> frozenset[str]:
    if isinstance(first, str) or isinstance(second, str):
        return frozenset("=" if first == second else "<>")
    return frozenset("=" if first == second else "<" if first < second else ">")


def _both(left: Domain, right: Domain) -> Domain:
    if left.only is not None and right.only is not None:
        only: frozenset[Constant] | None = left.only & right.only
    else:
        only = left.only if left.only is not None else right.only
    low, low_open = max((left.low, left.low_open), (right.low, right.low_open))
    high, high_closed = min((left.high, not left.high_open), (right.high, not right.high_open))
    return Domain(only, left.excluded | right.excluded, low, high, low_open, not high_closed)


def _shifted(domain: Domain, by: float) -> Domain:
    if domain.only is not None:
        return Domain(frozenset(v if isinstance(v, str) else v + by for v in domain.only))
    return replace(domain, low=domain.low + by, high=domain.high + by, excluded=frozenset())


def variables_in(expressions: Iterable[Expr]) -> frozenset[str]:
    """The variables that `expressions` read."""
    return frozenset(name for expr in expressions for name in _roots(expr))


def is_literal(expr: Expr) -> bool:
    return isinstance(expr, Boolean | String) or constant(expr) is not None
