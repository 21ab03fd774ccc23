# SPDX-License-Identifier: Apache-2.0
"""Properties beside plain SCXML: read as a property file again, they say the same of the same traces."""

from __future__ import annotations

import pytest
from storm import exact
from test_equivalent_properties import EQUIVALENTS, files
from test_translate_observers import PORTS, system
from translating import loaded

from roaml import api
from roaml.scxml.lowered_properties import lowered_properties
from roaml.scxml.writer import write

WRITTEN = [key for key in EQUIVALENTS if "existence" not in key[1] and "response" not in key[1] and key[0] == "link"]


@pytest.mark.parametrize("key", WRITTEN, ids=" ".join)
def test_the_document_says_the_same(key: tuple[str, str]) -> None:
    original = files(key[0], EQUIVALENTS[key][0], [])
    source = loaded(original)
    lowered = lowered_properties(api.to_scxml(source), source.observed)
    assert not lowered.left_out
    again = loaded({**original, "properties.xml": lowered.text})
    before, after = exact(api.to_jani(source), "p"), exact(api.to_jani(again), "p")
    assert (after.least, after.greatest) == pytest.approx((before.least, before.greatest), abs=1e-6)


def test_a_deadline_can_be_lowered_and_an_answer_at_any_time_cannot() -> None:
    response = """<property id="{}" pattern="response"><events><event>heads</event><event>whistle</event></events>
        <scope type="globally" />{}</property>"""
    timed = '<time_interval time="2" time_unit="s" />'
    source = loaded(system(response.format("soon", timed) + response.format("some_day", "")))
    lowered = lowered_properties(api.to_scxml(source), source.observed)
    assert [property_.name for property_, _ in lowered.left_out] == ["some_day"]
    assert "no deadline" in lowered.left_out[0][1]
    assert 'id="soon"' in lowered.text
    assert "since[3:]" in lowered.text


def test_an_answer_that_comes_with_the_clock_is_late() -> None:
    """The clock makes a step after `heads`, which then is not true any more: later than the deadline."""
    response = """<property id="p" pattern="response">
        <events><event>heads &amp;&amp; count == 1</event><event>!heads</event></events>
        <scope type="globally" /><time_interval time="0" time_unit="s" /></property>"""
    original = system(response)
    source = loaded(original)
    lowered = lowered_properties(api.to_scxml(source), source.observed)
    before = exact(api.to_jani(source), "p")
    after = exact(api.to_jani(loaded({**original, "properties.xml": lowered.text})), "p")
    assert (before.least, before.greatest) == pytest.approx((0.7**6, 0.7**6), abs=1e-6)
    # The formula is not violated by `heads` after the last step of the clock. The coin can be tossed a second late.
    assert (after.least, after.greatest) == pytest.approx((0.7**5, 0.7**4), abs=1e-6)


def test_ports_name_machines_of_the_folder() -> None:
    absence = """<property id="p" pattern="absence"><event>tails || count == 3</event>
        <scope type="globally" /></property>"""
    source = loaded(system(absence))
    network = api.to_scxml(source)
    lowered = lowered_properties(network, source.observed)
    names = {name for name, _ in write(network)}
    assert 'event="topic_tails_msg" origin="Coin" target="NONE"' in lowered.text
    assert 'event="topic_heads_msg" origin="Coin" target="Judge"' in lowered.text
    assert '<state_var id="count" type="int32" param="ros_fields__data" expr="7"/>' in lowered.text
    assert lowered.names_nobody
    assert {"Coin", "Judge"} <= names
    assert PORTS not in lowered.text


def test_without_properties_nothing_is_written() -> None:
    source = loaded(system(""))
    assert lowered_properties(api.to_scxml(source), source.observed).text == ""
