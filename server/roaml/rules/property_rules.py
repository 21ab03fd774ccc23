# SPDX-License-Identifier: Apache-2.0
"""The rules whose findings come from linking the properties of an XML file; each is a kind of problem, a severity and a
sentence. Their documents are in `properties`."""

from __future__ import annotations

from roaml.diagnostics import Severity
from roaml.model.property_problems import ProblemKind
from roaml.rules.support.property_problems import problem_rule

RULES = (
    problem_rule(
        ProblemKind.FALSE_AT_START,
        Severity.WARNING,
        "A property of the pattern `universality` requires an event at all times.",
    ),
    problem_rule(ProblemKind.NEVER_TOGETHER, Severity.WARNING, "A condition requires two events at the same time."),
    problem_rule(
        ProblemKind.SEVERAL_CLIENTS,
        Severity.WARNING,
        "A port of a service or action does not choose one of several clients.",
    ),
    problem_rule(ProblemKind.PORT_TYPE, Severity.ERROR, "The type of a port differs from the type of the interface."),
    problem_rule(ProblemKind.PORT_VARIABLE, Severity.ERROR, "A variable of a port cannot get a value."),
    problem_rule(
        ProblemKind.CONDITION,
        Severity.ERROR,
        "A condition of a property is not a boolean expression over the variables of the ports.",
    ),
    problem_rule(
        ProblemKind.FORM, Severity.ERROR, "A property does not have the parts that its pattern or formula needs."
    ),
    problem_rule(ProblemKind.TIME, Severity.ERROR, "The clock of the system cannot measure the times of a property."),
    problem_rule(
        ProblemKind.UNKNOWN_PORT,
        Severity.ERROR,
        "A port names an interface, node or event that the system does not have.",
    ),
    problem_rule(ProblemKind.UNSENT, Severity.WARNING, "A port listens to an event that is never sent."),
    problem_rule(
        ProblemKind.UNUSED, Severity.WARNING, "No property uses a variable of a port, or a port has no variables."
    ),
)
