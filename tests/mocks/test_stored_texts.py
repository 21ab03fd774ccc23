# SPDX-License-Identifier: Apache-2.0
"""Entries that `SetBlackboard` and scripts set: a tree has the status that BehaviorTree.CPP returns (4.8, by
`behaviortreepy`), or is refused if the library throws an exception or cannot copy a text.

There are wheels of `behaviortreepy` for some platforms only. Without it, the statuses of the table are not compared
with the library.
"""

from __future__ import annotations

from importlib import util
from pathlib import Path

import pytest

from as2fm_lsp.cli.main import run

REFUSED = ("exception", "uncopied")


def script(code: str) -> str:
    return f'<Script code="{code}"/>'


def check(code: str) -> str:
    return f'<ScriptCondition code="{code}"/>'


def setting(value: str, entry: str) -> str:
    return f'<SetBlackboard value="{value}" output_key="{entry}"/>'


def switch(entry: str, case: str) -> str:
    ports = f'variable="{{{entry}}}" case_1="{case}" case_2="no"'
    return f"<Switch2 {ports}><AlwaysSuccess/><AlwaysFailure/><AlwaysFailure/></Switch2>"


SET = setting("4", "k")
REPEAT = '<Repeat num_cycles="{k}"><AlwaysSuccess/></Repeat>'
LOOP = '<LoopInt queue="1;2" value="{k}"><AlwaysSuccess/></LoopInt>'
TREES = {
    # A port that only reads a string does not determine the type of an entry.
    "a switch reads a number": (script("m := 1; m += 1; m := m * 2; m -= 1"), switch("m", "3"), "SUCCESS"),
    "a number changes after a switch": (script("m := 1"), switch("m", "1"), script("m += 1"), "SUCCESS"),
    "a switch reads a text": (script("m := 'a'"), switch("m", "a"), script("m -= 1"), "exception"),
    "a number is an integer before a port reads it": (script("k := 0.5"), script("k *= 4"), REPEAT, "SUCCESS"),
    # The constant of a SetBlackboard is a text.
    "a text is compared with numbers": (SET, check("k == 4"), check("k &gt; 3.5"), check("5 != k"), "SUCCESS"),
    "a text is compared with another number": (SET, check("k == 5"), "FAILURE"),
    "a text is added to": (SET, script("k += 1"), check("k == 5"), "exception"),
    "a text is subtracted from": (SET, script("k -= 1"), "exception"),
    "a number is computed from a text": (SET, script("j := k + 1"), check("j == 5"), "exception"),
    "a text is computed from itself": (SET, script("k := k - 1"), check("k == 3"), "exception"),
    "a text becomes a number": (SET, script("k = 7"), check("k &gt; 6"), "exception"),
    "a text is created as a number": (SET, script("k := 7"), check("k == 7"), "exception"),
    "a text is negated": (SET, script("j := -k"), check("j &lt; 0"), "exception"),
    "a text is a condition": (setting("1", "k"), check("k"), "exception"),
    "a text is set again": (SET, script("k := '5'"), check("k == '5'"), "SUCCESS"),
    "a text is copied by a script": (SET, script("j := k"), check("j == 4"), "SUCCESS"),
    "a copied text is added to": (SET, script("j := k"), script("j += 1"), check("j == 5"), "exception"),
    "a text in a switch": (SET, switch("k", "4"), "SUCCESS"),
    "a text in a switch becomes a number": (SET, switch("k", "4"), script("k = 2"), switch("k", "2"), "exception"),
    "a number becomes a text": (script("k := 1"), SET, check("k == 4"), "exception"),
    "a port reads a number": (SET, REPEAT, script("k += 1"), check("k == 5"), "SUCCESS"),
    "a port writes a number": (LOOP, SET, script("k += 1"), check("k == 5"), "SUCCESS"),
    # Copies by SetBlackboard.
    "a number is copied": (script("a := 4"), setting("{a}", "c"), script("c -= 1"), check("c == 3"), "SUCCESS"),
    "a text is copied": (script("a := 'x'"), setting("{a}", "c"), check("c == 'x'"), "exception"),
    "a text is copied over a text": (script("a := 'x'; c := 'q'"), setting("{a}", "c"), check("c == 'x'"), "exception"),
    "a text is copied for a switch": (script("a := 'x'"), setting("{a}", "c"), switch("c", "x"), "SUCCESS"),
    "a constant text is copied": (setting("x", "a"), setting("{a}", "c"), check("c == 'x'"), "uncopied"),
    "a constant is copied": (SET, setting("{k}", "c"), check("c == 4"), "uncopied"),
    "a constant is copied and not read": (SET, setting("{k}", "c"), "uncopied"),
    "a declared text is copied": (
        f'<LoopString queue="a;b" value="{{s}}">{setting("{s}", "c")}</LoopString>', check("c == 'b'"), "SUCCESS",
    ),
}  # fmt: skip


def text_of(name: str) -> str:
    nodes = "".join(TREES[name][:-1])
    return f'<root BTCPP_format="4"><BehaviorTree ID="Main"><Sequence>{nodes}</Sequence></BehaviorTree></root>'


@pytest.mark.parametrize("name", TREES)
def test_a_tree_has_the_status_of_the_library_or_is_refused(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "tree.xml"
    path.write_text(text_of(name), encoding="utf-8")
    code = run(["verify", str(path)])
    printed = capsys.readouterr()
    expected = TREES[name][-1]
    if expected in REFUSED:
        assert code == 1
        assert ": error: " in printed.out + printed.err
    else:
        assert f"succeeds: = {int(expected == 'SUCCESS')} " in printed.out


if util.find_spec("behaviortreepy") is None:
    print("behaviortreepy is not installed: BehaviorTree.CPP itself does not judge entries that are set")
else:

    @pytest.mark.parametrize("name", TREES)
    def test_the_library_has_the_status_of_the_table(name: str) -> None:
        import behaviortreepy  # noqa: PLC0415 - not everywhere

        root = behaviortreepy.BehaviorTreeFactory().create_tree_from_text(text_of(name))
        status = "RUNNING"
        try:
            while status == "RUNNING":
                status = str(root.tick_exactly_once()).rpartition(".")[2]
        except RuntimeError:
            status = "exception"
        assert status == {"uncopied": "FAILURE"}.get(TREES[name][-1], TREES[name][-1])
