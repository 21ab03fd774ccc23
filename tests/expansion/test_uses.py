# SPDX-License-Identifier: Apache-2.0
"""Each place in which a parameter can be used, and what replaces it (docs/spec/parameters.md#uses)."""

from __future__ import annotations

from fractions import Fraction

import pytest

from roaml.expansion.problems import Problems
from roaml.expansion.text import expanded_text
from roaml.expansion.uses import ParameterUses
from roaml.expansion.values import ParameterValue
from roaml.language import BEHAVIOR_TREE, HL_SCXML, SYSTEM, XML_PROPERTIES
from roaml.xml_syntax import parse

GRAMMARS = {"ascxml": HL_SCXML, "roaml": SYSTEM, "root": BEHAVIOR_TREE, "properties": XML_PROPERTIES}
SCOPE = {
    "n": ParameterValue("int32", Fraction(5)),
    "less": ParameterValue("int32", Fraction(-2)),
    "p": ParameterValue("float64", Fraction(1, 4)),
    "on": ParameterValue("bool", True),
    "who": ParameterValue("string", "a'<b>"),
}
PLACES = """
ascxml|<state><transition cond="x &lt; n"/></state>|<transition cond="x &lt; 5"/>
ascxml|<state><transition cond="x.n == n &amp;&amp; y"/></state>|cond="x.n == 5 &amp;&amp; y"
ascxml|<state><transition cond="x == less"/></state>|cond="x == (-2)"
ascxml|<state><transition cond="!(on &amp;&amp; x)"/></state>|cond="!(true &amp;&amp; x)"
ascxml|<state><transition cond="x == who"/></state>|cond="x == 'a\\'&lt;b&gt;'"
ascxml|<state><transition cond="n > 4 ? x : y"/></state>|cond="true ? x : y"
ascxml|<state><transition cond="{'n': n}.n == x"/></state>|cond="{'n': 5}.n == x"
ascxml|<state><onentry><assign location="a[n]" expr="n"/></onentry></state>|location="a[5]" expr="5"
ascxml|<state><onentry><assign location="a"><expr>n + x</expr></assign></onentry></state>|<expr>5 + x</expr>
ascxml|<datamodel><data id="x" type="int32[n + 1][]" expr="[n, less]"/></datamodel>|type="int32[6][]" expr="[5, (-2)]"
ascxml|<datamodel><data id="x" expr="-n * 2"/></datamodel>|expr="-10"
ascxml|<datamodel><data id="x" lower_bound_incl="less"/></datamodel>|lower_bound_incl="-2"
ascxml|<datamodel><data id="x" type="float64" expr="p * 4"/></datamodel>|expr="1.0"
ascxml|<ros_time_rate name="t" rate_hz="n / 2"/>|rate_hz="2.5"
ascxml|<ros_time_rate name="t"><rate_hz>n</rate_hz></ros_time_rate>|<rate_hz>5</rate_hz>
ascxml|<ros_action_thread name="a" n_threads="n"/>|n_threads="5"
ascxml|<state><transition><target id="s" prob="1 - p"/></transition></state>|prob="0.75"
ascxml|<ros_topic_publisher name="t" topic="/$(var who)/x"/>|topic="/a'&lt;b&gt;/x"
ascxml|<state><onentry><send event="e"><param name="v" expr="n + x"/></send></onentry></state>|expr="5 + x"
ascxml|<ros_time_rate name="t" rate_hz="1 / (n - 2)"/>|rate_hz="0.3333333333333333"
ascxml|<datamodel><data id="x" type="int32" expr="less % 3 + 7 % (less - 1)"/></datamodel>|expr="2"
ascxml|<state id="s_$(var n)"/>|id="s_5"
ascxml|<state><transition cond="x == $(var who)"/></state>|cond="x == 'a\\'&lt;b&gt;'"
ascxml|<state><transition cond="x == 'I am $(var who)'"/></state>|cond="x == 'I am a\\'&lt;b&gt;'"
ascxml|<state><transition cond="x == 'it\\'s $(var n), $(var less)' + $(var who)"/></state>|'it\\'s 5, -2' + 'a\\'
ascxml|<state><transition cond="'a' == $(var who) &amp;&amp; x == 'b'"/></state>|"'a' == 'a\\'&lt;b&gt;' &amp;&amp; x
ascxml|<state><transition cond="x == n"/></state><datamodel><data id="n"/></datamodel>|cond="x == n"
roaml|<parameters><max_time value="2 * n" unit="s"/></parameters>|value="10"
roaml|<parameters><bt_tick_rate value="1 / p"/></parameters>|value="4"
roaml|<parameters><max_array_size value="n"/></parameters>|value="5"
roaml|<parameters><max_time value="1" unit="s" reaction_time="$(var n) ms"/></parameters>|reaction_time="5 ms"
root|<BehaviorTree ID="M"><A x="$(var n)" y="n"/></BehaviorTree>|x="5" y="n"
root|<BehaviorTree ID="M"><A _skipIf="z &lt; $(var p)"/></BehaviorTree>|_skipIf="z &lt; 0.25"
properties|<guarantees><property id="p"><event>x &gt; n</event></property></guarantees>|<event>x &gt; 5</event>
properties|<guarantees><property id="p"><time_interval within="n" time_unit="s"/></property></guarantees>|within="5"
properties|<guarantees><property id="p_$(var n)" expect="&gt;= $(var p)"/></guarantees>|id="p_5" expect="&gt;= 0.25"
"""


@pytest.mark.parametrize("line", PLACES.strip().splitlines(), ids=lambda line: line.split("|")[1].strip()[:60])
def test_a_use_is_replaced(line: str) -> None:
    root, content, expected = (part.strip() for part in line.split("|", 2))
    text = f"<{root}>{content}</{root}>"
    document = parse(text)
    assert not document.findings
    uses = ParameterUses(document, GRAMMARS[root], SCOPE, Problems(), frozenset())
    expanded = expanded_text("new", "old", text, uses.edits)
    assert expected in expanded.text, expanded.text
    assert not parse(expanded.text).findings
    for use in uses.uses:
        assert text[use.span.start : use.span.end] == use.name
