# SPDX-License-Identifier: Apache-2.0
"""Verification of properties. The modules of the model checker are imported only when they are used."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from roaml.api.jani_files import read_jani
from roaml.comparison import UniformPolicy
from roaml.disk import MAX_DATA, required
from roaml.durations import ReactionTime
from roaml.jani.model import Model
from roaml.model.parameters import NO_OVERRIDES, Overrides
from roaml.project.settings import Settings
from roaml.record import replace

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from roaml.api.systems import LoadedSystem
    from roaml.comparison import Comparison
    from roaml.explicit.space import StateLimits
    from roaml.mocks.network import MockOptions
    from roaml.smc.model import ModelChecker
    from roaml.smc.run import Options
    from roaml.verification.expectations import Expectation
    from roaml.verification.results import Result
    from roaml.verification.target import VerificationTarget
    from roaml.verification.verifier import Verifier


class ConstantError(ValueError):
    """Raised if a constant cannot have the given value, or if a model does not declare the constant or parameter. The
    message contains the reason."""


def target(
    path: str,
    ros_paths: Iterable[str] = (),
    settings: Settings | None = None,
    texts: Mapping[str, str | bytes] | None = None,
    overrides: Overrides = NO_OVERRIDES,
    constants: Sequence[str] = (),
    mocks: Mapping[str, str] | None = None,
    entries: Mapping[str, str] | None = None,
    tick_rate: float | None = None,
) -> VerificationTarget:
    """Read a system, a tree or a model to verify. A file whose name ends in `.jani` is a JANI model; with mocks, and if
    a file `TREE.mocks` is beside it, a file is a tree without a system; any other file is a system.

    Args:
        path: the system file, a JANI model, or a tree.
        ros_paths, settings, texts, overrides: as for `load`.
        constants: `NAME=VALUE`, for constants of a JANI model; a value replaces the declared one.
        mocks: node of the tree -> its mock, such as `{"Grasp": "0.9 in 2 s", "*": "1"}` (docs/spec/mocks.md). By
            default, the mocks are those of the file `TREE.mocks` beside `TREE.xml`.
        entries: entry of the root blackboard of the tree -> its text at the start.
        tick_rate: the number of ticks of the tree per second, in Hz; 10 by default.

    Raises:
        ConstantError: a constant is not declared, or its value does not match its type; a system is given constants, or
            a JANI model is given overrides, except for a reaction time, which its metadata must permit.
        PathError: the file cannot be read, or is not a system file.
        ModelError: the system or tree has errors.
        JaniError: the JANI model has errors.
        MockError: a mock is not valid.
        MissingMocksError: leaves of the tree have no mock.
    """
    if mocks is not None or (not path.endswith(".jani") and _has_mocks(path)):
        assumed = overrides.reaction_time or (None if settings is None else settings.reaction_time)
        options = _mock_options(path, mocks, entries or {}, tick_rate, assumed)
        from roaml.api.trees import load_tree  # noqa: PLC0415

        read = load_tree(path, options, settings, texts).target
    elif path.endswith(".jani"):
        read = _jani_target(path, texts, overrides, constants)
    else:
        if constants:
            raise ConstantError("a system has no constants; only JANI models have them")
        from roaml.api.systems import load  # noqa: PLC0415 - a JANI model needs no system

        read = as_target(load(path, ros_paths, settings, texts, overrides))
    return read.expecting(_expected(settings))


def _has_mocks(path: str) -> bool:
    """Whether a file with mocks is beside a tree."""
    from roaml.model.kinds import mocks_path  # noqa: PLC0415 - a JANI model does not need the grammars

    return os.path.exists(mocks_path(path))


def _mock_options(
    path: str,
    mocks: Mapping[str, str] | None,
    entries: Mapping[str, str],
    tick_rate: float | None,
    reaction_time: ReactionTime | None,
) -> MockOptions:
    """The options of a tree with mocks, which are read from the file beside the tree if they are not given."""
    from roaml.mocks.mock import named_mocks, read_mocks  # noqa: PLC0415
    from roaml.mocks.network import DEFAULT_RATE, MockOptions  # noqa: PLC0415
    from roaml.model.kinds import mocks_path  # noqa: PLC0415

    if mocks is None:
        declared = read_mocks(required(mocks_path(path), MAX_DATA).decode("utf-8", "replace"))
    else:
        declared = named_mocks(mocks)
    rate = DEFAULT_RATE if tick_rate is None else Fraction(str(tick_rate))
    return MockOptions(declared, entries, rate, reaction_time=reaction_time)


def _jani_target(
    path: str, texts: Mapping[str, str | bytes] | None, overrides: Overrides, constants: Sequence[str]
) -> VerificationTarget:
    from roaml.jani.constants import with_constants  # noqa: PLC0415
    from roaml.verification.target import target_of, with_sentences  # noqa: PLC0415

    if replace(overrides, reaction_time=None) != NO_OVERRIDES:
        raise ConstantError("a JANI model has no parameters to override; only systems have them")
    model, source = read_jani(path, texts)
    try:
        model = with_constants(model, constants)
        if overrides.reaction_time is not None:
            model = _reacting(model, overrides.reaction_time)
    except ValueError as error:
        raise ConstantError(str(error)) from None
    return target_of(with_sentences(model), path, (path,), lambda _: source)


def _reacting(model: Model, time: ReactionTime) -> Model:
    """A model from a file with a reaction time.

    Raises:
        ValueError: the file does not permit the reaction time.
    """
    from roaml.jani.reaction import reacting  # noqa: PLC0415

    if not time.is_any and (model.metadata is None or model.metadata.clock is None):
        raise ValueError(
            "the metadata of the model name no clock, so it cannot have a reaction time; translate a system with "
            "timers, or leave out the reaction time"
        )
    return reacting(model, time)


def _expected(settings: Settings | None) -> Mapping[str, Comparison]:
    return {} if settings is None else settings.expectations


def as_target(subject: VerificationTarget | LoadedSystem | Model) -> VerificationTarget:
    """The verification target of a system, which is translated, or of a JANI model; a target is returned as it is."""
    from roaml.verification.target import VerificationTarget, target_of, with_sentences  # noqa: PLC0415

    if isinstance(subject, VerificationTarget):
        return subject
    if isinstance(subject, Model):
        return target_of(with_sentences(subject))
    from roaml.api.systems import to_jani  # noqa: PLC0415 - a JANI model needs no system
    from roaml.model.property_links import clock_step  # noqa: PLC0415

    conditional = [property_.name for property_ in subject.observed if property_.assumptions]
    model = with_sentences(to_jani(subject, has_activity=True))
    system = subject.analysis.system(subject.path)
    step = None if system is None else clock_step(system)
    target = target_of(model, subject.path, subject.files, subject.analysis.source, conditional, step)
    target = replace(target, parameters=subject.parameters, drawn=subject.drawn)
    return target.expecting({p.name: p.expected for p in subject.observed if p.expected is not None})


def checker(model: Model, properties: Iterable[str] | None = None) -> ModelChecker:
    """A model, compiled for some of its properties, to generate traces step by step.

    Args:
        properties: the names of the properties; all if not given. Every translated system also has the property
            `stuck`: that a trace gets stuck (`roaml.smc.end.End.STUCK`). It must be named.

    Raises:
        PropertyError: a property does not exist.
        FaultError: the model is of a kind that cannot be run; see `roaml.smc.fault`. The errors of properties that
            cannot be answered are in `ModelChecker.refused` instead.
    """
    from roaml.verification.verifier import checker_of  # noqa: PLC0415

    return checker_of(as_target(model), properties)


def verifier(
    subject: VerificationTarget | LoadedSystem | Model,
    properties: Sequence[str] | None = None,
    options: Options | None = None,
    expectations: Iterable[str | Expectation] = (),
    *,
    only_uniform: bool = False,
    exact_if_small: bool = False,
    example_traces: int | None = None,
    limits: StateLimits | None = None,
    uniform: UniformPolicy = UniformPolicy.WARN,
) -> Verifier:
    """A verifier, which verifies properties one by one. A verification can be observed, interrupted and continued.

    Args:
        subject, properties, options, expectations, only_uniform, exact_if_small, uniform: as for `verify`.
        example_traces: the number of traces for a result with exact values; `None` for the number that an estimate
            needs.
        limits: the limits of all searches for exact values together, with `exact_if_small`.

    Raises:
        PropertyError, FaultError, ValueError: as for `verify`.
    """
    from roaml.verification import expectations as _expectations  # noqa: PLC0415
    from roaml.verification.target import asking  # noqa: PLC0415
    from roaml.verification.verifier import verifier_of  # noqa: PLC0415

    parsed = [_expectations.parse(e) if isinstance(e, str) else e for e in expectations]
    return verifier_of(
        asking(as_target(subject), properties or ()),
        properties,
        options,
        parsed,
        only_uniform=only_uniform,
        exact_if_small=exact_if_small,
        example_traces=example_traces,
        limits=limits,
        uniform=uniform,
    )


def verify(
    subject: VerificationTarget | LoadedSystem | Model,
    properties: Sequence[str] | None = None,
    options: Options | None = None,
    jobs: int = 1,
    executor: Executor | None = None,
    *,
    expectations: Iterable[str | Expectation] = (),
    only_uniform: bool = False,
    exact_if_small: bool = False,
    uniform: UniformPolicy = UniformPolicy.WARN,
) -> Iterator[Result]:
    """Estimate the probabilities of properties by random traces with uniform choices. Properties share traces.

    Args:
        subject: a system, a JANI model, or the result of `target`.
        properties: the names of the properties; all if not given. Every system also has the property `stuck`: that a
            trace gets stuck. It must be named.
        options: confidence, width of the interval, seed and limits.
        jobs: the number of processes. It has no influence on the results.
        executor: an executor that runs the batches of traces, instead of `jobs` new processes.
        expectations: such as `alarm >= 0.95`; each adds a verdict to the result of its property.
        only_uniform: whether only uniform choices are considered. Otherwise, other schedulers are examined as well, and
            the verdicts state whether they lead to other values.
        exact_if_small: whether a result also has exact values (`Result.exact`), which decide its verdicts, if the model
            has few states.
        uniform: what an expectation is worth that is met under uniform choices, but not known to be met under all
            schedulers.

    Raises:
        PropertyError: a property does not exist.
        FaultError: the model cannot be run. A property that cannot be answered has a result with a `refusal`.
        WorkersLostError: worker processes end repeatedly.
        ValueError: an option or expectation is invalid.
    """
    from roaml.smc.pool import Pool  # noqa: PLC0415

    ready = verifier(
        subject,
        properties,
        options,
        expectations,
        only_uniform=only_uniform,
        exact_if_small=exact_if_small,
        uniform=uniform,
    )
    with Pool(jobs, executor) as pool:
        yield from ready.verify_all(pool)
