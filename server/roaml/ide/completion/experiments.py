# SPDX-License-Identifier: Apache-2.0
"""Completion in files with the arguments of an experiment: keys, their values, and the names of the model."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.ide.completion.item import CompletionItem, ItemKind
from roaml.ide.experiment import parameters_of, properties_of
from roaml.model.kinds import FileKind
from roaml.project.analysis import Analysis
from roaml.project.experiment_file import FIND, KEYS, MEETS, MODEL, PROPERTY, SET, UNIT, KeyForm, key_name, model_in
from roaml.project.paths import seen_from

_EXPECTED = ">= 0.99"
"""What is proposed as the expectation of a property for which none is set."""


def experiment_keys(analysis: Analysis, path: str, section: str) -> Iterator[CompletionItem]:
    """What can be at the beginning of a line: a key, or the name of a parameter in the tables `set` and `unit`.

    Args:
        section: the table that contains the line; "" before the first one.
    """
    model = _model(analysis, path)
    if section in (SET, UNIT) and model is not None:
        for parameter in parameters_of(analysis, model):
            value = f'"${{1:{parameter.proposed}}}"' if section == SET else '"$1"'
            about = ", ".join(part for part in (parameter.limits, f"{parameter.value} in the system") if part)
            yield CompletionItem(parameter.name, ItemKind.VALUE, f"{parameter.name} = {value}", about)
    if not section:
        for name, key in KEYS.items():
            if name in (SET, UNIT):
                yield CompletionItem(f"[{name}]", ItemKind.ATTRIBUTE, f"[{name}]\n", key.about)
                continue
            value = {KeyForm.VALUE: '"$1"', KeyForm.FLAG: "true", KeyForm.ENTRIES: '["$1"]'}[key.form]
            yield CompletionItem(name, ItemKind.ATTRIBUTE, f"{name} = {value}", key.about)


def experiment_values(analysis: Analysis, path: str, key: str) -> Iterator[tuple[str, str]]:
    """The values of a key, each with a description."""
    name, model = key_name(key), _model(analysis, path)
    if name == MODEL:
        yield from ((seen_from(system, path), FileKind.SYSTEM.value) for system in analysis.system_paths)
    elif name == PROPERTY and model is not None:
        yield from ((property_.name, property_.comment) for property_ in properties_of(analysis, model))
    elif name == MEETS and model is not None:
        for property_ in properties_of(analysis, model):
            yield f"{property_.name} {property_.expected or _EXPECTED}", property_.comment
    elif name == FIND and model is not None:
        yield from ((parameter.name, parameter.limits) for parameter in parameters_of(analysis, model))
    elif (known := KEYS.get(name)) is not None:
        yield from ((word, "") for word in known.words)


def _model(analysis: Analysis, path: str) -> str | None:
    """The system that the file names, also while the file is not valid TOML; `None` if there is none."""
    source = analysis.source(path)
    model = model_in(source) if source is not None else None
    return model if model in analysis.system_paths else None
