# SPDX-License-Identifier: Apache-2.0
"""The rule `unused-plugin`, which unused_plugin.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity, Tag
from roaml.model.gaps import GapAct
from roaml.model.system_file import SystemSection
from roaml.rules.rule import Rule, SystemContext


def check(context: SystemContext) -> Iterator[Finding]:
    system = context.system
    if not system.instances:
        return
    used = {instance.plugin for instance in system.instances}
    names = {path: outline.name for path, outline in system.plugins}
    for listed in context.files:
        src, name = listed.input.src, names.get(listed.path)
        if (
            listed.input.section is SystemSection.BEHAVIOR_TREE
            and src is not None
            and name is not None
            and name not in used
        ):
            if system.may(GapAct.NODE, name):
                continue
            yield RULE.at(src.span, f"the tree never uses the plugin `{name}`", tags=(Tag.UNNECESSARY,))


RULE = Rule("unused-plugin", Severity.HINT, "The tree never uses a plugin that is listed.", system=check)
