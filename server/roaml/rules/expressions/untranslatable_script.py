# SPDX-License-Identifier: Apache-2.0
"""untranslatable-script: see untranslatable_script.md."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import removal
from roaml.model.tree import nodes
from roaml.rules.rule import Rule, TreeContext
from roaml.xml_syntax import Attribute


def check(context: TreeContext) -> Iterator[Finding]:
    for tree in context.file.trees if context.forest is None else ():
        for node in nodes(tree):
            for script in node.scripts:
                if script.has_value:
                    yield from _check(context, script, in_system=context.system is not None)


def _check(context: TreeContext, script: Attribute, *, in_system: bool) -> Iterator[Finding]:
    reason = unbalanced(script.value)
    if reason:
        yield RULE.at(script.value_span, f"the script is not well-formed: {reason}")
    elif in_system:
        message = f"`{script.name}` cannot be translated: the model does not support scripts"
        drop = Fix(f"Remove `{script.name}`", (removal(context.source.text, script.span),), preferred=False)
        yield RULE.at(script.span, message, drop)


PAIRS = {")": "(", "]": "[", "}": "{"}


def unbalanced(script: str) -> str:
    """The error in the brackets and quotes of a script; "" if there is none."""
    opened: list[str] = []
    quote = ""
    for character in script:
        if quote:
            quote = "" if character == quote else quote
        elif character in "'\"":
            quote = character
        elif character in PAIRS.values():
            opened.append(character)
        elif character in PAIRS and (not opened or opened.pop() != PAIRS[character]):
            return f"`{character}` closes nothing"
    if quote:
        return f"a {quote} is never closed"
    if opened:
        return f"`{opened[-1]}` is never closed"
    return ""


RULE = Rule(
    "untranslatable-script",
    Severity.ERROR,
    "A node has a script, which cannot be translated.",
    tree=check,
)
