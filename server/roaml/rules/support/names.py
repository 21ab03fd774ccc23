# SPDX-License-Identifier: Apache-2.0
"""Helpers of the rules about names."""

from __future__ import annotations

from roaml.facts import Facts


class WrongName(Facts, frozen=True):
    """The facts of a finding: `name`, which is written at the span of the finding, is not valid there."""

    name: str
