# SPDX-License-Identifier: Apache-2.0
"""The list of rules, and the documents beside them."""

from __future__ import annotations

from pathlib import Path

import pytest

import roaml.rules
from roaml.rules import RULES, document
from roaml.rules.rule import Rule


def test_every_document_belongs_to_a_rule() -> None:
    documents = sorted(path.stem for path in Path(roaml.rules.__file__).parent.rglob("*.md"))
    assert documents == [rule.code.replace("-", "_") for rule in RULES]


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.code)
def test_document_begins_with_the_summary(rule: Rule) -> None:
    assert document(rule.code).startswith(f"# {rule.code}\n\n{rule.summary}\n")
