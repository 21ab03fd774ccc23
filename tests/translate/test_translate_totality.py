# SPDX-License-Identifier: Apache-2.0
"""Every model without errors is translated: small changes of sound models are refused or translated."""

from __future__ import annotations

from functools import cache
from random import Random

from hypothesis import HealthCheck, event, given, settings
from hypothesis import strategies as st
from variations import varied

from examples import examples
from fuzz.corpus import Model, snippets, systems
from fuzz.translation import problems
from roaml import api
from roaml.project.settings import Settings


@cache
def sound() -> tuple[Model, ...]:
    """The models of the corpus that have no errors."""
    return tuple(model for model in (*systems(), *snippets()) if is_sound(check(model, model.texts), model))


def check(model: Model, texts: dict[str, str]) -> api.CheckResult:
    return api.check([model.main], model.ros_paths, Settings(), texts)


def is_sound(result: api.CheckResult, model: Model) -> bool:
    try:
        api.loaded(result.snapshot, model.main)
    except (api.ModelError, api.PathError):
        return False
    return True


@settings(max_examples=examples(150), suppress_health_check=[HealthCheck.too_slow])
@given(st.deferred(lambda: st.sampled_from(sound())), st.randoms(use_true_random=False))
def test_changed_models_are_refused_or_translated(model: Model, random: Random) -> None:
    texts = varied(random, model.texts)
    result = check(model, texts)
    event("translated" if is_sound(result, model) else "refused")
    assert list(problems(result.snapshot, model.main)) == [], texts


def test_changes_leave_many_models_sound() -> None:
    """Else the test above would say little."""
    results = []
    for seed in range(200):
        random = Random(seed)
        model = random.choice(sound())
        results.append(is_sound(check(model, varied(random, model.texts)), model))
    assert 0.3 < sum(results) / len(results) < 0.8
