# SPDX-License-Identifier: Apache-2.0
"""The rule `node-model`, which node_model.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.edit.elements import rename_tag
from roaml.forest.cpp_types import SIMPLE_TYPES, normal
from roaml.forest.forest import CPP, Forest
from roaml.libraries import Node
from roaml.model.tree import NodeModel, PortModel
from roaml.rules.rule import Rule, TreeContext, did_you_mean, listing, replacements
from roaml.rules.support.forest import forest_of, probably_meant
from roaml.suggest import close_names


def check(context: TreeContext) -> Iterator[Finding]:
    forest = forest_of(context)
    if forest is None:
        return
    for model in context.file.models:
        if model.is_subtree:
            yield from _subtree(forest, model)
        declaration = CPP.nodes.get(model.id.value) if model.id is not None else None
        for port in model.ports:
            yield from _type(port)
            if declaration is not None and not declaration.until:
                yield from _of_library(declaration, port)


def _subtree(forest: Forest, model: NodeModel) -> Iterator[Finding]:
    if model.id is None or model.id.value in forest.trees or not forest.complete:
        return
    near = probably_meant(model.id.value, forest.trees)
    if near is not None and near not in forest.subtree_models:
        message = f"there is no tree `{model.id.value}`{did_you_mean((near,))}"
        yield RULE.at(model.id.span, message, *replacements(model.id.span, (near,)))


def _type(port: PortModel) -> Iterator[Finding]:
    """Report a misspelled type. Only names of lower-case letters are checked: other names may be types that a program
    defines."""
    attribute = port.element.get("type")
    written = port.type.strip()
    if attribute is None or not written.isascii() or not written.isalpha() or not written.islower():
        return
    if normal(written) in SIMPLE_TYPES:
        return
    near = probably_meant(written, SIMPLE_TYPES) or _swapped(written)
    if near is not None:
        message = f"unknown type `{written}`{did_you_mean((near,))}"
        yield RULE.at(attribute.value_span, message, *replacements(attribute.value_span, (near,)))


def _swapped(written: str) -> str | None:
    """The simple type with the same letters, such as `int` for `itn`; `None` if there is none."""
    return next((name for name in SIMPLE_TYPES if sorted(name) == sorted(written)), None)


def _of_library(declaration: Node, port: PortModel) -> Iterator[Finding]:
    if port.name is None:
        return
    known = declaration.port(port.name.value)
    names = [other.name for other in declaration.ports if not other.alias_of]
    if known is None:
        close = close_names(port.name.value, names)
        hint = did_you_mean(close) or (f"; it has {listing(names)}" if names else "; it has no ports")
        message = f"`{declaration.name}` of BehaviorTree.CPP has no port `{port.name.value}`{hint}"
        yield RULE.at(port.name.span, message, *replacements(port.name.span, close), severity=Severity.INFORMATION)
    elif not known.alias_of and port.direction is not known.direction:
        tag = {"in": "input_port", "out": "output_port", "inout": "inout_port"}[known.direction.value]
        message = f"the port `{port.name.value}` of `{declaration.name}` is an `<{tag}>`"
        fix = rename_tag(port.element, tag)
        yield RULE.at(port.element.name_span, message, fix, severity=Severity.INFORMATION)


RULE = Rule(
    "node-model",
    Severity.WARNING,
    "A model in `<TreeNodesModel>` has an unknown tree or type, or contradicts BehaviorTree.CPP.",
    tree=check,
)
