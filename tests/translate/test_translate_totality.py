# SPDX-License-Identifier: Apache-2.0
"""Every model without errors is translated: small changes of sound models are refused or translated."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from random import Random

from hypothesis import HealthCheck, event, given, settings
from hypothesis import strategies as st
from variations import varied

from examples import examples
from fuzz.corpus import Model, snippets, systems
from fuzz.translation import problems
from roaml import api
from roaml.project.explored_findings import CODES
from roaml.project.settings import Settings


@cache
def models() -> tuple[Model, ...]:
    """The models of the corpus, with and without errors."""
    return (*systems(), *snippets())


@cache
def is_sound_at(position: int) -> bool:
    """Whether the model at a position in `models` has no errors. Only those that a test draws are checked, because to
    check all takes 20 s in each process of the tests."""
    model = models()[position]
    return is_sound(check(model, model.texts), model)


def sound_model(random: Random, fits: Callable[[Model], bool] = lambda model: True) -> Model:
    """A random model of those without errors for which `fits` is true."""
    while True:
        position = random.randrange(len(models()))
        if fits(models()[position]) and is_sound_at(position):
            return models()[position]


def check(model: Model, texts: dict[str, str]) -> api.CheckResult:
    return api.check([model.main], model.ros_paths, Settings(ignore=CODES), texts)


def is_sound(result: api.CheckResult, model: Model) -> bool:
    try:
        api.loaded(result.snapshot, model.main)
    except (api.ModelError, api.PathError):
        return False
    return True


@settings(max_examples=examples(150), suppress_health_check=[HealthCheck.too_slow])
@given(st.integers(0, 2**32), st.randoms(use_true_random=False))
def test_changed_models_are_refused_or_translated(seed: int, random: Random) -> None:
    model = sound_model(Random(seed))
    texts = varied(random, model.texts)
    result = check(model, texts)
    event("translated" if is_sound(result, model) else "refused")
    assert list(problems(result.snapshot, model.main)) == [], texts


def test_changes_leave_many_models_sound() -> None:
    """Else the test above would say little."""
    results = []
    for seed in range(200):
        random = Random(seed)
        model = sound_model(random)
        results.append(is_sound(check(model, varied(random, model.texts)), model))
    assert 0.3 < sum(results) / len(results) < 0.8
