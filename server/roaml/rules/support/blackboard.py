# SPDX-License-Identifier: Apache-2.0
"""Helpers of the rules about the blackboard."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.diagnostics import Fix
from roaml.model.expand import node_at
from roaml.model.system import BoundPort
from roaml.model.tree import is_variable_name
from roaml.rules.rule import TreeContext
from roaml.text import Span, TextEdit


def places(context: TreeContext, variable: str, ports: Iterable[BoundPort]) -> Iterator[tuple[BoundPort, Span, str]]:
    """The ports in `ports` that belong to nodes of this file, each with the place where it is bound and the name of the
    variable there.

    The place is the value of an attribute or, for a default of `<TreeNodesModel>`, the name of the node; the name of
    the variable is then "". A node with several instances is included once. Ports that are bound to a variable with an
    invalid name are left out; port-value reports them.
    """
    if not is_variable_name(variable):
        return
    seen: set[tuple[str, int, str]] = set()
    for bound in ports:
        source = bound.source
        key = (source.tree, source.position, bound.port.key)
        if source.path != context.source.path or key in seen:
            continue
        seen.add(key)
        node = node_at(context.file, source)
        if node is None:
            continue
        setting = next((s for s in node.ports if s.key.value == bound.port.key), None)
        if setting is not None:
            written = setting.variable or ""
            if is_variable_name(written):
                yield bound, setting.value.span, written
        else:
            yield bound, node.plugin.span if node.plugin else node.element.name_span, ""


def described(variable: str, written: str) -> str:
    """A phrase for a variable of an executed tree; `written` is its name inside a subtree, which may differ."""
    if written in ("", variable, f"@{variable}"):
        return f"the blackboard variable `{variable}`"
    if variable.endswith(f"__{written}"):
        return f"`{written}`, which is a variable of this subtree only"
    return f"`{written}`, which is the blackboard variable `{variable}` here"


def renamings(span: Span, written: str, variable: str, close: Iterable[str]) -> Iterator[Fix]:
    """A fix for each name in `close` that replaces the reference `{written}` at `span`, the first one preferred. There
    are none inside subtrees, where the variable has another name."""
    if written == variable:
        for number, name in enumerate(close):
            yield Fix(f"Change to `{{{name}}}`", (TextEdit(span, f"{{{name}}}"),), preferred=number == 0)
