# SPDX-License-Identifier: Apache-2.0
"""How many states a check explores, and what it says about the systems whose states it does not explore."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from fixture import write_files
from roaml import api
from roaml.diagnostics import Severity
from roaml.explicit import space
from roaml.project import exploration
from roaml.project.settings import Settings
from roaml.project.workspace import Workspace
from rule_files import examples

CODE = "never-ticked"
INSTANT = ' reaction_time="instant"'


@pytest.fixture
def searches(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The number of states of each search that has ended."""
    numbers: list[int] = []
    explore = space.explore

    def counted(*arguments: Any, **options: Any) -> Any:
        try:
            found = explore(*arguments, **options)
        except space.LimitError as error:
            numbers.append(error.states)
            raise
        numbers.append(found.states)
        return found

    monkeypatch.setattr(space, "explore", counted)
    return numbers


def check(folder: Path, heading: str) -> tuple[api.CheckResult, list[str]]:
    """The result of a check of an example of the rule without a reaction time, and the messages of the rule."""
    write_files(folder, examples(CODE, heading)[0].text.replace(INSTANT, ""))
    result = api.check([str(folder / "main.xml")])
    return result, [d.message for d in result.diagnostics if d.code == CODE]


def test_a_right_system_is_explored_once_with_machines_that_react_at_once(tmp_path: Path, searches: list[int]) -> None:
    assert check(tmp_path, "Good")[1] == []
    assert len(searches) == 1


def test_a_finding_is_confirmed_for_all_reactions(tmp_path: Path, searches: list[int]) -> None:
    [message] = check(tmp_path, "Bad")[1]
    assert "react at once" not in message
    instant, all_reactions = searches
    assert instant < all_reactions


def test_a_finding_that_is_not_confirmed_says_what_it_assumes(
    tmp_path: Path, searches: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    check(tmp_path, "Bad")
    monkeypatch.setattr(exploration, "MAX_STATES", searches[0])
    [message] = check(tmp_path, "Bad")[1]
    assert "if all machines react at once" in message


def test_a_limit_ends_the_exploration_and_is_known(
    tmp_path: Path, searches: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    main = str(tmp_path / "main.xml")
    assert not check(tmp_path, "Bad")[0].snapshot.checker.has_too_many_states(main)
    searches.clear()
    monkeypatch.setattr(exploration, "MAX_STATES", 1)
    result, messages = check(tmp_path, "Bad")
    assert messages == []
    assert len(searches) == 1
    assert result.snapshot.checker.has_too_many_states(main)


@pytest.mark.parametrize(("is_failing", "severity"), [(True, Severity.WARNING), (False, Severity.INFORMATION)])
def test_a_condition_that_is_checked_too_early_matters_if_an_action_fails(
    tmp_path: Path, is_failing: bool, severity: Severity
) -> None:
    text = examples(CODE, "Bad")[1].text
    if not is_failing:
        low = '<bt_tick target="ready" cond="level &lt; 10"><bt_return_status status="FAILURE" /></bt_tick>'
        assert low in text
        text = text.replace(low, low.replace("FAILURE", "RUNNING"))
    write_files(tmp_path, text)
    [found] = [d for d in api.check([str(tmp_path / "main.xml")]).diagnostics if d.code == CODE]
    assert found.severity is severity
    assert is_failing or "`ReactiveSequence`" in found.message


def test_findings_in_unchanged_files_remain_until_the_next_exploration(tmp_path: Path) -> None:
    write_files(tmp_path, examples(CODE, "Bad")[0].text)
    workspace = Workspace((str(tmp_path),), Settings())
    tree, battery = str(tmp_path / "tree.xml"), str(tmp_path / "battery.ascxml")

    def of(path: str, *, explores: bool = False) -> list[str]:
        found = workspace.snapshot().checker.diagnostics(path, explores=explores)
        return [d.message for d in found if d.code == CODE]

    def change(path: str, old: str, new: str) -> None:
        workspace.open(path, Path(path).read_text(encoding="utf-8").replace(old, new))

    assert of(tree) == []
    before = of(tree, explores=True)
    assert len(before) == 1
    change(battery, "level - 10", "level - 1")
    assert of(tree) == before
    change(battery, "level - 10", "level - no_such_variable")
    assert of(tree, explores=True) == before
    change(battery, "level - 10", "level - 90")
    assert of(tree) == before
    assert of(tree, explores=True) == []
    workspace.close(battery)
    assert of(tree, explores=True) == before
    change(tree, "<Recharge />", "<Recharge /> ")
    assert of(tree) == []


def test_related_places_in_changed_files_are_left_out(tmp_path: Path) -> None:
    write_files(tmp_path, examples("never-taken", "Bad")[0].text)
    workspace = Workspace((str(tmp_path),), Settings())
    dispenser, order = str(tmp_path / "dispenser.ascxml"), str(tmp_path / "order.ascxml")

    def related(*, explores: bool = False) -> set[str]:
        found = workspace.snapshot().checker.diagnostics(dispenser, explores=explores)
        [finding] = [d for d in found if d.code == "never-taken"]
        return {Path(place.location.path).name for place in finding.related}

    assert related(explores=True) == {"dispenser.ascxml", "order.ascxml", "tree.xml"}
    workspace.open(order, "\n" + Path(order).read_text(encoding="utf-8"))
    assert related() == {"dispenser.ascxml", "tree.xml"}
    assert related(explores=True) == {"dispenser.ascxml", "order.ascxml", "tree.xml"}
