# SPDX-License-Identifier: Apache-2.0
"""The cases of the rules, `cases/GROUP/CODE.txt`, and those of all rules together, `cases/one_report/SUBJECT.txt`.

- The marks of a case of a rule are all that the rule reports, with exact spans; without marks the rule is silent. Hints
  are expected only of rules that report nothing else. What other rules report does not matter.
- The marks of a case in `one_report` are all errors and warnings of all rules: one mistake gives one report, and what
  only follows from it is not reported.
- Every fix removes its finding. A preferred fix adds no error that the case does not declare (`fix adds: CODE`). The
  document of a rule with a fix has a section Fix.

`fixture` describes the format.
"""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

import pytest

from fixture import Case, read_cases
from rule_files import CASES_FOLDER, RULES_FOLDER, cases_of_all_rules, cases_of_rules, has_fix


def parameters(cases: tuple[Case, ...]) -> list[object]:
    return [pytest.param(case, id=f"{case.subject}: {case.title}") for case in cases]


OF_RULES = pytest.mark.parametrize("case", parameters(cases_of_rules()))
OF_ALL_RULES = pytest.mark.parametrize("case", parameters(cases_of_all_rules()))


@OF_RULES
def test_case_of_a_rule(case: Case, checked: ModuleType, mending: ModuleType, tmp_path: Path) -> None:
    result, marks = checked.checked(tmp_path, case.text)
    assert not [d.message for d in result.diagnostics if d.code == "internal-error"]
    reported = checked.of_rule(result.diagnostics, case.subject)
    assert sorted(checked.as_mark(d, tmp_path) for d in reported) == sorted(marks)
    fixes = list(mending.offered(result.snapshot, case.subject))
    assert not fixes or has_fix(case.subject)
    assert not list(mending.broken_promises(result.snapshot, fixes, may_add=case.fix_adds))


@OF_ALL_RULES
def test_case_of_all_rules(case: Case, checked: ModuleType, mending: ModuleType, tmp_path: Path) -> None:
    result, marks = checked.checked(tmp_path, case.text)
    reported = [d for d in result.diagnostics if d.severity >= checked.Severity.WARNING]
    assert sorted(checked.as_mark(d, tmp_path) for d in reported) == sorted(marks)
    fixes = mending.offered(result.snapshot)
    assert not list(mending.broken_promises(result.snapshot, fixes, may_add=case.fix_adds))


@pytest.mark.parametrize("path", sorted(CASES_FOLDER.glob("*/*.txt")), ids=lambda path: path.stem)
def test_place_of_the_cases(path: Path) -> None:
    """A file of cases has the name of a rule and is in the folder of its group, or is in `one_report`."""
    group = path.parent.name
    is_of_rule = (RULES_FOLDER / group / f"{path.stem.replace('-', '_')}.md").is_file()
    assert is_of_rule is (group != "one_report")


@pytest.mark.parametrize("path", sorted(CASES_FOLDER.glob("*/*-*.txt")), ids=lambda path: path.stem)
def test_marks_are_of_the_rule(path: Path) -> None:
    assert {mark.code for case in read_cases(path) for mark in case.marks()} == {path.stem}
