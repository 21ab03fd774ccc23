# SPDX-License-Identifier: Apache-2.0
"""A file with very many errors: the first ones of each kind are reported, with the number of the others."""

from __future__ import annotations

import os

from fuzz.corpus import NOWHERE
from fuzz.growth import DIMENSIONS
from roaml import api
from roaml.project.checking import MAX_FINDINGS
from roaml.project.settings import Settings

MAIN = os.path.join(NOWHERE, "main.xml")


def messages(name: str, size: int) -> list[tuple[str, str]]:
    dimension = next(dimension for dimension in DIMENSIONS if dimension.name == name)
    return [(d.code, d.message) for d in api.check([MAIN], [], Settings(), dimension.texts(size)).diagnostics]


def test_as_many_as_are_shown() -> None:
    rows = messages("unknown-attributes", MAX_FINDINGS)
    assert len(rows) == MAX_FINDINGS
    assert not any("only the first" in message for _, message in rows)


def test_more_than_are_shown() -> None:
    rows = messages("unknown-attributes", MAX_FINDINGS + 500)
    assert len(rows) == MAX_FINDINGS + 1
    assert rows[-1][0] == "unknown-attribute"
    assert rows[-1][1] == "only the first 1,000 findings of `unknown-attribute` in this file are shown"


def test_comments_that_suppress_nothing() -> None:
    rows = messages("comments", MAX_FINDINGS + 500)
    assert [code for code, _ in rows] == ["unused-suppression"] * MAX_FINDINGS
