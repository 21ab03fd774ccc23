# SPDX-License-Identifier: Apache-2.0
"""The rule `unknown-attribute`, which unknown_attribute.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import removal
from roaml.language import BEHAVIOR_TREE
from roaml.language.validate import UnknownAttribute
from roaml.rules.rule import FileContext, Rule, close_names, did_you_mean, replacements
from roaml.rules.support import misspelled

WITHOUT_CONDITION = (
    "ros_action_handle_success_result",
    "ros_action_handle_canceled_result",
    "ros_action_handle_aborted_result",
    "ros_action_handle_thread_start",
    "bt_halt",
)


def check(context: FileContext) -> Iterator[Finding]:
    for violation in context.violations:
        if not isinstance(violation, UnknownAttribute):
            continue
        element, attribute, known = violation.element, violation.attribute, violation.type.attributes.values()
        if context.grammar is BEHAVIOR_TREE and element.name != "root" and attribute.name.startswith("_"):
            continue  # editors of trees keep their own data in these attributes
        free = [a.name for a in known if a.ignored is None and not a.use and element.get(a.name) is None]
        close = close_names(attribute.name, free) or misspelled.only_missing(element, violation.type, attribute.name)
        remove = Fix("Remove the attribute", (removal(context.source.text, attribute.span),), preferred=not close)
        if attribute.name == "cond" and element.name in WITHOUT_CONDITION:
            message = f"`<{element.name}>` does not support conditions; test the condition with an `<if>` inside it"
            yield RULE.at(attribute.name_span, message, severity=Severity.ERROR)
            continue
        # The reference translator rejects unknown attributes of <transition> and ignores all others
        # (docs/spec/differences.md#rejected-machines).
        certain = bool(close) or element.name == "transition"
        message = f"`<{element.name}>` has no attribute `{attribute.name}`{did_you_mean(close)}"
        yield RULE.at(
            attribute.name_span,
            message,
            *replacements(attribute.name_span, close),
            remove,
            severity=Severity.ERROR if certain else Severity.WARNING,
        )


RULE = Rule("unknown-attribute", Severity.ERROR, "An element has an unknown attribute.", file=check)
