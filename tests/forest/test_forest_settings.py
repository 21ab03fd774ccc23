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
ASYNCHRONOUS = "<AsyncSequence><Grasp/></AsyncSequence>"


def codes(folder: Path, tree: str, settings: str) -> list[str]:
    """The codes of the findings in a tree with a configuration beside it."""
    (folder / "models").mkdir()
    (folder / "models" / "nodes.xml").write_text(MODELS)
    (folder / "as2fm.toml").write_text(settings)
    (folder / "tree.xml").write_text(f'<root BTCPP_format="4"><BehaviorTree ID="A">{tree}</BehaviorTree></root>')
    result = api.check([str(folder)])
    return [d.code for d in result.diagnostics if d.path.endswith(("tree.xml", "as2fm.toml"))]


@pytest.mark.parametrize(
    ("tree", "settings", "expected"),
    [
        ('<Grasp forc="3"/>', "", []),
        ('<Grasp forc="3"/>', 'tree-models = ["models/nodes.xml"]', ["unknown-node-port"]),
        ('<Grasp force="x"/>', 'tree-models = "models/nodes.xml"', ["node-port-value"]),
        ('<Wait duration="3"/>', "", []),
        ('<Wait duration="3"/>', 'tree-libraries = ["nav2"]', ["unknown-node-port"]),
        ("<TryCatch><AlwaysSuccess/><AlwaysSuccess/></TryCatch>", 'behaviortree-cpp = "4.9"', []),
        ("<TryCatch><AlwaysSuccess/><AlwaysSuccess/></TryCatch>", 'behaviortree-cpp = "4.8"', ["unknown-node"]),
        (
            f"<ReactiveSequence>{ASYNCHRONOUS}{ASYNCHRONOUS}</ReactiveSequence>",
            'behaviortree-cpp = "4.6"',
            [],
        ),
        ("<AlwaysSuccess/>", 'tree-libraries = ["nav3"]', ["invalid-setting"]),
        ("<AlwaysSuccess/>", 'behaviortree-cpp = "3.8"', ["invalid-setting"]),
        ("<AlwaysSuccess/>", "behaviortree-cpp = 4.6", ["invalid-setting"]),
    ],
)
def test_settings(tree: str, settings: str, expected: list[str], tmp_path: Path) -> None:
    assert codes(tmp_path, tree, settings) == expected
