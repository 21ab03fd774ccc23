# SPDX-License-Identifier: Apache-2.0
"""The parameters that a document declares (docs/spec/parameters.md#declarations)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction

from roaml.exact_number import exact_number
from roaml.expansion.problems import ExpansionProblem, Problems
from roaml.expansion.values import Content, ParameterValue, Scope, evaluate, number_text, read_value
from roaml.expr.parse import parse
from roaml.expr.types import BASE_TYPES, INTEGER_RANGES, ScalarKind
from roaml.language import SYSTEM
from roaml.language.validate import misspelled_attribute
from roaml.model.syntax import Name, name_of
from roaml.record import Record
from roaml.suggest import close_names, did_you_mean
from roaml.text import Decoded, Span
from roaml.xml_syntax import Attribute, Document, Element

PARAMETER = "parameter"
"""The name of the element that declares a parameter."""

PARAM = "param"
"""The name of the element of an `<input>` that sets a parameter of the file."""

SETTING = "`--set` or a setting"
"""The source of values from outside of the files."""

SECTIONS = ("parameter_declarations", "parameters", "mc_parameters")
"""The sections of a system file that can contain declarations. AS2FM ignores the first, and rejects the elements in the
others."""
CHANNELS = "channels"
"""The name of the section of a system file that declares channels."""


class Declared(Record, frozen=True, eq=False):
    """A `<parameter>`.

    Attributes:
        type: the name of its type; "" if it is missing or unknown.
        value, least, most: the attributes `value`, `min` and `max`.
    """

    element: Element
    name: Name
    type: str
    value: Attribute | None
    least: Attribute | None
    most: Attribute | None


def bounds_of(parameter: Declared) -> tuple[Fraction | None, Fraction | None]:
    """The least and the greatest value of a parameter, as far as its attributes or the range of its type state them as
    numbers."""
    least, most = (
        exact_number(attribute.value) if attribute is not None else None
        for attribute in (parameter.least, parameter.most)
    )
    low, high = INTEGER_RANGES.get(parameter.type, (None, None))
    return (
        Fraction(low) if parameter.least is None and low is not None else least,
        Fraction(high) if parameter.most is None and high is not None else most,
    )


def has_channels(system: Document) -> bool:
    """Whether a system file declares channels."""
    return next(channel_sections(system), None) is not None


def channel_sections(system: Document) -> Iterator[Element]:
    return (child for child in (system.root.elements if system.root else ()) if child.name == CHANNELS)


def declaration_elements(document: Document) -> Iterator[Element]:
    """The `<parameter>` elements of a document: the children of its root, and of the sections of a system file."""
    for child in document.root.elements if document.root else ():
        if child.name == PARAMETER:
            yield child
        elif child.name in SECTIONS:
            yield from (element for element in child.elements if element.name == PARAMETER)


def declarations(document: Document, problems: Problems) -> tuple[Declared, ...]:
    """The parameters that a document declares, in order, without repeated ones. A parameter without a name is left
    out; the grammar requires the name."""
    declared: dict[str, Declared] = {}
    for element in declaration_elements(document):
        name = name_of(element.get("name"))
        if name is None:
            if not _is_misspelled(element, "name"):
                problems.add(ExpansionProblem.DECLARATION, element.name_span, "a parameter needs a `name`")
            continue
        if name.value in declared:
            first = declared[name.value].name.span
            message = f"the parameter `{name.value}` is declared twice; remove one of the declarations"
            problems.add(ExpansionProblem.DUPLICATE, name.span, message, related=((first, "first declared here"),))
            continue
        if not name.value.isidentifier() or not name.value.isascii() or name.value in ("SUCCESS", "FAILURE", "RUNNING"):
            message = (
                f"`{name.value}` cannot be the name of a parameter; use letters, digits and underscores, not beginning "
                "with a digit"
            )
            problems.add(ExpansionProblem.DECLARATION, name.span, message)
            continue
        declared[name.value] = Declared(
            element, name, _type(element, problems), element.get("value"), element.get("min"), element.get("max")
        )
    return tuple(declared.values())


def _type(element: Element, problems: Problems) -> str:
    given = name_of(element.get("type"))
    if given is None:
        if not _is_misspelled(element, "type"):
            message = "a parameter needs a `type`, such as `int32`"
            problems.add(ExpansionProblem.DECLARATION, element.name_span, message)
        return ""
    if given.value not in BASE_TYPES:
        close = close_names(given.value, BASE_TYPES)
        known = did_you_mean(close) if close else f"; the types are {', '.join(BASE_TYPES)}"
        message = f"a parameter cannot have the type `{given.value}`{known}"
        problems.add(ExpansionProblem.DECLARATION, given.span, message, close=close)
        return ""
    return given.value


def _is_misspelled(element: Element, name: str) -> bool:
    return misspelled_attribute(element, name, SYSTEM.elements[PARAMETER].attributes)


class Given(Record, frozen=True):
    """A value given for a parameter from outside of its declaration.

    Attributes:
        text: the value as text.
        span: the place of the value in the file in which problems are reported; `None` if it is not in this file.
        source: a phrase for what gives the value.
    """

    text: str
    span: Span | None
    source: str


def values(
    declared: tuple[Declared, ...],
    given: Mapping[str, Given],
    outer: Scope,
    problems: Problems,
    *,
    varied: bool = False,
) -> dict[str, ParameterValue]:
    """The values of the parameters of a document. The value of a parameter may use those that are declared before it.

    Args:
        given: name of a parameter -> the value that replaces the one in its declaration.
        outer: the parameters of the system, for a file of the system.
        varied: whether to use other values, which the parameters could have as well.
    """
    scope: dict[str, ParameterValue] = {}
    for parameter in declared:
        if not parameter.type:
            continue
        known = {**outer, **scope}
        value = _value(parameter, given.get(parameter.name.value), known, problems)
        value = value or _stand_in(parameter, known)
        scope[parameter.name.value] = _other(parameter, value, known) if varied else value
    return scope


def _other(parameter: Declared, value: ParameterValue, scope: Scope) -> ParameterValue:
    """Another value of a parameter, if there is one between its bounds that is easily found."""
    content = value.content
    if isinstance(content, str) or (parameter.value is not None and _constant(parameter.value.value) is None):
        return value  # the value of other parameters already makes the difference
    if isinstance(content, bool):
        return ParameterValue(value.type, not content)
    limits = [
        _bound(parameter, attribute, scope, Problems()) if attribute is not None else None
        for attribute in (parameter.least, parameter.most)
    ]
    step = 1 if value.kind is ScalarKind.INT else Fraction(1, 1024)
    for other in (content + step, content - step):
        least, most = limits
        is_valid = isinstance(read_value(str(other) if step == 1 else "0", value.type, {}), ParameterValue)
        if is_valid and (least is None or least <= other) and (most is None or other <= most):
            return ParameterValue(value.type, other)
    return value


def _constant(text: str) -> Content | None:
    """The value of an expression without names; `None` for other texts."""
    tree, findings = parse(Decoded(text, 0))
    return None if findings else evaluate(tree, {})


def _stand_in(parameter: Declared, scope: Scope) -> ParameterValue:
    """A value for a parameter without a valid one, so that this is reported only once: that of its declaration, if it
    is valid."""
    declared = None if parameter.value is None else _value(parameter, None, scope, Problems())
    if declared is not None:
        return declared
    kind = BASE_TYPES[parameter.type].kind
    content: Content = False if kind is ScalarKind.BOOL else "" if kind is ScalarKind.STRING else Fraction(1)
    return ParameterValue(parameter.type, content)


def _value(parameter: Declared, given: Given | None, scope: Scope, problems: Problems) -> ParameterValue | None:
    if parameter.value is None and given is None:
        if not _is_misspelled(parameter.element, "value"):
            message = f"the parameter `{parameter.name.value}` has no `value`; add one"
            problems.add(ExpansionProblem.DECLARATION, parameter.element.name_span, message)
        return None
    if given is not None:
        text, span, source = given.text, given.span or parameter.name.span, f" that {given.source} gives"
    else:
        assert parameter.value is not None
        text, span, source = parameter.value.value, parameter.value.value_span, ""
    value = read_value(text, parameter.type, scope)
    if isinstance(value, str):
        message = f"the value{source} cannot be that of the parameter `{parameter.name.value}`: {value}"
        problems.add(ExpansionProblem.VALUE, span, message)
        return None
    for bound, attribute in (("min", parameter.least), ("max", parameter.most)):
        if attribute is None:
            continue
        limit = _bound(parameter, attribute, scope, problems)
        if limit is None or not isinstance(value.content, Fraction):
            continue
        if value.content < limit if bound == "min" else value.content > limit:
            relation = "less than its `min`" if bound == "min" else "greater than its `max`"
            shown = number_text(limit, is_real=value.kind is ScalarKind.REAL)
            message = (
                f"the value {value.text}{source} for the parameter `{parameter.name.value}` is {relation}, {shown}; "
                "change the value or the bound"
            )
            problems.add(ExpansionProblem.VALUE, span, message)
    return value


def _bound(parameter: Declared, attribute: Attribute, scope: Scope, problems: Problems) -> Fraction | None:
    if BASE_TYPES[parameter.type].kind in (ScalarKind.BOOL, ScalarKind.STRING):
        message = f"a parameter of type `{parameter.type}` has no `{attribute.name}`; remove the attribute"
        problems.add(ExpansionProblem.DECLARATION, attribute.name_span, message)
        return None
    limit = read_value(attribute.value, parameter.type, scope)
    if isinstance(limit, str):
        message = f"the `{attribute.name}` of the parameter `{parameter.name.value}` has no value: {limit}"
        problems.add(ExpansionProblem.VALUE, attribute.value_span, message)
        return None
    assert isinstance(limit.content, Fraction)
    return limit.content
