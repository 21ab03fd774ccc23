# SPDX-License-Identifier: Apache-2.0
"""The scripts in the trees of a file."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Fix
from roaml.forest.scripts import ScriptUse, grammar_of, parsed, scripts_of
from roaml.model.tree import Tree
from roaml.rules.rule import TreeContext
from roaml.rules.support.forest import trees_of
from roaml.script.parse import ScriptProblem
from roaml.script.tree import Script
from roaml.text import TextEdit
from roaml.xml_syntax import Attribute
from roaml.xml_syntax.escapes import escape


def scripts(context: TreeContext) -> Iterator[tuple[Tree, ScriptUse, Script, tuple[ScriptProblem, ...]]]:
    """Each script of a file, with its tree, its use, and its syntax errors at their places in the file."""
    forest = trees_of(context)
    if forest is None:
        return
    grammar = grammar_of(forest.settings.version)
    for tree, node in forest.own_nodes:
        for use in scripts_of(forest, node):
            yield tree, use, *parsed(context.document.decoded(use.attribute.value_span), grammar)


def fixes(context: TreeContext, attribute: Attribute, problem: ScriptProblem) -> Iterator[Fix]:
    if problem.replacement:
        quote = context.source.text[attribute.value_span.start - 1]
        edit = TextEdit(problem.span, escape(problem.replacement, quote))
        yield Fix(f"Change to `{problem.replacement}`", (edit,), preferred=True)
