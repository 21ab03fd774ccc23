# SPDX-License-Identifier: Apache-2.0
"""Finds two instances of a file in one namespace, if each namespace should have one of them, and parameters with the
number of another instance."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence

from roaml.expansion.declarations import Declared, bounds_of
from roaml.expansion.instances import ListedInstance
from roaml.expansion.problems import ExpansionProblem, Problems
from roaml.expr.types import INTEGER_RANGES
from roaml.model.series import Alike, KeyedText, odd_numbers
from roaml.model.syntax import Name, name_of
from roaml.regex import regex
from roaml.text import Span

MIN_INSTANCES = 3
"""The minimum number of instances of one file: two in the same namespace are not an exception from a pattern."""

_WORD = regex(r"[A-Za-z]+|\d+")


def report_repeated(instances: Iterable[ListedInstance], problems: Problems) -> None:
    """Report one of two instances of a file in one namespace, if all others are in different ones, and the instances of
    another file, as many, are all in different namespaces, one of which has no instance of the first file."""
    groups: dict[str, list[ListedInstance]] = {}
    for instance in instances:
        if instance.namespace and not instance.is_plugin:
            groups.setdefault(instance.src.value, []).append(instance)
    used = {src: Counter(instance.namespace for instance in group) for src, group in groups.items()}
    for src, group in groups.items():
        twice = [name for name, count in used[src].items() if count > 1]
        if len(group) < MIN_INSTANCES or len(twice) != 1 or used[src][twice[0]] != 2:
            continue
        pair = [instance for instance in group if instance.namespace == twice[0]]
        for names in used.values():
            missing = names.keys() - used[src].keys()
            if len(names) == len(group) == sum(names.values()) and len(missing) == 1:
                _report(src, pair, missing.pop(), problems)
                break


def report_inconsistent(instances: Iterable[ListedInstance], problems: Problems) -> None:
    """Report the values of parameters with another number than the name or namespace, which are equal in all other
    instances of the file; and namespaces with another number than the name and a parameter."""
    values = []
    namespaces = []
    alike = []
    for instance in instances:
        namespace = name_of(instance.element.get("namespace"))
        texts = [("name", instance.name), ("namespace", namespace)]
        namespaces += [namespace.span] if namespace is not None and not instance.is_plugin else []
        for key, attribute in instance.params:
            value = Name(attribute.value, attribute.value_span)
            values.append(value.span)
            texts.append((key.value, value))
        keys = tuple(key for key, text in texts if text is not None)
        keyed = tuple(KeyedText(key, text) for key, text in texts if text is not None)
        alike.append(Alike((instance.src.value, *keys), keyed))
    kinds = dict.fromkeys(values, ExpansionProblem.INCONSISTENT)
    if all(finding.code != ExpansionProblem.NAMESPACE.value for finding in problems.findings):
        kinds |= dict.fromkeys(namespaces, ExpansionProblem.NAMESPACE)
    for odd in odd_numbers(alike):
        if odd.text.span in kinds:
            message = (
                f"`{odd.text.value}` does not match `{odd.other.value}`, unlike at all other instances of this file; "
                f"did you mean `{odd.fixed}`?"
            )
            related = [(odd.other.span, f"has the number {odd.expected}")]
            problems.add(kinds[odd.text.span], odd.text.span, message, close=(odd.fixed,), related=related)


def report_equal(
    instances: Iterable[ListedInstance],
    declared: Callable[[ListedInstance], Iterable[Declared]],
    problems: Problems,
) -> None:
    """Report two instances of a file with the same number, if the parameter is an identifier or has no default value,
    and has as many values from `min` to `max` as there are instances, or all others are different.

    Args:
        declared: returns the parameters of the file of an instance.
    """
    groups: dict[str, list[ListedInstance]] = {}
    for instance in instances:
        if not instance.is_plugin and not instance.is_tree:
            groups.setdefault(instance.src.value, []).append(instance)
    for group in groups.values():
        for parameter in declared(group[0]) if len(group) > 1 else ():
            _report_equal(group, parameter, problems)


def _report_equal(group: list[ListedInstance], parameter: Declared, problems: Problems) -> None:
    name = parameter.name.value
    given = [attribute for instance in group for key, attribute in instance.params if key.value == name]
    words = set(_words(name.lower()))
    is_plain = words.isdisjoint(_IDENTIFIERS) and parameter.value is not None
    if is_plain or parameter.type not in INTEGER_RANGES or len(given) < len(group):
        return
    numbers = [attribute.value.strip() for attribute in given]
    twice = [number for number, count in Counter(numbers).items() if count > 1]
    if len(twice) != 1 or numbers.count(twice[0]) != 2 or not all(number.isdecimal() for number in numbers):
        return
    low, high = bounds_of(parameter)
    all_numbers: Sequence[int] = ()
    if parameter.least is not None and parameter.most is not None and low is not None and high is not None:
        all_numbers = range(int(low), int(high) + 1) if high - low + 1 == len(group) else ()
    is_identifier = not words.isdisjoint(_IDENTIFIERS) or ("number" in words and parameter.value is None)
    if not all_numbers and not (is_identifier and len(group) >= MIN_INSTANCES):
        return
    first, second = (attribute for attribute in given if attribute.value.strip() == twice[0])
    left = [str(number) for number in all_numbers if str(number) not in numbers]
    advice = f"; did you mean {left[0]}?" if left else "; the other instances have different ones"
    message = f"two instances of `{group[0].src.value}` have the same `{name}`, {twice[0]}{advice}"
    related = [(first.value_span, "the other one")]
    problems.add(ExpansionProblem.INCONSISTENT, second.value_span, message, close=tuple(left[:1]), related=related)


_IDENTIFIERS = frozenset(("id", "identifier", "index"))
"""Words in the names of parameters that tell instances apart. A `number` may also count something."""


def _report(src: str, pair: list[ListedInstance], missing: str, problems: Problems) -> None:
    """Report the instance whose name has a word of the namespace `missing`, such as its number. Without such a name,
    both may be in one namespace intentionally."""
    words = set(_words(missing)) - set(_words(pair[0].namespace))
    named = [index for index, one in enumerate(pair) if one.name and words & set(_words(one.name.value))]
    if len(named) != 1:
        return
    wrong = named[0]
    message = (
        f"two instances of `{src}` are in the namespace `{pair[0].namespace}`, none is in `{missing}`, unlike those "
        f"of another file; did you mean `{missing}`?"
    )
    related = [(_place(pair[1 - wrong]), "the other one")]
    problems.add(ExpansionProblem.NAMESPACE, _place(pair[wrong]), message, close=(missing,), related=related)


def _place(instance: ListedInstance) -> Span:
    attribute = instance.element.get("namespace")
    assert attribute is not None
    return attribute.value_span


def _words(name: str) -> list[str]:
    return [match.group() for match in _WORD.finditer(name)]
