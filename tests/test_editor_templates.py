# SPDX-License-Identifier: Apache-2.0
"""The files that the VS Code extension writes: templates of machines, and snippets."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from roaml import api
from roaml.diagnostics import Diagnostic, Severity

EXTENSION = Path(__file__).parents[1] / "vscode-extension"
SNIPPETS = json.loads((EXTENSION / "snippets/ascxml.json").read_text(encoding="utf-8"))

MAIN = """\
<roaml>
    <parameters><max_time value="10" unit="s" /></parameters>
    <behavior_tree>
        <input type="bt.cpp-xml" src="tree.xml" />
        <input type="bt-plugin-ascxml" src="plugin.ascxml" />
    </behavior_tree>
    <node_models><input type="node-ascxml" src="node.ascxml" /></node_models>
    <properties><input type="jani" src="properties.jani" /></properties>
</roaml>
"""
TREE = '<root BTCPP_format="4"><BehaviorTree ID="T"><MyAction times="3" /></BehaviorTree></root>\n'

AROUND = {
    "Machine": "{}",
    "Variable": "<ascxml name='A' version='1.0' initial='s'><datamodel>{}</datamodel><state id='s'/></ascxml>",
    "Timer": "<ascxml name='A' version='1.0' initial='state'>{}</ascxml>",
    "Service: server": "<ascxml name='A' version='1.0' initial='ready'>{}</ascxml>",
    "State": "<ascxml name='A' version='1.0' initial='name'>{}</ascxml>",
    "Topic: subscribe": "<ascxml name='A' version='1.0' initial='s'>{}<state id='s'/></ascxml>",
}
IN_STATE = "<ascxml name='A' version='1.0' initial='s'><state id='s'>{}</state></ascxml>"
IN_TRANSITION = IN_STATE.replace("{}", "<transition event='e'>{}</transition>")
PARTS = {"Topic: publish": IN_TRANSITION, "If": IN_TRANSITION, "Probabilistic target": IN_TRANSITION}


def expanded(body: list[str]) -> str:
    """A snippet with its default texts in place of the placeholders."""
    text = "\n".join(body)
    words = dict(re.findall(r"\$\{(\d+)[:|]([^},|]*)[^}]*\}", text))
    text = re.sub(r"\$\{(\d+)[^}]*\}", lambda match: words[match[1]], text)
    return re.sub(r"\$(\d+)", lambda match: words.get(match[1], ""), text)


def check(folder: Path, files: dict[str, str], *names: str) -> list[Diagnostic]:
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    return list(api.check([str(folder / name) for name in names]).diagnostics)


def test_templates_make_a_system(tmp_path: Path) -> None:
    texts = {kind: (EXTENSION / f"templates/{kind}.ascxml").read_text(encoding="utf-8") for kind in ("node", "plugin")}
    files = {"node.ascxml": texts["node"].replace("NAME", "MyNode"), "main.xml": MAIN, "tree.xml": TREE}
    files["properties.jani"] = '{"properties": []}'
    files["plugin.ascxml"] = texts["plugin"].replace("NAME", "MyAction")
    diagnostics = check(tmp_path, files, "main.xml")
    # The node communicates with nodes that do not exist yet.
    assert {d.code for d in diagnostics} <= {"topic-without-publisher", "topic-without-subscriber"}
    assert not [d for d in diagnostics if d.path.endswith(("plugin.ascxml", "tree.xml"))]


@pytest.mark.parametrize("name", SNIPPETS)
def test_snippets_are_of_the_language(name: str, tmp_path: Path) -> None:
    around = AROUND.get(name) or PARTS.get(name) or IN_STATE
    text = around.replace("{}", expanded(SNIPPETS[name]["body"]))
    diagnostics = check(tmp_path, {"a.ascxml": text}, "a.ascxml")
    # The user fills in the names; the test checks the structure.
    form = (
        "xml-",
        "unknown-element",
        "unknown-attribute",
        "missing-",
        "misplaced-",
        "invalid-",
        "attribute-",
        "child-",
    )
    wrong = [f"{d.code}: {d.message}" for d in diagnostics if d.severity is Severity.ERROR and d.code.startswith(form)]
    assert not wrong
    assert "${" not in text
