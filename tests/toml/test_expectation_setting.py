# SPDX-License-Identifier: Apache-2.0
"""Expectations written into configuration files of every form."""

from __future__ import annotations

import pytest

from roaml.project.expectation_setting import expectation_edit
from roaml.toml import loads


def edited(path: str, text: str, name: str = "alarm", expected: str = ">= 0.9") -> str | None:
    edit = expectation_edit(path, text, name, expected)
    return None if edit is None else text[: edit.span.start] + edit.new_text + text[edit.span.end :]


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("", '[verify.expect]\nalarm = ">= 0.9"\n'),
        ('roots = ["a"]\n', 'roots = ["a"]\n\n[verify.expect]\nalarm = ">= 0.9"\n'),
        ('roots = ["a"]', 'roots = ["a"]\n\n[verify.expect]\nalarm = ">= 0.9"\n'),
        ('[verify.expect]\nlow = "< 1"\n', '[verify.expect]\nalarm = ">= 0.9"\nlow = "< 1"\n'),
        ('[verify.expect]  # ours\nlow = "< 1"\n', '[verify.expect]  # ours\nalarm = ">= 0.9"\nlow = "< 1"\n'),
        ('[verify.expect]\nalarm = "< 1"  # once\n', '[verify.expect]\nalarm = ">= 0.9"  # once\n'),
        ("[verify.expect]\nalarm = '''\n< 1'''\n", '[verify.expect]\nalarm = ">= 0.9"\n'),
        ('[verify]\nscheduler = "uniform"\n', '[verify]\nexpect.alarm = ">= 0.9"\nscheduler = "uniform"\n'),
        ('[verify]\nexpect = { low = "< 1" }\n', '[verify]\nexpect = { alarm = ">= 0.9", low = "< 1" }\n'),
        ("[verify]\nexpect = {}\n", '[verify]\nexpect = { alarm = ">= 0.9" }\n'),
        ('verify.scheduler = "uniform"\n[severity]\n', None),
        ('[verify]\r\nexpect.low = "< 1"\r\n', None),
    ],
)
def test_forms(before: str, after: str | None) -> None:
    text = edited("/robot/as2fm.toml", before)
    assert text is not None
    assert loads(text)["verify"]["expect"]["alarm"] == ">= 0.9"
    if after is not None:
        assert text == after
    else:
        known = loads(before)
        assert all(loads(text).get(key) is not None for key in known)


def test_the_table_of_a_project() -> None:
    text = edited("/robot/pyproject.toml", '[project]\nname = "robot"\n\n[tool.as2fm]\nroots = ["a"]\n')
    assert text is not None
    table = loads(text)
    assert table["tool"]["as2fm"] == {"roots": ["a"], "verify": {"expect": {"alarm": ">= 0.9"}}}
    assert table["project"] == {"name": "robot"}


@pytest.mark.parametrize("name", ["gets stuck", 'a "b" \\ c', "a.b", "Größe", "tab\tbed"])
def test_names_that_need_quotes(name: str) -> None:
    text = edited("/robot/as2fm.toml", "", name)
    assert text is not None
    assert loads(text) == {"verify": {"expect": {name: ">= 0.9"}}}


@pytest.mark.parametrize("text", ["[verify", 'verify = "much"\n', "[verify]\nexpect = 3\n"])
def test_what_cannot_be_changed(text: str) -> None:
    assert edited("/robot/as2fm.toml", text) is None
