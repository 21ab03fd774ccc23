# SPDX-License-Identifier: Apache-2.0
"""The rule `unknown-function`, which unknown_function.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.expr.infer import UnknownFunction, WrongArgumentCount
from roaml.expr.operators import FUNCTIONS
from roaml.expr.tree import Call, Conditional, walk
from roaml.model.syntax import Expression, Value
from roaml.rules.rule import MachineContext, Rule, close_names, did_you_mean, replacements
from roaml.text import Span, TextEdit

CONSTANTS = {"Math.PI": "3.141592653589793", "Math.E": "2.718281828459045", "Math.SQRT2": "1.4142135623730951"}
ADVICE = {
    "Math.sqrt": "write `Math.pow(x, 0.5)`",
    "Math.round": "write `Math.floor(x + 0.5)`",
    "Math.trunc": "write `Math.floor(x)` for x ≥ 0",
    "Math.tan": "write `Math.sin(x) / Math.cos(x)`",
    ".push": 'append with `<assign location="v[v.length]" …/>`',
    ".pop": 'shorten with `<assign location="v.length" expr="v.length - 1"/>`',
}


REWRITTEN = {"Math.sqrt": ("Math.pow", ", 0.5"), "Math.round": ("Math.floor", " + 0.5")}
"""Unknown functions, each with a function that has the same effect and the text to add after its argument."""


def check(context: MachineContext) -> Iterator[Finding]:
    for value in context.typed.values:
        for problem in value.problems:
            if isinstance(problem, UnknownFunction):
                yield _unknown(problem, value.value)
            elif isinstance(problem, WrongArgumentCount):
                function = FUNCTIONS[problem.function]
                count = f"{problem.given} argument{'' if problem.given == 1 else 's'}"
                yield RULE.at(problem.span, f"`{function.signature}` cannot be called with {count}")


def _unknown(problem: UnknownFunction, value: Value) -> Finding:
    name = problem.name
    if name in CONSTANTS and not problem.called:
        fixes = replacements(problem.span, (CONSTANTS[name],))
        return RULE.at(problem.span, f"there is no constant `{name}`; write the number `{CONSTANTS[name]}`", *fixes)
    if name in ADVICE:
        message = f"there is no function `{name}`; {ADVICE[name]}"
        return RULE.at(problem.span, message, *_rewrite(problem, value))
    if name == "Math":
        return RULE.at(problem.span, "`Math` is not a value; call one of its functions, such as `Math.floor(x)`")
    known = [f"Math.{function}" for function in FUNCTIONS]
    if name in known and not problem.called:
        return RULE.at(problem.span, f"`{name}` is a function; call it as `{FUNCTIONS[name[5:]].signature}`")
    close = close_names(name, known) if name.startswith("Math.") else ()
    if not close and f"Math.{name}" in known:
        close = (f"Math.{name}",)
    if not close and problem.called:
        from roaml.distributions.laws import LAWS  # noqa: PLC0415 - few machines call unknown functions

        close = close_names(name, LAWS)
    hint = did_you_mean(close) or "; only functions of `Math` and distributions can be called"
    problem_text = f"there is no function `{name}`" if name else "this cannot be called"
    return RULE.at(problem.span, f"{problem_text}{hint}", *replacements(problem.span, close))


def _rewrite(problem: UnknownFunction, value: Value) -> Iterator[Fix]:
    """Fixes that call another function with the same effect."""
    if problem.name not in REWRITTEN or not isinstance(value, Expression) or value.broken:
        return
    function, behind = REWRITTEN[problem.name]
    for node in walk(value.tree):
        if isinstance(node, Call) and node.function.span == problem.span and len(node.arguments) == 1:
            end = node.span.end - 1
            if not isinstance(node.arguments[0], Conditional):
                edits = (TextEdit(problem.span, function), TextEdit(Span(end, end), behind))
                yield Fix(f"Change to `{function}(x{behind})`", edits)


RULE = Rule("unknown-function", Severity.ERROR, "A call has an unknown function or wrong arguments.", machine=check)
