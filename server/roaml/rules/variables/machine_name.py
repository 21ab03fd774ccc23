# SPDX-License-Identifier: Apache-2.0
"""The rule `machine-name`, which machine_name.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.model.system import builtin_plugins
from roaml.model.system_file import SystemSection
from roaml.model.tree import EXPLICIT, SUBTREES
from roaml.rules.rule import MachineContext, Rule, replacements
from roaml.rules.support.names import WrongName
from roaml.scxml.names import safe_name
from roaml.text import TextEdit


def check(context: MachineContext) -> Iterator[Finding]:
    name = context.machine.name
    if name is None:
        attribute = context.machine.element.get("name")
        if attribute is not None:
            stem = safe_name(context.source.path.replace("\\", "/").rpartition("/")[2].partition(".")[0])
            fixes = [Fix(f"Name the machine `{stem}`", (TextEdit(attribute.span, f'name="{stem}"'),))] if stem else []
            yield RULE.at(attribute.span, "the name of the machine is empty; set `name`", *fixes)
        return
    if SystemSection.BEHAVIOR_TREE in context.listed_as and name.value in builtin_plugins():
        message = f"`{name.value}` is the name of a node of BehaviorTree.CPP; rename the plugin"
        yield RULE.at(name.span, message, facts=WrongName(name.value))
    elif SystemSection.BEHAVIOR_TREE in context.listed_as and name.value in (*EXPLICIT, *SUBTREES):
        message = f"`<{name.value}>` has a special meaning in trees; rename the plugin"
        yield RULE.at(name.span, message, facts=WrongName(name.value))
    elif (safe := safe_name(name.value)) != name.value:
        message = f"`{name.value}` is not an identifier; generated names use `{safe}`"
        # The tree, if there is one, would have to be changed as well.
        fixes = [] if SystemSection.BEHAVIOR_TREE in context.listed_as else [*replacements(name.span, [safe])]
        yield RULE.at(name.span, message, *fixes, severity=Severity.WARNING, facts=WrongName(name.value))


RULE = Rule(
    "machine-name",
    Severity.ERROR,
    "The name of a machine is empty, already used or not an identifier.",
    machine=check,
    facts=WrongName,
)
