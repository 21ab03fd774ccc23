# SPDX-License-Identifier: Apache-2.0
"""Models that only this tool translates (docs/spec/differences.md#accepted): Storm finds what must come out of
it.

The systems stand in `beyond.txt`. The property of each is written as `VARIABLE = VALUE`: sooner or later this holds,
whatever happens.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from storm import exact
from test_translate_storm import reaches
from translating import translated

from fixture import split_files
from roaml.jani.typecheck import check_model

_TITLE = re.compile(r"^## (.+)\n", re.MULTILINE)
_, *_PARTS = _TITLE.split((Path(__file__).parent / "beyond.txt").read_text(encoding="utf-8"))
SYSTEMS = dict(zip(_PARTS[::2], map(split_files, _PARTS[1::2]), strict=True))


@pytest.mark.parametrize("title", SYSTEMS)
def test_comes_true(title: str) -> None:
    files = SYSTEMS[title]
    variable, _, value = files["properties.jani"].partition("=")
    model = translated({**files, "properties.jani": reaches(variable.strip(), int(value))})
    assert check_model(model) == ()
    actual_exact = exact(model, "p")
    assert (actual_exact.least, actual_exact.greatest) == pytest.approx((1, 1))
