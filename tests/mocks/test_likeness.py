# SPDX-License-Identifier: Apache-2.0
"""Nodes with children that no library describes, which mocks declare to behave like nodes of the libraries."""

from __future__ import annotations

import json
import random
import re
from importlib import util
from pathlib import Path

import pytest
from random_trees import ANY, ENTRIES, Drawn, SeededChoices, as_xml
from real_library import JUDGE, RANDOM, TICKS, by_the_library, is_refused
from translated_trees import observe, with_mocks
from tree_comparison import difference_of

from as2fm_lsp.cli.main import run
from roaml.mocks.likeness import Likeness, library_parents, read_likeness
from roaml.mocks.mock import Mock, read_mock

HEAD = '<root BTCPP_format="4" main_tree_to_execute="Main"><BehaviorTree ID="Main">'


def write(tmp_path: Path, content: str) -> Path:
    path = tmp_path / "tree.xml"
    path.write_text(f"{HEAD}{content}</BehaviorTree></root>", encoding="utf-8")
    return path


def own(text: str) -> tuple[str, tuple[Mock, ...]]:
    """A tree in which all nodes with children that can be declared have names of their own, and their mocks."""
    types = {type_ for type_ in library_parents() if re.search(rf"<{type_}[ >]", text)}
    for type_ in types:
        text = re.sub(rf"<(/?){type_}(?=[ >])", rf"<\g<1>Own{type_}", text)
    return text, tuple(read_mock(f"Own{type_}: as {type_}") for type_ in sorted(types))


@pytest.mark.parametrize("seed", range(60))
def test_a_declared_node_is_executed_like_that_of_the_library(seed: int) -> None:
    """Random trees of all nodes, with the ports that the tree sets: the same calls and statuses."""
    drawn = ANY.tree(SeededChoices(random.Random(seed)))
    text = as_xml(drawn)
    renamed, mocks = own(text)
    entries = {key: str(value) for key, value in ENTRIES.items()}
    assert mocks
    assert renamed != text
    expected = observe(with_mocks(text, entries, TICKS), seed)
    assert difference_of(observe(with_mocks(renamed, entries, TICKS, more=mocks), seed), expected) == ""


if util.find_spec("behaviortreepy") is None:
    print("behaviortreepy is not installed: BehaviorTree.CPP itself does not judge declared nodes")
else:

    @pytest.mark.parametrize("seed", range(40))
    def test_declared_nodes_do_what_behaviortree_cpp_does(seed: int) -> None:
        import behaviortreepy  # noqa: PLC0415 - not everywhere

        drawn: Drawn = RANDOM.tree(SeededChoices(random.Random(seed)))
        if is_refused(drawn):
            return
        text = as_xml(drawn)
        renamed, mocks = own(text)
        entries = {key: str(value) for key, value in ENTRIES.items()}
        seen = observe(with_mocks(renamed, entries, TICKS, version=JUDGE, more=mocks), seed)
        assert difference_of(seen, by_the_library(behaviortreepy, text, seen)) == ""


def test_ports_are_those_of_the_mock_unless_the_tree_sets_them(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Three attempts of 0.5, then one of which the tree sets the number."""
    content = "<Sequence><Again name='a'><A/></Again><Again name='b' num_attempts='1'><A/></Again></Sequence>"
    path = write(tmp_path, content)
    mocks = ("--mock", "A: 0.5", "--mock", "Again: as RetryUntilSuccessful(num_attempts=3)")
    assert run(["verify", str(path), *mocks]) == 0
    out = capsys.readouterr().out
    assert out.startswith("succeeds: = 0.4375 for all schedulers, exact, ")
    likes = "`a` as `RetryUntilSuccessful(num_attempts=3)`, `b` as `RetryUntilSuccessful`"
    assert f"; executed like nodes of the library: {likes}\n" in out
    assert run(["verify", str(path), *mocks, "--format", "json"]) == 0
    rows = json.loads(capsys.readouterr().out)["tree"]["like"]
    assert [(row["node"], row["type"], row["like"]) for row in rows] == [
        ("a", "Again", "RetryUntilSuccessful(num_attempts=3)"),
        ("b", "Again", "RetryUntilSuccessful"),
    ]


def test_the_mock_of_a_name_takes_precedence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = write(tmp_path, "<Sequence><Own name='a'><A/></Own><Own><A/></Own></Sequence>")
    mocks = ("--mock", "*: 0.5", "--mock", "Own: as ForceSuccess", "--mock", "a: as Inverter")
    assert run(["verify", str(path), *mocks]) == 0
    assert capsys.readouterr().out.startswith("succeeds: = 0.5 for all schedulers, exact, ")


def test_a_proposal_for_nodes_with_children(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A decorator returns the status of its child; a control node is a Sequence."""
    content = "<Fallback><Lock><A/></Lock><ManualSelector><B/><A/></ManualSelector></Fallback>"
    path = write(tmp_path, content)
    assert run(["init", "--mocks", str(path)]) == 0
    assert capsys.readouterr().out.splitlines()[0].endswith("tree.mocks with proposed mocks for 5 nodes")
    path.with_suffix(".mocks").unlink()
    assert run(["verify", str(path)]) == 2
    assert "its 5 nodes of 4 kinds need mocks; a proposal is in" in capsys.readouterr().err
    text = path.with_suffix(".mocks").read_text("utf-8")
    assert "\n# NODE: as TYPE, a node of a library\n" in text
    assert "\nLock: as Sequence  # decorator: no library describes it: it returns the status of its child\n" in text
    assert "\nManualSelector: as Sequence  # control node: " in text
    assert run(["verify", str(path)]) == 0
    # A fails with 0.1, and then B or A with 1 - 0.9^2.
    assert capsys.readouterr().out.startswith("succeeds: = 0.981 for all schedulers, exact, ")
    assert run(["init", "--mocks", str(path)]) == 0
    assert "every node that needs a mock has one already" in capsys.readouterr().err


def notes(capsys: pytest.CaptureFixture[str], path: Path, *mocks: str) -> list[str]:
    assert run(["verify", str(path), *(part for mock in mocks for part in ("--mock", mock))]) == 0
    return [line.removeprefix("as2fm-lsp: the mock ") for line in capsys.readouterr().err.splitlines()]


def test_mocks_without_effect_are_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A mock of leaves does not apply to nodes with children, nor the other way round; the node of the library like
    which a node is executed is not in the tree."""
    path = write(tmp_path, "<Lock name='outer'><Again name='again'><Pick/></Again></Lock>")
    used = ("Lock: as Sequence", "again: as RetryUntilSuccessful(num_attempts=2)", "*: 0.5", "Pick: 0.5")
    assert notes(capsys, path, *used) == []
    assert notes(
        capsys, path, *used, "Pick: as Inverter", "outer: 0.5", "Sequence: as Fallback", "Lok: as Inverter"
    ) == [
        "`Pick` is for nodes with children that no library describes, but the node is not one of these; remove it",
        "`outer` is for leaves, but the node has children; write for example `outer: as Sequence`",
        "`Sequence` matches no node of the tree; remove it",
        "`Lok` matches no node of the tree; did you mean `Lock`?",
    ]


@pytest.mark.parametrize("pattern", ["controller", "Own", "GoalUpdatedController"])
def test_the_event_of_a_declared_node_has_a_mock(
    pattern: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write(tmp_path, "<Own name='controller'><A/></Own>")
    mocks = ("*: 1", "Own: as GoalUpdatedController", f"{pattern}: 0.3")
    assert notes(capsys, path, *mocks) == []
    assert run(["verify", str(path), *(part for mock in mocks for part in ("--mock", mock))]) == 0
    assert "(no mock)" not in capsys.readouterr().out


def test_a_wrong_number_of_children_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = write(tmp_path, "<Own><A/><A/></Own>")
    assert run(["verify", str(path), "--mock", "A: 1", "--mock", "Own: as Inverter"]) == 1
    assert "`Own`, which is executed like `Inverter`, has 2 children, but needs 1" in capsys.readouterr().err
    path = write(tmp_path, "<Own><A/></Own>")
    assert run(["verify", str(path), "--mock", "A: 1", "--mock", "Own: as IfThenElse"]) == 1
    assert "`Own`, which is executed like `IfThenElse`, has 1 child, but needs 2 to 3" in capsys.readouterr().err
    assert run(["verify", str(path), "--mock", "A: 1", "--mock", "Own: as Repeat"]) == 1
    assert "`Own`, which is executed like `Repeat`, needs the port `num_cycles`" in capsys.readouterr().err


def test_mocks_of_leaves_and_of_nodes_with_children_are_independent(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write(tmp_path, "<Own><A/></Own>")
    assert run(["verify", str(path), "--mock", "*: 0.25", "--mock", "*: as Inverter"]) == 0
    assert capsys.readouterr().out.startswith("succeeds: = 0.75 for all schedulers, exact, ")


@pytest.mark.parametrize(
    "text", ["Sequence", "Repeat(num_cycles=3)", 'Switch2(variable="a b", case_1=x, case_2="y,z")']
)
def test_a_likeness_is_read_as_it_is_written(text: str) -> None:
    assert read_likeness(text).text == text
    assert read_mock(f"Own: as {text}").behaviour() == f"as {text}"


def test_blanks_in_a_likeness_have_no_meaning() -> None:
    assert read_likeness(" Repeat ( num_cycles = 3 ) ") == Likeness("Repeat", (("num_cycles", "3"),))
