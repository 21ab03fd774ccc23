# SPDX-License-Identifier: Apache-2.0
"""Helpers of the rules about names."""

from __future__ import annotations

from dataclasses import dataclass

from roaml.facts import Facts


@dataclass(frozen=True, slots=True)
class WrongName(Facts):
    """The facts of a finding: `name`, which is written at the span of the finding, is not valid there."""

    name: str
