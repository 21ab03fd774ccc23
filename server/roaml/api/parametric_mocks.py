# SPDX-License-Identifier: Apache-2.0
"""Mocks whose numbers are parameters of an experiment: `FollowPath: $(var p) in 2 s`
(docs/spec/parameters.md#uses)."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from fractions import Fraction

from roaml.durations import DEFAULT_MAX_TIME
from roaml.expansion.uses import VARIABLE
from roaml.experiments.parametric import Chances
from roaml.experiments.sweeps import Setting
from roaml.mocks.mock import Mock, MockError, read_mock, read_mocks
from roaml.project.settings import Settings
from roaml.record import Record, field
from roaml.suggest import close_names, did_you_mean
from roaml.verification.target import VerificationTarget


class MockTexts(Record, frozen=True):
    """Declarations of mocks in which `$(var NAME)` is the value of a parameter.

    Attributes:
        texts: mocks such as `FollowPath: $(var p) in 2 s`.
        file: the content of a file with further mocks.
        entries: name of a blackboard entry of a tree without a system -> its text at the start.
        rate: the tick rate of such a tree in Hz; `None` for the default.
    """

    texts: tuple[str, ...] = ()
    file: str = ""
    entries: Mapping[str, str] = field(default_factory=dict)
    rate: Fraction | None = None

    @property
    def has_mocks(self) -> bool:
        return bool(self.texts or self.file)

    def mocks(self, values: Mapping[str, str]) -> tuple[Mock, ...]:
        """The mocks with the values of parameters.

        Raises:
            MockError: a mock is not valid, or a parameter has no value.
        """
        single = tuple(read_mock(with_values(text, values)) for text in self.texts)
        return single + read_mocks(with_values(self.file, values))

    def uses(self) -> Collection[str]:
        """The names of the parameters."""
        return {match[1] for text in (*self.texts, self.file) for match in VARIABLE.finditer(text)}


def with_values(text: str, values: Mapping[str, str]) -> str:
    """A mock, or the text of a file with mocks, in which `$(var NAME)` is replaced.

    Raises:
        MockError: a parameter has no value.
    """

    def value(match: re.Match[str]) -> str:
        if match[1] not in values:
            close = close_names(match[1], values)
            known = did_you_mean(close) if close else "; declare it in the system file with `<parameter>`"
            raise MockError(f"there is no parameter `{match[1]}`{known}")
        return values[match[1]]

    return VARIABLE.sub(value, text)


class ParametricTree(Record, frozen=True):
    """A tree without a system, whose mocks use the parameters.

    Attributes:
        max_time: the limit of the simulated time in ns; `None` for the default.
    """

    path: str
    mocks: MockTexts
    settings: Settings
    max_time: int | None = None

    def target(self, setting: Setting) -> VerificationTarget:
        from roaml.api.trees import load_tree  # noqa: PLC0415 - systems need none of these
        from roaml.mocks.network import DEFAULT_RATE, MissingMocksError, MockOptions  # noqa: PLC0415

        values = dict(setting)
        if unknown := [name for name in values if name not in self.mocks.uses()]:
            raise MockError(f"no mock uses the parameter `{unknown[0]}`; write `$(var {unknown[0]})` in a mock")
        if missing := [name for name in self.mocks.uses() if name not in values]:
            raise MockError(f"the parameter `{missing[0]}` of a mock has no values; give it at least one")
        mocks = self.mocks.mocks(values)
        rate, limit = self.mocks.rate or DEFAULT_RATE, self.max_time or DEFAULT_MAX_TIME
        options = MockOptions(mocks, self.mocks.entries, rate, limit, reaction_time=self.settings.reaction_time)
        try:
            return load_tree(self.path, options, self.settings).target
        except MissingMocksError as error:
            types = ", ".join(dict.fromkeys(leaf.type for leaf in error.leaves))
            raise MockError(f"{self.path}: these leaves need mocks: {types}") from None

    def chances(self, _: Mapping[str, tuple[float, float]], __: Setting) -> Chances | None:
        return None
