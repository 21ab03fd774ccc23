# SPDX-License-Identifier: Apache-2.0
"""The rule `unknown-ros-type`, which unknown_ros_type.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.interfaces.registry import NotFound, Reason
from roaml.model.value_types import INTERFACE_KINDS
from roaml.rules.rule import MachineContext, Rule, did_you_mean, replacements
from roaml.text import Span, TextEdit


def check(context: MachineContext) -> Iterator[Finding]:
    for declaration in context.machine.declarations:
        if declaration.type is None or declaration.kind not in INTERFACE_KINDS:
            continue
        interface_type = context.interface(INTERFACE_KINDS[declaration.kind], declaration.type.value)
        span = declaration.type.span
        if not isinstance(interface_type, NotFound):
            yield from _with_kind(declaration.type.value, span)
            continue
        if interface_type.reason is Reason.SECTIONS:
            continue  # reported in the file of the type
        if interface_type.reason is Reason.UNKNOWN_PACKAGE:
            yield _unknown_package(interface_type, span)
        else:
            yield RULE.at(span, interface_type.message, *replacements(span, interface_type.close))


def _with_kind(type_: str, span: Span) -> Iterator[Finding]:
    """Report a type with its kind, such as `std_msgs/msg/Bool`. ROS 2 uses this form, but other tools for these models
    do not accept it."""
    package, *kind, name = type_.split("/")
    if kind:
        short = f"{package}/{name}"
        yield RULE.at(span, f"a type in a model has no `/{kind[0]}/`; write `{short}`", *replacements(span, (short,)))


def _unknown_package(problem: NotFound, span: Span) -> Finding:
    """The finding for an unknown package. Its name may be misspelled; more often the package is in a folder that is not
    searched."""
    package = problem.type_name.partition("/")[0]
    meant = problem.meant
    searched = ", ".join(problem.looked_in)
    where = f"; searched {searched}; add the folder of the package with `--ros-path` or the setting `ros-path`"
    message = f"there is no package `{package}`{did_you_mean(meant) or where}"
    others = (name for name in problem.close if name not in meant)
    elsewhere = (Fix(f"Change to `{name}`", (TextEdit(span, name),), preferred=False) for name in others)
    return RULE.at(span, message, *replacements(span, meant), *elsewhere)


RULE = Rule("unknown-ros-type", Severity.ERROR, "A ROS type cannot be found.", machine=check)
