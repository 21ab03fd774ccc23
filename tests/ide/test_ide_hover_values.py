# SPDX-License-Identifier: Apache-2.0
"""Hover texts with the values that a variable or field can have at a place."""

from __future__ import annotations

import pytest

from roaml.ide.hover import hover
from roaml.project.settings import Settings
from roaml.project.workspace import Workspace

MACHINE = """<ascxml name="Retry" version="1.0" initial="trying">
    <datamodel>
        <data id="tries" type="int32" expr="0" />
        <data id="mode" type="string" expr="'slow'" />
        <data id="free" type="float32" expr="0.5" />
    </datamodel>
    <state id="trying">
        <transition event="failed" cond="tries &lt; 5" target="trying">
            <assign location="tries" expr="tries + 1" />
            <assign location="mode" expr="'fast'" />
            <assign location="free" expr="_event.data.x" />
        </transition>
        <transition event="failed" cond="tries == 5" target="lost" />
    </state>
    <state id="lost">
        <transition event="e" cond="tries &gt; 2 &amp;&amp; free &gt; 0.1 &amp;&amp; mode == 'fast'" target="lost" />
    </state>
</ascxml>"""


def text_at(mark: str) -> str:
    offset = MACHINE.index(mark.replace("|", "")) + mark.index("|") + 1
    workspace = Workspace((), Settings())
    workspace.open("/retry.ascxml", MACHINE)
    found = hover(workspace.snapshot().analysis, "/retry.ascxml", offset)
    assert found is not None
    return found.text


@pytest.mark.parametrize(
    ("mark", "expected"),
    [
        ('id="|tries', "Values: between 0 and 5."),
        ('id="|mode', "Values: `'fast'` or `'slow'`."),
        ('expr="|tries + 1', "Value here: between 0 and 4."),
        ('cond="|tries &gt; 2', "Value here: 5."),
        ("&amp;&amp; |mode ==", "Value here: `'fast'` or `'slow'`."),
    ],
)
def test_values(mark: str, expected: str) -> None:
    assert text_at(mark).endswith(f"\n\n{expected}")


@pytest.mark.parametrize("mark", ['id="|free', "&amp;&amp; |free"])
def test_a_variable_with_unknown_values_has_none(mark: str) -> None:
    assert "Value" not in text_at(mark)
