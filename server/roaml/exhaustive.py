# SPDX-License-Identifier: Apache-2.0
"""The last case of an exhaustive `match`, like `typing.assert_never` of Python 3.11."""

from __future__ import annotations

from typing import NoReturn


def assert_never(value: NoReturn) -> NoReturn:
    """Marks a case that a type checker proves to be unreachable: it reports the kinds that the other cases omit."""
    raise AssertionError(f"a value of an unexpected kind: {value!r}")
