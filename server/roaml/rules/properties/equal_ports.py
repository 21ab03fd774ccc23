# SPDX-License-Identifier: Apache-2.0
"""The rule `equal-ports`, which equal_ports.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.model.property_file import PortVariable
from roaml.model.property_links import LinkedFile
from roaml.model.property_problems import ProblemKind
from roaml.model.syntax import Name
from roaml.rules.rule import Rule
from roaml.rules.support.odd_values import odd_ports


def check(file: LinkedFile) -> Iterator[Finding]:
    """Report ports that listen to the same events and give a variable the same values as an earlier port."""
    first: dict[tuple[str, ...], PortVariable] = {}
    # The name of such a port is that of another one by mistake, which is reported.
    wrong = {problem.span for problem in file.problems if problem.kind is ProblemKind.MISLEADING}
    wrong |= {odd.text.span for odd in odd_ports(file)}
    for port in file.file.ports:
        texts = (_text(port.name), _text(port.event), _text(port.origin), _text(port.target))
        for variable in port.variables:
            key = (port.kind.value, *texts, variable.kind.value, _text(variable.field), _flag(variable))
            earlier = first.setdefault(key, variable)
            if earlier is variable or earlier.id is None or variable.id is None or port.name is None:
                continue
            if earlier.id.value != variable.id.value and port.name.span not in wrong:
                message = (
                    f"`{variable.id.value}` has the same values as `{earlier.id.value}`: both ports listen to "
                    f"`{port.name.value}`; change one of them, or use only one variable"
                )
                related = [Related(earlier.id.span, "the other variable")]
                yield RULE.at(port.name.span, message, related=related)


def _flag(variable: PortVariable) -> str:
    """The initial value of a Boolean; "" for other variables. With another one, the variable also tells what is true as
    long as nothing is known."""
    text = variable.initial.text.strip() if variable.initial is not None else ""
    return text if text in ("true", "false") else ""


def _text(name: Name | None) -> str:
    return "" if name is None else name.value


RULE = Rule(
    "equal-ports",
    Severity.WARNING,
    "Two variables of a property file always have the same value.",
    xml_properties=check,
)
