# SPDX-License-Identifier: Apache-2.0
"""Finds the value of a parameter whose number does not match the name of its instance, unlike at all similar ones."""

from __future__ import annotations

from collections.abc import Iterable

from roaml.expansion.instances import ListedInstance
from roaml.expansion.problems import ExpansionProblem, Problems
from roaml.model.series import Alike, KeyedText, odd_numbers
from roaml.model.syntax import Name, name_of


def report_inconsistent(instances: Iterable[ListedInstance], problems: Problems) -> None:
    """Report the values of parameters with another number than the name or namespace, which are equal in all other
    instances of the file."""
    values = []
    alike = []
    for instance in instances:
        namespace = name_of(instance.element.get("namespace"))
        texts = [("name", instance.name), ("namespace", namespace)]
        for key, attribute in instance.params:
            value = Name(attribute.value, attribute.value_span)
            values.append(value.span)
            texts.append((key.value, value))
        keys = tuple(key for key, text in texts if text is not None)
        keyed = tuple(KeyedText(key, text) for key, text in texts if text is not None)
        alike.append(Alike((instance.src.value, *keys), keyed))
    own = set(values)
    for odd in odd_numbers(alike):
        if odd.text.span in own:
            message = (
                f"`{odd.text.value}` does not match `{odd.other.value}`, unlike at all other instances of this file; "
                f"did you mean `{odd.fixed}`?"
            )
            related = [(odd.other.span, f"has the number {odd.expected}")]
            problems.add(ExpansionProblem.INCONSISTENT, odd.text.span, message, close=(odd.fixed,), related=related)
