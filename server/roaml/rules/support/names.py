# SPDX-License-Identifier: Apache-2.0
"""What rules about names share."""

from __future__ import annotations

from dataclasses import dataclass

from roaml.facts import Facts


@dataclass(frozen=True, slots=True)
class WrongName(Facts):
    """`name` cannot be used for what is at the span of the finding, where it is written."""

    name: str
