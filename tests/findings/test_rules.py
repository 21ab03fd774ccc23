# SPDX-License-Identifier: Apache-2.0
"""The list of rules, and the documents beside them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import roaml.rules
from checked import check_text
from roaml.rules import RULES, document
from roaml.rules.rule import Rule

SCRIPT = """
import sys, pytest
class Plugin:
    def pytest_collection_finish(self):
        print("imported:", sorted({"roaml.api", "roaml.rules", "hypothesis", "lsprotocol.types"} & sys.modules.keys()))
pytest.main(["--collect-only", "-q", "-s", "-n", "0", "-k", "missing-file", sys.argv[1]], plugins=[Plugin()])
"""


def test_every_document_belongs_to_a_rule() -> None:
    documents = sorted(path.stem for path in Path(roaml.rules.__file__).parent.rglob("*.md"))
    assert documents == [rule.code.replace("-", "_") for rule in RULES]


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.code)
def test_document_begins_with_the_summary(rule: Rule) -> None:
    assert document(rule.code).startswith(f"# {rule.code}\n\n{rule.summary}\n")


def test_cases_are_collected_without_the_library() -> None:
    """The tests of one rule start at once, because the library is imported only when the first test runs."""
    folder = Path(__file__).parents[1] / "rules"
    command = [sys.executable, "-c", SCRIPT, str(folder)]
    output = subprocess.run(command, capture_output=True, text=True, check=True, cwd=folder.parents[1]).stdout
    assert "test_cases.py: " in output
    assert "imported: []\n" in output


def test_a_quotient_whose_divisor_is_zero_is_not_rounded(tmp_path: Path) -> None:
    diagnostics, _ = check_text(
        tmp_path,
        """\
<ascxml name="M" version="1.0" initial="s">
    <datamodel>
        <data id="counts" type="int32[7]" expr="[1, 2, 3, 4, 5, 6, 7]" />
    </datamodel>
    <state id="s">
        <transition target="s">
            <assign location="counts[0]" expr="counts[6] / 0" />
            <assign location="counts[1]" expr="counts[6] / 2" />
        </transition>
    </state>
</ascxml>
""",
    )
    of_types = [d for d in diagnostics if d.code == "type-mismatch"]
    assert [[fix.title for fix in d.fixes][:1] for d in of_types] == [[], ["Change to `Math.floor(counts[6] / 2)`"]]
