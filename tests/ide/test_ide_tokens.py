# SPDX-License-Identifier: Apache-2.0
"""Semantic tokens: above `----` a file, below it each token as `text: kind`, those of one line on one line.

An indented line continues the one before it. `+` marks declarations, `-` older spellings.
"""

from __future__ import annotations

import re
from textwrap import dedent

import pytest
from ide_case import analysis_of, marked, one_file, path_of

from fuzz.corpus import snippets, systems
from roaml import api
from roaml.ide.semantic_tokens import Modifier, SemanticToken, semantic_tokens
from roaml.project.explored_findings import CODES
from roaml.project.settings import Settings
from roaml.text import SourceFile

SHORT = {"attribute or key": "attribute", "tag of a part": "tag"}
MARKS = {Modifier.DECLARATION: "+", Modifier.DEPRECATED: "-"}

CASES = {
    "machine": """
        <ascxml name="🤖">
            <data id="x" type="int8" expr="1" />
            <state id="s">
                <transition event="e" cond="x &lt;= _event.data.y &amp;&amp; !true" target="s"/>
                <ros_topic_callback name="🤖" target="s" />
                <bt_return_status status="SUCCESS" />
                <assign location="x[0]" expr="Math.abs(x) + '🤖' ? a.b : -.5e1" />
                <param name="p"><expr> x +
                    1</expr></param>
            </state>
            <unknown a="1" />
        </ascxml>
        ----
        ascxml: tag; name: attribute; 🤖: tree, machine+
        data: tag; id: attribute; x: variable+; type: attribute; int8: type; expr: attribute; 1: number
        state: tag of a state; id: attribute; s: state+
        transition: tag of a transition; event: attribute; e: event; cond: attribute; x: variable; &lt;=: operator;
            _event: event variable; data: field, struct member or parameter; y: field, struct member or parameter;
            &amp;&amp;: operator; !: operator; true: literal word; target: attribute; s: state
        ros_topic_callback: tag of a ROS element; name: attribute; 🤖: ROS interface or timer; target: attribute;
            s: state
        bt_return_status: tag of the tree protocol; status: attribute; SUCCESS: name of a constant value
        assign: tag; location: attribute; x: variable; 0: number; expr: attribute; Math: library of functions;
            abs: function; x: variable; +: operator; '🤖': string; ?: operator; a: variable;
            b: field, struct member or parameter; :: operator; -: operator; .5e1: number
        param: tag; name: attribute; p: field, struct member or parameter+; expr: tag; x: variable; +: operator
        1: number; expr: tag; param: tag
        state: tag of a state
        a: attribute
        ascxml: tag
        """,
    "tree": """
        <root main_tree_to_execute="M">
            <BehaviorTree ID="M"><Sequence><Inverter><Go to="{🤖}" n="1" /></Inverter>
                <SubTree ID="B" /></Sequence></BehaviorTree>
        </root>
        ----
        root: tag; main_tree_to_execute: attribute; M: tree, machine
        BehaviorTree: tag; ID: attribute; M: tree, machine+; Sequence: tag of a control node;
            Inverter: tag of a decorator; Go: tag of an action, condition or plugin; to: attribute; {🤖}: variable;
            n: attribute; Inverter: tag of a decorator
        SubTree: tag of a subtree; ID: attribute; B: tree, machine; Sequence: tag of a control node; BehaviorTree: tag
        root: tag
        """,
    "older spelling": """
        <convince_mc_tc>
            <mc_parameters />
        </convince_mc_tc>
        ----
        convince_mc_tc: tag-
        mc_parameters: tag-
        convince_mc_tc: tag-
        """,
    "half-typed": """
        <ascxml>
            <state id="s"><assign expr="a + _msg.
            <transition cond="'🤖
        ----
        ascxml: tag
        state: tag of a state; id: attribute; s: state+; assign: tag; expr: attribute; a: variable; +: operator;
            _msg: event variable
        transition: tag of a transition; cond: attribute
        """,
    "properties": """
        {"properties": [{"name": "🤖", "expression":
            {"op": "=", "left": "x", "right": 1.5, "ok": false}}
        ----
        "properties": attribute; "name": attribute; "🤖": string; "expression": attribute
        "op": attribute; "=": operator; "left": attribute; "x": variable; "right": attribute; 1.5: number;
            "ok": attribute; false: literal word
        """,
}


@pytest.mark.parametrize("name", CASES)
def test_tokens(name: str) -> None:
    text, expected = dedent(CASES[name]).strip().split("\n----\n")
    analysis, path = one_file(text)
    assert shown(text, semantic_tokens(analysis, path)) == re.sub("\n +", " ", expected)


def shown(text: str, tokens: tuple[SemanticToken, ...]) -> str:
    source = SourceFile("", text)
    lines: dict[int, list[str]] = {}
    for span, kind, modifiers in tokens:
        marks = "".join(mark for modifier, mark in MARKS.items() if modifier in modifiers)
        word = f"{text[span.start : span.end]}: {SHORT.get(kind.value, kind.value)}{marks}"
        lines.setdefault(source.lines.position(span.start).line, []).append(word)
    return "\n".join("; ".join(words) for words in lines.values())


def test_range() -> None:
    text, _, [span] = marked('<ascxml>\n<state «id="🤖»"/>\n</ascxml>')
    analysis, path = one_file(text)
    texts = [text[token.span.start : token.span.end] for token in semantic_tokens(analysis, path, span)]
    assert texts == ["id", "🤖"]


def test_other_files_have_none() -> None:
    analysis = analysis_of({"page.xml": "<html a='1'/>", "model.jani": '{"jani-version": 1, "automata": []}'})
    assert not any(semantic_tokens(analysis, path_of(name)) for name in ("page.xml", "model.jani", "none.xml"))


def test_tokens_of_all_models_are_in_order_and_on_one_line() -> None:
    """Also of the first halves of their files."""
    for model in (*systems(), *snippets()[::5]):
        texts = {path: text[: len(text) // 2] for path, text in model.texts.items()}
        for result in (
            api.check([model.main], model.ros_paths, Settings(ignore=CODES), version)
            for version in (model.texts, texts)
        ):
            for path in result.files:
                tokens = semantic_tokens(result.snapshot.analysis, path)
                text = result.source(path).text
                edges = [edge for token in tokens for edge in token.span]
                assert edges == sorted(edges)
                assert all(start < end for start, end in (token.span for token in tokens))
                assert not any("\n" in text[slice(*token.span)] for token in tokens)
