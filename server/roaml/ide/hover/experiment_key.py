# SPDX-License-Identifier: Apache-2.0
"""Hover texts for the keys in a file with the arguments of an experiment, and for the parameters that it varies."""

from __future__ import annotations

from roaml.ide.experiment import parameters_of
from roaml.project.analysis import Analysis
from roaml.project.experiment_file import KEYS, SET, UNIT, key_name, model_in
from roaml.project.files import MAX_CHARACTERS
from roaml.text import SourceFile, Span
from roaml.toml import TomlError, loads, places


def experiment_key_at(analysis: Analysis, source: SourceFile, offset: int) -> tuple[Span, str] | None:
    """The key or parameter at a place, and what it means; `None` if there is none, or if the file is not valid TOML."""
    if len(source.text) > MAX_CHARACTERS:
        return None
    try:
        loads(source.text)
    except TomlError:
        return None
    for path, span in places(source.text).keys.items():
        if span.start <= offset <= span.end:
            words = tuple(map(str, path))
            if len(words) == 1 and (key := KEYS.get(key_name(words[0]))) is not None:
                values = ", ".join(f"`{word}`" for word in key.words)
                return span, key.about + (f"\n\nValues: {values}" if values else "")
            if len(words) == 2 and words[0] in (SET, UNIT):
                return _parameter(analysis, source, span, words[1])
    return None


def _parameter(analysis: Analysis, source: SourceFile, span: Span, name: str) -> tuple[Span, str] | None:
    """The value of a parameter in the system, and its limits."""
    model = model_in(source)
    if model not in analysis.system_paths:
        return None
    for parameter in parameters_of(analysis, model):
        if parameter.name == name:
            limits = f"; {parameter.limits}" if parameter.limits else ""
            return span, f"Parameter `{name}`: {parameter.value} in the system{limits}"
    return None
