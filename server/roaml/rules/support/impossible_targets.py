# SPDX-License-Identifier: Apache-2.0
"""Targets that are never chosen (docs/spec/machines.md#targets)."""

from __future__ import annotations

from roaml.facts import Facts


class ImpossibleTarget(Facts, frozen=True):
    """The facts of a finding: a target has the probability 0. It is not reported if it is the value of a parameter."""
