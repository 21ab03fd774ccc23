# SPDX-License-Identifier: Apache-2.0
"""The errors of a public project, as its authors publish it. Each was judged by reading the models."""

from __future__ import annotations

from pathlib import Path

import conformance
from roaml import api
from roaml.diagnostics import Diagnostic, Severity
from roaml.project.settings import Settings

UC3 = conformance.ROOT.parent / "real" / "uc3"

TRUE_ERRORS = {
    ("SetTurnedSkill.ascxml", 55, "unanswered-request"),
    ("GoToChargingStationSkill.ascxml", 54, "unanswered-request"),
    ("PeopleDetectorFilterComponent.ascxml", 51, "type-mismatch"),
}
TRUE_WARNINGS = {
    ("RunTimerSkill.ascxml", 61, "unanswered-request"),
    ("RunTimerSkill.ascxml", 83, "unanswered-request"),
}
"""The event `CMD_HALT` of another skill is delivered at any time, also while a tick of `RunTimerSkill` is pending."""


def place(diagnostic: Diagnostic) -> tuple[str, int, str]:
    text = Path(diagnostic.path).read_text(encoding="utf-8")
    return Path(diagnostic.path).name, text.count("\n", 0, diagnostic.span.start) + 1, diagnostic.code


if UC3.is_dir():

    def findings(severity: Severity) -> list[Diagnostic]:
        main = str(UC3 / "main_with_properties.xml")
        return [d for d in api.check([main], (), Settings()).diagnostics if d.severity is severity]

    def test_true_mistakes_are_all_errors() -> None:
        assert {place(d) for d in findings(Severity.ERROR)} == TRUE_ERRORS

    def test_answers_that_depend_on_an_order_are_warnings() -> None:
        warnings = findings(Severity.WARNING)
        assert {place(d) for d in warnings if d.code == "unanswered-request"} == TRUE_WARNINGS
        assert all("`CMD_HALT` arrives first" in d.message for d in warnings if d.code == "unanswered-request")

    def test_wider_types_of_ports_are_warnings() -> None:
        assert len([d for d in findings(Severity.WARNING) if d.code == "port-variable"]) == 9
