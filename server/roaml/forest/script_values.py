# SPDX-License-Identifier: Apache-2.0
"""The values of blackboard entries that only scripts write, followed through the trees, and the results of the
conditions in scripts (docs/spec/scripts.md#values).

- An entry may have any value until a script assigns one, because a tree may be executed again.
- The values after a node include those of every moment at which it can end or be halted.
- Each pass through a loop with a constant number of passes is followed; others are repeated until nothing changes.
- Below a node that may tick a child while another one is RUNNING, entries that the other child writes have any value.
"""

from __future__ import annotations

import functools
from collections.abc import Iterable, Iterator, Mapping

from roaml.expr.operators import Operator
from roaml.forest.entries import Entries
from roaml.forest.forest import Forest
from roaml.forest.scripts import ScriptUse, grammar_of, parsed, scripts_of
from roaml.libraries.scripts import AFTERWARDS, CONDITIONS
from roaml.model.expand import Frame, nodes_of
from roaml.model.tree import TreeNode
from roaml.model.values.domain import ANYTHING, NONE, ValueSet, exactly, interval, is_numeric, join, truth, widen
from roaml.model.values.evaluate import arithmetic, compared, joined_valuations
from roaml.record import Record
from roaml.script.names import names_in
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
    walk,
)
from roaml.text import Decoded

IN_ORDER = frozenset(("Sequence", "AsyncSequence", "Fallback", "AsyncFallback"))
"""The nodes that tick their children one after the other and continue with the running child."""
TRANSPARENT = frozenset(("Inverter", "ForceSuccess", "ForceFailure", "Timeout"))
"""The nodes with one child that they always tick, and only until it ends."""
MAX_VISITS = 5_000
"""The maximum number of nodes that are visited, each as often as a loop around it needs."""
MAX_PASSES = 20
"""The maximum number of passes through a loop until its values are assumed to be unknown."""

Values = dict[str, ValueSet]
"""The values of entries by their keys. Other entries may have any value."""

_OPERATORS = {
    "+": Operator.ADD, "-": Operator.SUBTRACT, "*": Operator.MULTIPLY, "/": Operator.DIVIDE,
    "==": Operator.EQUAL, "!=": Operator.NOT_EQUAL, "<": Operator.LESS, "<=": Operator.LESS_EQUAL,
    ">": Operator.GREATER, ">=": Operator.GREATER_EQUAL,
}  # fmt: skip


class ConditionResult(Record, frozen=True):
    """The results that a condition can have, in all uses of its tree.

    Attributes:
        truth: the results.
        values: name in the condition -> its values.
    """

    truth: frozenset[bool]
    values: Mapping[str, ValueSet]


class _TooLargeError(Exception):
    """Raised to abandon the analysis of a forest that is too large."""


def condition_results(forest: Forest, entries: Entries) -> Mapping[tuple[TreeNode, str], ConditionResult]:
    """The results of the conditions that are evaluated in executed trees: node and attribute -> results. Conditions
    that assign to entries are left out."""
    analysis = _Analysis(forest, entries)
    if not analysis.tracked:
        return {}
    try:
        for number, boards in enumerate(entries.trees):
            if boards.tree.executed:
                analysis.run(number)
    except _TooLargeError:
        return {}
    return analysis.results


class _Analysis:
    def __init__(self, forest: Forest, entries: Entries) -> None:
        self.forest = forest
        self.entries = entries
        self.grammar = grammar_of(forest.settings.version)
        self.files = dict(forest.files)
        self.tracked = frozenset(scripted_entries(forest, entries))
        self.results: dict[tuple[TreeNode, str], ConditionResult] = {}
        self.visits = 0
        self.repetitions = 1  # how often the loops around a node repeat it, as far as each pass is followed
        self._written: dict[tuple[int, TreeNode], frozenset[str]] = {}

    def run(self, number: int) -> None:
        self.boards = self.entries.trees[number]
        frames = self.boards.tree.frames
        self.inner = {(id(f.outer), f.use.position): f for f in frames if f.use is not None}
        self._tree(frames[0], {}, frozenset())

    def _tree(self, frame: Frame, before: Values, volatile: frozenset[str]) -> Values:
        nodes = nodes_of(self.files[frame.tree.path], frame.tree.id)
        return self._node(frame, nodes[0], before, volatile) if nodes else before

    # ------------------------------------------------------------- control

    def _node(self, frame: Frame, node: TreeNode, before: Values, volatile: frozenset[str]) -> Values:
        """The values after a node, at all moments at which it can end or be halted.

        Args:
            volatile: the entries that other nodes may write at any time.
        """
        self.visits += 1
        if self.visits > MAX_VISITS:
            raise _TooLargeError
        uses = list(scripts_of(self.forest, node))
        first = [use for use in uses if use.attribute.name not in AFTERWARDS]
        inside = before
        for use in first:
            inside = self._evaluate(frame, use, inside, volatile)
        after = self._below(frame, node, inside, volatile)
        for use in uses:
            if use.attribute.name in AFTERWARDS:
                after = joined_valuations(after, self._evaluate(frame, use, after, volatile))
        if any(use.attribute.name in CONDITIONS for use in first):
            after = joined_valuations(before, after)  # the node may be skipped
        again = joined_valuations(inside, after)
        for use in first:
            # Conditions of decorators and `_while` may be evaluated again while the node is RUNNING.
            if use.is_condition and (node.children or use.attribute.name == "_while"):
                self._evaluate(frame, use, again, volatile)
        return after

    def _below(self, frame: Frame, node: TreeNode, before: Values, volatile: frozenset[str]) -> Values:
        """The values after the children of a node, or after the tree that it calls."""
        if self.forest.calls_tree(node):
            inner = self.inner.get((id(frame), self._position(frame, node)))
            return {} if inner is None else self._tree(inner, before, volatile)
        name = node.plugin.value if node.plugin else ""
        if not node.children:
            return before
        if name in IN_ORDER:
            after: Values = before
            result: Values | None = None
            for child in node.children:
                after = self._node(frame, child, after, volatile)
                result = after if result is None else joined_valuations(result, after)
            return result if result is not None else before
        if name in TRANSPARENT and len(node.children) == 1:
            return self._node(frame, node.children[0], before, volatile)
        if name == "IfThenElse":
            tested = self._node(frame, node.children[0], before, volatile)
            branches = [self._node(frame, child, tested, volatile) for child in node.children[1:]]
            return functools.reduce(joined_valuations, branches, tested)
        passes = _passes(node)
        if passes and self.repetitions * passes <= MAX_PASSES:
            return self._repeated(frame, node, before, volatile, passes)
        return self._in_any_order(frame, node, before, volatile)

    def _repeated(self, frame: Frame, node: TreeNode, before: Values, volatile: frozenset[str], passes: int) -> Values:
        """The values after a node that ticks its only child until it ends, at most `passes` times."""
        self.repetitions *= passes
        after = result = before
        for _ in range(passes):
            after = self._node(frame, node.children[0], after, volatile)
            result = joined_valuations(result, after)
        self.repetitions //= passes
        return result

    def _in_any_order(self, frame: Frame, node: TreeNode, before: Values, volatile: frozenset[str]) -> Values:
        """The values after children that are ticked any number of times, in any order."""
        written = [self._writes(frame, child) for child in node.children]
        current = before
        for number in range(MAX_PASSES):
            after = current
            for index, child in enumerate(node.children):
                by_others = frozenset[str]().union(*written[:index], *written[index + 1 :])
                known = {key: values for key, values in current.items() if key not in by_others}
                after = joined_valuations(after, self._node(frame, child, known, volatile | by_others))
            if after == current:
                return current
            if number:
                after = {key: widen(current[key], values, ()) for key, values in after.items()}
            current = after
        return {}

    def _writes(self, frame: Frame, node: TreeNode) -> frozenset[str]:
        """The entries that a node and the nodes below it write."""
        known = (id(frame), node)
        if known not in self._written:
            written = set[str]()
            for use in scripts_of(self.forest, node):
                names = names_in(use.attribute.value)
                written |= {self.boards.key(frame, name) for name, operator in names if operator != "read"}
            for child in node.children:
                written |= self._writes(frame, child)
            inner = self.inner.get((id(frame), self._position(frame, node))) if self.forest.calls_tree(node) else None
            for root in nodes_of(self.files[inner.tree.path], inner.tree.id)[:1] if inner is not None else ():
                assert inner is not None
                written |= self._writes(inner, root)
            self._written[known] = frozenset(written)
        return self._written[known]

    def _position(self, frame: Frame, node: TreeNode) -> int:
        return nodes_of(self.files[frame.tree.path], frame.tree.id).index(node)

    # -------------------------------------------------------------- scripts

    def _evaluate(self, frame: Frame, use: ScriptUse, before: Values, volatile: frozenset[str]) -> Values:
        """The values after a script. The result of a condition is recorded."""
        script, problems = parsed(Decoded(use.attribute.value, 0), self.grammar)
        assigned = [name for name, operator in names_in(use.attribute.value) if operator != "read"]
        inside = [expr for expr in walk(script) if isinstance(expr, Assignment) and expr not in script.statements]
        if problems or inside:  # an assignment inside an expression may not be executed
            written = {self.boards.key(frame, name) for name in assigned}
            return {key: values for key, values in before.items() if key not in written}
        evaluation = _Evaluation(functools.partial(self.boards.key, frame), dict(before), self.tracked - volatile)
        result = evaluation.script(script)
        if use.is_condition and not assigned:
            self._record(use, evaluation, result)
        return evaluation.values

    def _record(self, use: ScriptUse, evaluation: _Evaluation, result: ValueSet) -> None:
        place, possible = (use.node, use.attribute.name), frozenset(_truths(result))
        values = {
            name: evaluation.value(name) for name, operator in names_in(use.attribute.value) if operator == "read"
        }
        known = self.results.get(place)
        if known is not None:
            possible |= known.truth
            values = {name: join(value, known.values.get(name, NONE)) for name, value in values.items()}
        self.results[place] = ConditionResult(possible, values)


class _Evaluation:
    """The evaluation of one script."""

    def __init__(self, key: functools.partial[str], values: dict[str, ValueSet], tracked: frozenset[str]) -> None:
        self.key = key
        self.values = values
        self.tracked = tracked

    def value(self, name: str) -> ValueSet:
        return self.values.get(self.key(name), ANYTHING)

    def script(self, script: Script) -> ValueSet:
        result = ANYTHING
        for statement in script.statements:
            result = self._of(statement)
        return result

    def _of(self, expr: Expr) -> ValueSet:
        match expr:
            case Number(value=value) | String(value=value):
                return exactly(value)
            case Boolean(value=is_true):
                return exactly(int(is_true))
            case Name(name=name):
                return self.value(name)
            case Unary(operator="!", operand=operand):
                return truth(not result for result in _truths(self._of(operand)))
            case Unary(operator=operator, operand=operand):
                operated = self._of(operand)
                return arithmetic(Operator.SUBTRACT, exactly(0), operated) if operator == "-" else ANYTHING
            case Comparison(operators=operators, operands=operands):
                values = [self._of(operand) for operand in operands]
                results = [compared(_OPERATORS[o], values[i], values[i + 1]) for i, o in enumerate(operators)]
                return _all(results)
            case Binary(operator=operator, left=left, right=right):
                return self._binary(operator, self._of(left), self._of(right))
            case Conditional(test=test, yes=yes, no=no):
                tested = frozenset(_truths(self._of(test)))
                branches = (self._of(yes), True), (self._of(no), False)
                return functools.reduce(join, (value for value, needed in branches if needed in tested), NONE)
            case Assignment():
                return self._assign(expr)
            case ErrorExpr():
                return ANYTHING

    def _binary(self, operator: str, left: ValueSet, right: ValueSet) -> ValueSet:
        if operator == "&&":
            return _all((left, right))
        if operator == "||":
            return truth(a or b for a in _truths(left) for b in _truths(right))
        known = _OPERATORS.get(operator)
        return arithmetic(known, left, right) if known is not None else ANYTHING

    def _assign(self, assignment: Assignment) -> ValueSet:
        key, operator = self.key(assignment.target.name), assignment.operator.removesuffix("=").removesuffix(":")
        value = self._of(assignment.value)
        if operator:
            value = self._binary(operator, self.value(assignment.target.name), value)
        if key in self.tracked:
            self.values[key] = value
        return value


def _passes(node: TreeNode) -> int:
    """How often a loop ticks its only child at most; 0 if this is not a constant."""
    port = _COUNTED.get(node.type_name)
    attribute = node.element.get(port) if port is not None and len(node.children) == 1 else None
    text = attribute.value.strip() if attribute is not None else ""
    if port == "queue" and "{" not in text:
        return len(text.split(";")) if text else 0
    return int(text) if text.isdecimal() and len(text) <= len(str(MAX_PASSES)) else 0


_COUNTED = {
    "Repeat": "num_cycles",
    "RetryUntilSuccessful": "num_attempts",
    **dict.fromkeys(("LoopInt", "LoopBool", "LoopDouble", "LoopString"), "queue"),
}
"""The loops that end after a number of passes -> the port that states this number."""


def scripted_entries(forest: Forest, entries: Entries) -> Iterator[str]:
    """The keys of the entries that only scripts write, and that no program sets."""
    for key, uses in entries.by_entry.items():
        is_hosted = any(bound.use.name.removeprefix("@") in forest.host_entries for bound in uses)
        by_scripts = all(bound.use.script or bound.use.remaps or bound.use.writes is False for bound in uses)
        if by_scripts and not is_hosted and any(bound.use.script and bound.use.writes for bound in uses):
            yield key


def _truths(values: ValueSet) -> Iterable[bool]:
    """The results of a value as a condition: a number is true if it is not 0."""
    if values.only is not None and is_numeric(values):
        return {bool(value) for value in values.only}
    bounds = interval(values)
    return (True,) if bounds.low > 0 or bounds.high < 0 else (False, True)


def _all(values: Iterable[ValueSet]) -> ValueSet:
    results = frozenset((True,))
    for value in values:
        results = frozenset(a and b for a in results for b in _truths(value))
    return truth(results)
