# SPDX-License-Identifier: Apache-2.0
"""Formatting: the input is above `----`, the result below."""

from __future__ import annotations

from textwrap import dedent

import pytest
from ide_case import analysis_of, marked, one_file, path_of

from roaml.ide.formatting import can_format, format_edits
from roaml.ide.formatting.layout import FileLayout
from roaml.text import apply_edits


def formatted(text: str, layout: FileLayout | None = None) -> str:
    analysis, path = one_file(text)
    edits = format_edits(analysis, path, layout or FileLayout())
    assert all(text[edit.span.start : edit.span.end] != edit.new_text for edit in edits)
    return apply_edits(text, edits)


def case(written: str) -> tuple[str, str]:
    before, after = dedent(written).strip("\n").split("\n----\n")
    return before + "\n", after + "\n"


CASES = {
    "indentation": """
        <ascxml name="a">
          <datamodel>
              <data id="x" type="int8" expr="1"/></datamodel>
        <state id="s"><onentry><assign location="x" expr="2"  /></onentry>
                <transition   event = "e"  target='s'></transition >
          </state></ascxml>
        ----
        <ascxml name="a">
            <datamodel>
                <data id="x" type="int8" expr="1" />
            </datamodel>
            <state id="s">
                <onentry><assign location="x" expr="2" /></onentry>
                <transition event="e" target='s'></transition>
            </state>
        </ascxml>
        """,
    "blank lines": """
        <?xml version="1.0"?><!-- 🤖 -->


        <ascxml>

          <datamodel />



          <state id="a">
             \t
          </state>


        </ascxml>


        ----
        <?xml version="1.0"?> <!-- 🤖 -->

        <ascxml>

            <datamodel />

            <state id="a">
            </state>

        </ascxml>
        """,
    "comments, instructions and CDATA": """
        <ascxml>   <!-- why   so -->
        <!--  two
          lines -->   <!-- more -->
        <?keep   me?>
        <state id="🤖"/><!-- behind -->
        <script>  <![CDATA[ a  <  b ]]>
           </script>
        <a><!-- only --></a>
        </ascxml>
        ----
        <ascxml> <!-- why   so -->
            <!--  two
          lines --> <!-- more -->
            <?keep   me?>
            <state id="🤖" /> <!-- behind -->
            <script>  <![CDATA[ a  <  b ]]>
           </script>
            <a><!-- only --></a>
        </ascxml>
        """,
    "text": """
        <ascxml>
          <data id="x"  type="int8"><expr>1 +
             2 </expr></data>
          <script  src = "a">  a = 1;
            b = 2;  <x/>
             </script>
          <p xml:space="preserve"><q/>  <r/></p>
        </ascxml>
        ----
        <ascxml>
            <data id="x" type="int8">
                <expr>1 +
             2 </expr>
            </data>
            <script src="a">  a = 1;
            b = 2;  <x/>
             </script>
            <p xml:space="preserve"><q/>  <r/></p>
        </ascxml>
        """,
    "wrapped attributes stay wrapped": """
        <ascxml
            name="a" version="1.0"
          initial="s"
        >
        <state id="s"
         extra="1"
           more="2"/>
        </ascxml>
        ----
        <ascxml
            name="a"
            version="1.0"
            initial="s">
            <state id="s"
                   extra="1"
                   more="2" />
        </ascxml>
        """,
    "long tags are wrapped": f"""
        <ascxml name="a">
        <state id="{"s" * 82}"/>
        <state id="{"s" * 68}" class="{"c" * 4}" />
        <state id="{"s" * 68}" class="{"c" * 5}" />
        <state id="{"s" * 99}" />
        </ascxml>
        ----
        <ascxml name="a">
            <state id="{"s" * 82}" />
            <state id="{"s" * 68}" class="{"c" * 4}" />
            <state
                id="{"s" * 68}"
                class="{"c" * 5}" />
            <state id="{"s" * 99}" />
        </ascxml>
        """,
    "what is on one line stays there if it fits": f"""
        <ascxml>
        <a><b><c/></b></a>
        <a><b/><c/></a>
        <a> <b x="{"x" * 79}"/> </a>
        <a> <b x="{"x" * 80}"/> </a>
        </ascxml>
        ----
        <ascxml>
            <a><b><c /></b></a>
            <a>
                <b />
                <c />
            </a>
            <a><b x="{"x" * 79}" /></a>
            <a>
                <b x="{"x" * 80}" />
            </a>
        </ascxml>
        """,
    "alternatives": """
        <ascxml>
            <if cond="a">
              <raise event="e"/>
            <elseif cond="b"/>
              <raise event="f"/>
            <else/>
            </if>
            <if cond="a"><raise event="e"/><else/><raise event="f"/></if>
            <if cond="a">
                    <raise event="e"/>
                 <else/>
            </if>
        </ascxml>
        ----
        <ascxml>
            <if cond="a">
                <raise event="e" />
            <elseif cond="b" />
                <raise event="f" />
            <else />
            </if>
            <if cond="a">
                <raise event="e" />
            <else />
                <raise event="f" />
            </if>
            <if cond="a">
                <raise event="e" />
                <else />
            </if>
        </ascxml>
        """,
    "properties": """
        { "properties" : [
           {"name":"a" ,
            "expression":{"op":"initial"},  "empty":[ ], "none": { }

            , "list": [1,2 , -3.5e1]},
              { "name": "🤖 \\" {, ", "ok": true } ] }
        ----
        {
            "properties": [
                {
                    "name": "a",
                    "expression": { "op": "initial" },
                    "empty": [],
                    "none": {},
                    "list": [1, 2, -3.5e1]
                },
                { "name": "🤖 \\" {, ", "ok": true }
            ]
        }
        """,
    "properties with two columns": """
        {
          "properties": [
          ],
            "more": {
         "a": 1}}
        ----
        {
          "properties": [],
          "more": {
            "a": 1
          }
        }
        """,
    "long lists": f"""
        {{"properties": [], "long": ["{"a" * 40}", "{"b" * 40}"]}}
        ----
        {{
            "properties": [],
            "long": ["{"a" * 40}", "{"b" * 40}"]
        }}
        """,
}


@pytest.mark.parametrize("name", CASES)
def test_cases(name: str) -> None:
    before, after = case(CASES[name])
    assert formatted(before) == after
    assert formatted(after) == after


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("name", CASES)
def test_line_ends_are_kept(name: str, end: str) -> None:
    before, after = (text.replace("\n", end) for text in case(CASES[name]))
    assert formatted(before) == after


@pytest.mark.parametrize(
    "text",
    [
        "",
        "<ascxml",
        "<ascxml>\n<state",
        '<ascxml>\n<state id="a></ascxml>',
        "<ascxml>\n<state>\n</ascxml>",
        "<ascxml>\n" + "<a>" * 120 + "</a>" * 120 + "</ascxml>",
        '{"properties": [',
        '{ "properties": [], }',
    ],
)
def test_files_that_are_not_well_formed_are_not_formatted(text: str) -> None:
    analysis, path = one_file(text)
    assert format_edits(analysis, path) == ()
    assert not can_format(analysis, path)


def test_files_of_others_are_left_alone() -> None:
    text = "<html>\n<p/></html>"
    analysis = analysis_of({"page.xml": text, "more.json": '{ "a":1}', "main.xml": text.replace("html", "roaml")})
    assert [can_format(analysis, path_of(name)) for name in ("page.xml", "more.json", "none.xml")] == [False] * 3
    assert can_format(analysis, path_of("main.xml"))


def test_edits_are_small() -> None:
    text = '<ascxml>\r\n  <state id="a"/>\r\n\r\n\r\n    <state  id="b" />\r\n</ascxml>\r\n'
    analysis, path = one_file(text)
    rows = [(text[edit.span.start : edit.span.end], edit.new_text) for edit in format_edits(analysis, path)]
    assert rows == [("", "  "), ("", " "), ("\r\n", ""), (" ", "")]


def test_layouts() -> None:
    text = '<ascxml>\n  <state id="a"\n  b="c"/></ascxml>'
    assert formatted(text, FileLayout(width=2)) == '<ascxml>\n  <state id="a"\n         b="c" />\n</ascxml>\n'
    assert formatted(text, FileLayout(tabs=True)) == '<ascxml>\n\t<state id="a"\n\t       b="c" />\n</ascxml>\n'
    assert formatted('{"a": [\n]}', FileLayout(width=3)) == '{\n   "a": []\n}\n'


def test_range() -> None:
    text, _, [span] = marked("<ascxml>\n<a/>\n<«b/>\n\n\n<»c/>\n<d/></ascxml>")
    analysis, path = one_file(text)
    result = apply_edits(text, format_edits(analysis, path, within=span))
    assert result == "<ascxml>\n<a/>\n    <b />\n\n    <c />\n<d/></ascxml>"
