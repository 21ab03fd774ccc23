# SPDX-License-Identifier: Apache-2.0
"""The end of an exhaustive `match`, like `typing.assert_never` of Python 3.11.

A type checker reports missing cases.
"""

from __future__ import annotations

from typing import NoReturn


def assert_never(value: NoReturn) -> NoReturn:
    raise AssertionError(f"unexpected value: {value!r}")
