# SPDX-License-Identifier: Apache-2.0
"""The rules whose findings come from the expansion of parameters, instances and channels; each is a kind of problem, a
severity and a sentence. Their documents are in `parameters`."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.expansion.problems import ExpansionProblem
from roaml.rules.rule import Rule


def _rule(problem: ExpansionProblem, severity: Severity, summary: str) -> Rule:
    return Rule(problem.value, severity, summary)


RULES = (
    _rule(ExpansionProblem.ASSIGNED, Severity.ERROR, "A machine assigns a value to a parameter."),
    _rule(ExpansionProblem.DUPLICATE, Severity.ERROR, "A file declares two parameters with the same name."),
    _rule(ExpansionProblem.HIDDEN, Severity.WARNING, "A variable hides a parameter with the same name."),
    _rule(ExpansionProblem.CHANNEL, Severity.ERROR, "A channel has an invalid attribute, or leads nowhere."),
    _rule(ExpansionProblem.DISTRIBUTION, Severity.ERROR, "A distribution has invalid arguments, or too many values."),
    _rule(
        ExpansionProblem.INSTANCE,
        Severity.ERROR,
        "An instance has an invalid name, namespace, parameter or remap.",
    ),
    _rule(
        ExpansionProblem.NAMESPACE,
        Severity.WARNING,
        "Two inputs of a file are in one namespace, and none is in another one that is used.",
    ),
    _rule(
        ExpansionProblem.INCONSISTENT,
        Severity.WARNING,
        "The value of a parameter has another number than its instance, unlike at all other instances.",
    ),
    _rule(ExpansionProblem.INVERTED, Severity.WARNING, "A time is used as a rate, or the inverse of a rate."),
    _rule(ExpansionProblem.DECLARATION, Severity.ERROR, "The declaration of a parameter is incomplete or invalid."),
    _rule(ExpansionProblem.VALUE, Severity.ERROR, "The value of a parameter has another type, or is out of range."),
    _rule(ExpansionProblem.UNKNOWN, Severity.ERROR, "A parameter is used or set that is not declared."),
    _rule(ExpansionProblem.UNUSED, Severity.WARNING, "Nothing uses a parameter."),
    _rule(ExpansionProblem.REMAP, Severity.WARNING, "A remap names an interface or event that the file does not have."),
)
