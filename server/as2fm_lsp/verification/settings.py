# SPDX-License-Identifier: Apache-2.0
"""Settings for the verification in an editor: `as2fm.verify`, and the options of one call.

    {"verify": {"confidence": 0.95, "epsilon": 0.01, "maxSteps": 1000000, "expectations": {"alarm": ">= 0.95"},
    "stuck": "warning", "exactIfSmall": true}}

The options of a call have the same form, with `seed`, `silent` and `partialResultToken` in addition, and take
precedence. A call whose options contain one of `TRACE_OPTIONS` generates traces, without exact values. An invalid value
is reported, and the default is used.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from roaml.record import Record
from roaml.smc.run import MIN_EPSILON, Options
from roaml.verification.expectations import Expectation, parse
from roaml.verification.stuck import StuckLevel

TRACE_OPTIONS = frozenset({"confidence", "epsilon", "maxSteps", "seed"})
"""The options of a call that have an effect only on traces."""


class VerificationSettings(Record, frozen=True):
    """The settings of one call.

    Attributes:
        is_silent: whether the results are not shown as messages.
        exact_if_small: whether results of small models also have exact values.
        stuck: how a system that gets stuck is reported, a warning or an error.
        problems: messages about invalid values, as sentences.
        partial_result_token: the token with which the client requests each result as soon as it is complete.
    """

    options: Options
    expectations: tuple[Expectation, ...]
    is_silent: bool
    problems: tuple[str, ...]
    exact_if_small: bool = True
    stuck: StuckLevel = StuckLevel.WARNING
    partial_result_token: int | str | None = None


def verification_settings(settings: object, options: object = None) -> VerificationSettings:
    """The settings.

    Args:
        settings: the client's settings, as received.
        options: the options of one call.
    """
    section = settings.get("verify") if isinstance(settings, Mapping) else None
    values = {**_mapping(section), **_mapping(options)}
    problems: list[str] = []

    def number(key: str, otherwise: Any, is_valid: Callable[[Any], bool], range_: str) -> Any:
        value = values.get(key, otherwise)
        if isinstance(value, (int, float)) and not isinstance(value, bool) and is_valid(value):
            return value
        problems.append(f"verify.{key} must be {range_}, not {value!r}.")
        return otherwise

    default = Options()
    share, integer = "a number between 0 and 1", "a whole number"
    width = f"a number of at least {MIN_EPSILON:g} and less than 1"
    chosen = Options(
        confidence=number("confidence", default.confidence, lambda value: 0 < value < 1, share),
        epsilon=number("epsilon", default.epsilon, lambda value: MIN_EPSILON <= value < 1, width),
        max_steps=number(
            "maxSteps", default.max_steps, lambda v: isinstance(v, int) and v > 0, f"{integer} of at least 1"
        ),
        seed=number(
            "seed", default.seed, lambda v: isinstance(v, int) and 0 <= v < 1 << 63, f"{integer} from 0 to 2^63 - 1"
        ),
    )
    expectations = []
    for name, text in _mapping(values.get("expectations")).items():
        try:
            expectations.append(parse(f"{name} {text}"))
        except ValueError:
            problems.append(f"The expectation of {name} must have a form like '>= 0.95', not {text!r}.")
    word = values.get("stuck", StuckLevel.WARNING.value)
    level = next((level for level in StuckLevel if level.value == word), None)
    if level is None:
        problems.append(f"verify.stuck must be one of {', '.join(map(str, StuckLevel))}, not {word!r}.")
    exact = values.get("exactIfSmall", True)
    if not isinstance(exact, bool):
        problems.append(f"verify.exactIfSmall must be true or false, not {exact!r}.")
        exact = True
    token = values.get("partialResultToken")
    return VerificationSettings(
        chosen,
        tuple(expectations),
        values.get("silent") is True,
        tuple(problems),
        exact and TRACE_OPTIONS.isdisjoint(_mapping(options)),
        level or StuckLevel.WARNING,
        token if isinstance(token, (int, str)) and not isinstance(token, bool) else None,
    )


def _mapping(value: object) -> Mapping[str, Any]:
    return value if isinstance(value, Mapping) else {}
