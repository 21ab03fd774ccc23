# SPDX-License-Identifier: Apache-2.0
"""Systems whose elements have namespace prefixes."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest
from translating import FOLDER

from roaml import api
from roaml.jani.writer import write
from roaml.project.settings import Settings

EXAMPLES = Path(__file__).parents[2] / "examples"
SYSTEMS = ("battery/main.xml", "fleet/main.xml", "warehouse/main.xml", "delivery_robot/main.xml")
START = re.compile(r"<(?=[A-Za-z_])")


def _prefixed(text: str, namespace: str) -> str:
    """The text, in which the names of all elements have a prefix that the root declares."""
    first = START.search(text)
    assert first is not None
    text = text[: first.end()] + "p:" + START.sub("<p:", text[first.end() :]).replace("</", "</p:")
    return re.sub(r"(<p:\w+)", rf'\1 xmlns:p="{namespace}"', text, count=1)


def _model(system: str, namespace: str) -> str:
    texts = {}
    for file in EXAMPLES.rglob("*"):
        if file.suffix in (".xml", ".ascxml", ".jani", ".json"):
            text = file.read_text(encoding="utf-8")
            is_tree = "<BehaviorTree" in text  # BehaviorTree.CPP reads no namespaces
            is_changed = namespace and not is_tree and file.suffix in (".xml", ".ascxml")
            name = os.path.join(FOLDER, str(file.relative_to(EXAMPLES)))
            texts[name] = _prefixed(text, namespace) if is_changed else text
    loaded = api.load(os.path.join(FOLDER, system), settings=Settings(), texts=texts)
    return "".join(write(api.to_jani(loaded)))


@pytest.mark.parametrize("namespace", ["http://www.w3.org/2005/07/scxml", "https://example.org/models"])
@pytest.mark.parametrize("system", SYSTEMS)
def test_prefixes_do_not_change_the_meaning(system: str, namespace: str) -> None:
    assert _model(system, namespace) == _model(system, "")
