# SPDX-License-Identifier: Apache-2.0
"""JUnit XML (`as2fm_lsp.junit`)."""

from __future__ import annotations

import xml.etree.ElementTree as ET

from as2fm_lsp.junit import Case, CaseOutcome, render


def test_counts_and_outcomes() -> None:
    cases = [
        Case("file", "good"),
        Case("file", "said", text="words", seconds=0.25),
        Case("file", "bad", CaseOutcome.FAILED, "words", "why", "error"),
        Case("file", "broken", CaseOutcome.ERROR, "words", "why", properties=(("a", "b"),)),
    ]
    suites = ET.fromstring(render("check", cases))
    (suite,) = suites
    for element in (suites, suite):
        assert [element.get(key) for key in ("tests", "failures", "errors")] == ["4", "1", "1"]
    assert suite.get("name") == "check"
    good, said, bad, broken = suite
    assert (dict(good.attrib), list(good)) == ({"classname": "file", "name": "good"}, [])
    assert said.get("time") == "0.250"
    assert [(child.tag, child.attrib, child.text) for child in said] == [("system-out", {}, "words")]
    assert [(child.tag, child.attrib) for child in bad] == [("failure", {"type": "error", "message": "why"})]
    assert [child.tag for child in broken] == ["properties", "error"]
    assert [entry.attrib for entry in broken.iter("property")] == [{"name": "a", "value": "b"}]


def test_any_text_is_valid_xml() -> None:
    """Names and messages come from models, which may contain any character."""
    evil = "a\x00b\x1b\ud800\uffff<&>\"'"
    case = Case(evil, evil, CaseOutcome.FAILED, evil, evil, evil, properties=((evil, evil),))
    written = render(evil, [case]).encode("utf-8")
    element = next(ET.fromstring(written).iter("testcase"))
    clean = "a\ufffdb\ufffd\ufffd\ufffd<&>\"'"
    assert (element.get("name"), element.get("classname")) == (clean, clean)
    assert element[0][0].attrib == {"name": clean, "value": clean}
    assert (element[1].attrib, element[1].text) == ({"message": clean, "type": clean}, clean)
