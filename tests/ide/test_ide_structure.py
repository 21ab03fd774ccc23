# SPDX-License-Identifier: Apache-2.0
"""Folding, growing selections, linked names, closing of tags, links. `‸` is a caret, `«…»` a span."""

from __future__ import annotations

from textwrap import dedent

import pytest
from ide_case import analysis_of, marked, one_file, path_of, several_files

from fixture import read_marks, split_files
from roaml.ide.folding_range import FoldKind, folds
from roaml.ide.linked_editing import linked_names
from roaml.ide.navigation.document_links import links
from roaml.ide.on_type import close_tag
from roaml.ide.selection_range import selections
from roaml.text import TextEdit, apply_edits

# -------------------------------------------------------------------- folding

FOLDED = {
    "elements, attributes, comments": """
        <ascxml                        | 0-2
            name="🤖"
            version="1.0">             | 2-15
            <!-- one line -->
            <!-- several               | 4-5 comment
                 lines -->
            <state id="a">             | 6-10
                <onentry><!--          | 7-8
                    --></onentry>
                <script><![CDATA[      | 9-10
                ]]></script>
            </state>
            <state id="b"><onexit>     | 12-13
            </onexit></state>
            <state id="c">
            </state>
        </ascxml>
        """,
    "regions": """
        <ascxml>                                | 0-9
            <!-- #region Docking -->            | 1-6
            <state id="a"/>
            <!--#region-->                      | 3-5
            <state id="b"/>
            <!--#endregion b-->
            <!-- #endregion -->
            <!-- #endregion -->
            <!-- #regional -->
            <!-- #region without an end -->
        </ascxml>
        """,
    "half-typed": """
        <ascxml>                       | 0-3
            <state id="a">             | 1-3
                <transition            | 2-3
                    event="🤖
        </ascxml
        """,
    "properties": """
        {"properties": [               | 0-5
            {                          | 1-3
                "name": "🤖",
                "list": [1, 2]
            },
            {}
        ]}
        """,
}


@pytest.mark.parametrize("name", FOLDED)
def test_folding(name: str) -> None:
    lines = [line.partition("|") for line in dedent(FOLDED[name]).strip().split("\n")]
    analysis, path = one_file("\n".join(line.rstrip() for line, _, _ in lines))
    shown = [f"{f.first}-{f.last}{' comment' if f.kind is FoldKind.COMMENT else ''}" for f in folds(analysis, path)]
    expected = [mark.strip() for _, _, mark in lines if mark]
    assert shown == expected


# ------------------------------------------------------------------ selection

SELECTED = {
    "expression": (
        '<ascxml>\n<assign location="x" expr="a &lt; (b‸1 + \'🤖\')"/></ascxml>',
        ["b1", "b1 + '🤖'", "a &lt; (b1 + '🤖')", "\"a &lt; (b1 + '🤖')\"", "expr=\"a &lt; (b1 + '🤖')\""],
    ),
    "attribute name": ('<ascxml>\n<state i‸d="🤖"/></ascxml>', ["id", 'id="🤖"', '<state id="🤖"/>']),
    "value": ("<ascxml>\n<state id='🤖‸'/></ascxml>", ["🤖", "'🤖'", "id='🤖'", "<state id='🤖'/>"]),
    "end tag": ("<ascxml>\n<state>\n</st‸ate></ascxml>", ["state", "</state>", "<state>\n</state>"]),
    "text": ("<ascxml>\n<expr> '🤖' + ‸a </expr></ascxml>", ["a", "'🤖' + a", " '🤖' + a ", "<expr> '🤖' + a </expr>"]),
    "comment": ("<ascxml>\n<!-- 🤖‸ --></ascxml>", [" 🤖 ", "<!-- 🤖 -->", "\n<!-- 🤖 -->"]),
    "properties": (
        '{"properties": [{"name": "🤖‸"}]}',
        ["🤖", '"🤖"', '"name": "🤖"', '{"name": "🤖"}', '[{"name": "🤖"}]', '"properties": [{"name": "🤖"}]'],
    ),
    "key": ('{"prop‸erties": []}', ["properties", '"properties"', '"properties": []', '{"properties": []}']),
    "half-typed": ('<ascxml>\n<assign expr="a +‸\n</ascxml>', ["a +", '"a +', 'expr="a +', '<assign expr="a +\n']),
    "outside": ("<ascxml/>\n‸", ["<ascxml/>\n"]),
}


@pytest.mark.parametrize("name", SELECTED)
def test_selections(name: str) -> None:
    written, expected = SELECTED[name]
    text, [offset], _ = marked(written)
    analysis, path = one_file(text)
    spans = selections(analysis, path, offset)
    assert [text[span.start : span.end] for span in spans][: len(expected)] == expected
    assert spans[-1] == (0, len(text))


# --------------------------------------------------------------- linked names


@pytest.mark.parametrize(
    "written",
    [
        '<ascxml>\n<«st‸ate» id="🤖"><onentry/></«state»></ascxml>',
        "<ascxml>\n<«state»>🤖</«state‸»></ascxml>",
        "<ascxml>\n<«‸p:x»></«p:x»></ascxml>",
        "<ascxml>\n<state><‸a/></state></ascxml>",
        "<ascxml>\n<state i‸d='x'></state></ascxml>",
        "<ascxml>\n<stat‸e></stte></ascxml>",
        "<ascxml>\n<state‸></ascxml>",
        "<ascxml>\n<state></‸></ascxml>",
        "‸",
    ],
)
def test_linked_names(written: str) -> None:
    text, [offset], spans = marked(written)
    analysis, path = one_file(text)
    assert list(linked_names(analysis, path, offset)) == spans


# -------------------------------------------------------------------- closing


@pytest.mark.parametrize(
    ("written", "inserted"),
    [
        ('<ascxml>\n<state id="🤖">‸\n</ascxml>', "</state>"),
        ("<ascxml>‸", "</ascxml>"),
        ("<ascxml><state>‸<onentry/></ascxml>", "</state>"),
        ("<ascxml><if><if>‸</if></ascxml>", "</if>"),
        ("<ascxml><p:x>‸</ascxml>", "</p:x>"),
        ("<ascxml><state>‸</state></ascxml>", ""),
        ("<ascxml><state/>‸</ascxml>", ""),
        ("<ascxml><!-- <a>‸ --></ascxml>", ""),
        ("<ascxml><state></state>‸</ascxml>", ""),
        ('<ascxml><if cond="a >‸"/></ascxml>', ""),
        ("<ascxml><state>🤖</‸\n</ascxml>", "state>"),
        ("<ascxml><state></state></‸", "ascxml>"),
        ("<ascxml><state></‸></ascxml>", "state"),
        ("<ascxml><!-- </‸ --></ascxml>", ""),
        ("<ascxml><state id='</‸'/></ascxml>", ""),
        ("<ascxml></ascxml></‸", ""),
        ("<ascxml><state id='🤖' /‸\n</ascxml>", ">"),
        ("<ascxml><state /‸</ascxml>", ">"),
        ("<ascxml><state /‸></ascxml>", ""),
        ("<ascxml><state id='a/‸'/></ascxml>", ""),
        ("<ascxml><state /‸ id='a'></state></ascxml>", ""),
        ("<ascxml>a/‸b</ascxml>", ""),
        ("{/‸}", ""),
        ("‸", ""),
    ],
)
def test_closing(written: str, inserted: str) -> None:
    text, [offset], _ = marked(written)
    analysis, path = one_file(text)
    edit = close_tag(analysis, path, offset)
    assert edit == (TextEdit((offset, offset), inserted) if inserted else None)


def test_a_machine_typed_with_closing_is_well_formed() -> None:
    text, analysis, path = "", *one_file("")
    for character in '<ascxml name="🤖"><state id="a"><transition target="a"/><onentry>':
        text += character
        offset = len(text)
        analysis, path = one_file(text)
        if (edit := close_tag(analysis, path, offset)) and edit.new_text == ">":
            text = apply_edits(text, (edit,))[:offset]  # the editor types over what is there
    for _ in range(3):
        text += "</"
        analysis, path = one_file(text)
        edit = close_tag(analysis, path, len(text))
        assert edit
        text = apply_edits(text, (edit,))
    assert text.endswith("<onentry></onentry></state></ascxml>")


# ---------------------------------------------------------------------- links


def test_links() -> None:
    written = """\
-- main.xml --
<roaml>
    <behavior_tree>
        <input type="bt.cpp-xml" src=" tree.xml " />
                                       ^^^^^^^^ tree-xml
        <input type="bt-plugin-ascxml" src="plugins/🤖.ascxml" />
                                            ^^^^^^^^^^^^^^^^ plugins-x-ascxml
        <input type="bt-plugin-ascxml" src="none.ascxml" />
        <input type="bt-plugin-ascxml" src="
-- tree.xml --
<root BTCPP_format="4">
    <include path="./more.xml" />
                   ^^^^^^^^^^ more-xml
    <include path="more.xml" ros_pkg="other" />
    <include path="" />
    <BehaviorTree ID="A" />
</root>
-- more.xml --
<root BTCPP_format="4"><BehaviorTree ID="B" /></root>
-- plugins/🤖.ascxml --
<ascxml />
"""
    read = {name: read_marks(name, text) for name, text in split_files(written).items()}
    analysis = analysis_of({name: text for name, (text, _) in read.items()})
    names = {path_of(name): name.replace("/", "-").replace(".", "-").replace("🤖", "x") for name in read}
    for name, (_, marks) in read.items():
        rows = [(link.span.start, link.span.end, names[link.target]) for link in links(analysis, path_of(name))]
        assert rows == [(mark.start, mark.end, mark.code) for mark in marks]


def test_files_that_are_not_there() -> None:
    analysis = several_files("<roaml/>")
    path = path_of("none.xml")
    assert not folds(analysis, path)
    assert not selections(analysis, path, 0)
    assert not linked_names(analysis, path, 0)
    assert not links(analysis, path)
    assert close_tag(analysis, path, 0) is None
