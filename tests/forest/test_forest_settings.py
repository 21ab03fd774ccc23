# SPDX-License-Identifier: Apache-2.0
"""Settings of trees that belong to no system: models, libraries, the version of BehaviorTree.CPP."""

from __future__ import annotations

from pathlib import Path

import pytest

from roaml import api

MODELS = """<root BTCPP_format="4">
    <TreeNodesModel><Action ID="Grasp"><input_port name="force" type="int"/></Action></TreeNodesModel>
</root>
"""
TREES = {
    "B": '<ScriptCondition code="x + 1 == 4"/>',
    "C": '<ScriptCondition code="x == 3"/>',
    "two words": "<AlwaysSuccess/>",
}
"""Trees that are added to the file if the tree `A` uses them."""
NAMED = '<SubTree ID="C" name="one" x="3"/>'
ASYNCHRONOUS = "<AsyncSequence><Grasp/></AsyncSequence>"


def codes(folder: Path, tree: str, settings: str) -> list[str]:
    """The codes of the findings in a tree with a configuration beside it."""
    (folder / "models").mkdir()
    (folder / "models" / "nodes.xml").write_text(MODELS)
    (folder / "as2fm.toml").write_text(settings)
    used = [f'<BehaviorTree ID="{name}">{top}</BehaviorTree>' for name, top in TREES.items() if f'ID="{name}"' in tree]
    main = f'<BehaviorTree ID="A">{tree}</BehaviorTree>'
    (folder / "tree.xml").write_text(f'<root BTCPP_format="4">{main}{"".join(used)}</root>')
    result = api.check([str(folder)])
    return [d.code for d in result.diagnostics if d.path.endswith(("tree.xml", "as2fm.toml"))]


@pytest.mark.parametrize(
    ("tree", "settings", "expected"),
    [
        ('<Grasp forc="3"/>', "", []),
        ('<Grasp forc="3"/>', 'tree-models = ["models/nodes.xml"]', ["unknown-port"]),
        ('<Grasp force="x"/>', 'tree-models = "models/nodes.xml"', ["port-value"]),
        ('<Wait duration="3"/>', "", []),
        ('<Wait duration="3"/>', 'tree-libraries = ["nav2"]', ["unknown-port"]),
        ("<TryCatch><ScriptCondition code='true'/><AlwaysSuccess/></TryCatch>", 'behaviortree-cpp = "4.9"', []),
        (
            "<TryCatch><ScriptCondition code='true'/><AlwaysSuccess/></TryCatch>",
            'behaviortree-cpp = "4.8"',
            ["unknown-node"],
        ),
        (
            f"<ReactiveSequence>{ASYNCHRONOUS}{ASYNCHRONOUS}</ReactiveSequence>",
            'behaviortree-cpp = "4.6"',
            [],
        ),
        ("<Script code=\"a := 10 - 3 .. 'x'\"/>", 'behaviortree-cpp = "4.9"', []),
        ("<Script code=\"a := 10 - 3 .. 'x'\"/>", 'behaviortree-cpp = "4.8"', ["script-syntax"]),
        ('<Script code="a := 1 b := 2"/>', 'behaviortree-cpp = "4.8.2"', ["script-syntax"]),
        ('<SubTree ID="B" x="3"/>', 'behaviortree-cpp = "4.9.1"', []),
        ('<SubTree ID="B" x="3"/>', 'behaviortree-cpp = "4.9.0"', ["script-type"]),
        ('<SubTree ID="C" x="3"/>', 'behaviortree-cpp = "4.9.0"', []),
        (f"<Sequence>{NAMED}{NAMED}</Sequence>", "", ["tree-name"]),
        (f"<Sequence>{NAMED}{NAMED}</Sequence>", 'behaviortree-cpp = "4.8.3"', []),
        ('<SubTree ID="two words"/>', 'behaviortree-cpp = "4.8.4"', ["tree-name"]),
        ('<SubTree ID="two words"/>', 'behaviortree-cpp = "4.8.3"', []),
        ('<AlwaysSuccess name="tab&#9;tab"/>', 'behaviortree-cpp = "4.8"', ["tree-name"]),
        ('<AlwaysSuccess name="tab&#9;tab"/>', 'behaviortree-cpp = "4.7"', []),
        ("<AlwaysSuccess/>", 'tree-libraries = ["nav3"]', ["invalid-setting"]),
        ("<AlwaysSuccess/>", 'behaviortree-cpp = "3.8"', ["invalid-setting"]),
        ("<AlwaysSuccess/>", "behaviortree-cpp = 4.6", ["invalid-setting"]),
    ],
)
def test_settings(tree: str, settings: str, expected: list[str], tmp_path: Path) -> None:
    assert codes(tmp_path, tree, settings) == expected
