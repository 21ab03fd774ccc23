# SPDX-License-Identifier: Apache-2.0
"""Values that are computed from several that vary: which of them occur together is not known."""

from __future__ import annotations

from pathlib import Path

import pytest

from roaml import api
from roaml.diagnostics import Severity

PRINTER = """
<ascxml name="Printer" version="1.0" initial="idle">
    <datamodel>
        <data id="all" type="uint16" expr="0" />
        <data id="left" type="uint16" expr="0" />
        <data id="done" type="uint16" expr="0" />
    </datamodel>
    <state id="idle">
        <transition event="small" target="busy">
            <assign location="all" expr="2" /><assign location="left" expr="2" />
        </transition>
        <transition event="large" target="busy">
            <assign location="all" expr="9" /><assign location="left" expr="9" />
        </transition>
    </state>
    <state id="busy">
        <transition event="page" cond="left &gt; 0" target="busy">
            <assign location="left" expr="left - 1" />
            <assign location="done" expr="{}" />
            <send event="done"><param name="pages" expr="done" /></send>
        </transition>
    </state>
</ascxml>
"""


@pytest.mark.parametrize(
    ("expr", "severity"), [("all - left", Severity.INFORMATION), ("3 - left", Severity.WARNING), ("left", None)]
)
def test_a_difference_of_related_values_is_no_warning(tmp_path: Path, expr: str, severity: Severity | None) -> None:
    """`all - left` is never negative, `3 - left` is."""
    path = tmp_path / "printer.ascxml"
    path.write_text(PRINTER.format(expr), encoding="utf-8")
    found = [d.severity for d in api.check([str(path)]).diagnostics if d.code == "integer-range"]
    assert found == ([] if severity is None else [severity])
