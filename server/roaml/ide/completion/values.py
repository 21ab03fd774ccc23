# SPDX-License-Identifier: Apache-2.0
"""The possible values of an attribute, or of the text of an element, according to their roles in the schema."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Symbol
from roaml.expr.types import BASE_TYPES, INTEGER_RANGES, UNKNOWN, Scalar, Type, resolve_type, unwrap
from roaml.ide.completion import property_files
from roaml.ide.completion.expressions import in_expression, initial_values
from roaml.ide.completion.fields import field_names
from roaml.ide.completion.item import CompletionItem, ItemKind, Rank
from roaml.ide.completion.model_parameters import in_substitution, parameters_in_scope
from roaml.ide.completion.names import referred, undefined
from roaml.ide.completion.paths import paths
from roaml.ide.completion.ports import port_values
from roaml.ide.completion.request import CompletionSubject, Request
from roaml.ide.completion.scripts import in_script
from roaml.interfaces.types import Kind
from roaml.language import AttributeType
from roaml.model.kinds import FileKind
from roaml.model.syntax import type_of
from roaml.roles import SymbolKind, ValueRole
from roaml.scxml.names import STATUSES
from roaml.text import Span

_EXPRESSIONS = (ValueRole.EXPRESSION, ValueRole.LOCATION)
_OF_ROS = (SymbolKind.TOPIC, SymbolKind.SERVICE, SymbolKind.ACTION)


def in_attribute(
    request: Request, subject: CompletionSubject, name: str, span: Span
) -> tuple[Span, list[CompletionItem]] | None:
    """The span that the items replace, and the possible values of the attribute `name`; `None` if nothing is known
    about the attribute. `span` is the span of its current value."""
    known = subject.type.attributes.get(name)
    if (substitution := in_substitution(request, span)) is not None:
        return substitution
    if property_files.is_property_file(request) and (subject.type.name, name) == ("property", "expr"):
        in_formula = property_files.in_formula(request, span)
        return in_formula or in_expression(request, subject, name, property_files.formula_start(request, span))
    if known is not None and known.value in _EXPRESSIONS:
        return in_expression(request, subject, name, span.start)
    if (script := in_script(request, subject, name, span)) is not None:
        return script
    if request.file.grammar.title == "BehaviorTree.CPP XML" and (ports := port_values(request, subject, name)):
        return span, ports
    if known is None:
        return None
    return span, list(candidates(request, subject, known))


def candidates(request: Request, subject: CompletionSubject, attribute: AttributeType) -> Iterator[CompletionItem]:
    """The possible values of an attribute, each for the whole value."""
    for choice in attribute.simple.choices:
        about = Symbol(
            f"{subject.key}/{attribute.name}", SymbolKind.ENUMERATION_VALUE, choice.value, request.file.grammar.schema
        )
        yield CompletionItem(choice.value, ItemKind.VALUE, about=about, deprecated=bool(choice.use))
    for kind in attribute.refers:
        if property_files.is_property_file(request):
            is_field = kind is SymbolKind.FIELD
            yield from property_files.fields(request, subject) if is_field else ()
            yield from property_files.referred(request, kind, subject)
        elif kind is SymbolKind.FIELD:
            yield from field_names(request, subject)
        if kind in _OF_ROS or not property_files.is_property_file(request):
            yield from referred(request, kind, subject)
    if attribute.defines:
        yield from undefined(request, attribute.defines, subject)
        if attribute.defines is SymbolKind.PORT_VARIABLE:
            yield from property_files.new_ids(request, subject)
    yield from _of_value(request, subject, attribute.name, attribute.value, attribute.value_type)


def in_text(request: Request, subject: CompletionSubject, span: Span) -> tuple[Span, list[CompletionItem]] | None:
    """The span that the items replace, and the possible texts of an element; `None` in an expression where no name is
    possible."""
    type_ = subject.type
    if type_.value in _EXPRESSIONS:
        return in_expression(request, subject, type_.name, span.start)
    items = [item for kind in type_.refers for item in referred(request, kind, subject)]
    return span, [*items, *_of_value(request, subject, type_.name, type_.value, type_.value_type)]


def _of_value(
    request: Request, subject: CompletionSubject, name: str, value: ValueRole | None, value_type: str
) -> Iterator[CompletionItem]:
    match value:
        case ValueRole.TYPE if property_files.is_property_file(request):
            yield from property_files.field_type(request, subject)
            yield from types(request)
        case ValueRole.TYPE:
            yield from types(request)
        case ValueRole.ROS_TYPE:
            if property_files.is_property_file(request):
                yield from property_files.port_types(request, subject)
            yield from ros_types(request, value_type)
        case ValueRole.CONSTANT:
            yield from _bounds(request, subject) if "bound" in name else _constants(request, subject)
            yield from parameters_in_scope(request)
        case ValueRole.STATUS:
            yield from (CompletionItem(name, ItemKind.VALUE) for name in STATUSES)
        case ValueRole.CHILD_INDEX:
            yield from _children(request)
        case ValueRole.PATH:
            yield from paths(request, subject)
        case ValueRole.NUMBER:
            if subject.type.name == "target":
                yield from _remaining_probability(subject)
            yield from parameters_in_scope(request)


# ------------------------------------------------------------------------ types


def types(request: Request) -> Iterator[CompletionItem]:
    """Base types and the structs of the system."""
    for name in BASE_TYPES:
        yield CompletionItem(name, ItemKind.TYPE, about=Symbol("", SymbolKind.BASE_TYPE, name))
    structs = request.analysis.structs(request.system_path).types
    names = [name for system in request.systems for name in system.structs] or list(structs)
    if request.analysis.kind(request.path) is FileKind.STRUCTS:
        declared = request.analysis.struct_declarations(request.path)
        names += [declaration.outline.name for declaration in declared if declaration.outline is not None]
    for name in dict.fromkeys(names):
        owner = request.system_path or request.path
        yield CompletionItem(
            name, ItemKind.TYPE, detail="struct", about=Symbol(owner, SymbolKind.STRUCT, name), rank=Rank.LIKELY
        )


def ros_types(request: Request, kind: str) -> Iterator[CompletionItem]:
    """All ROS types of a kind. The types that the systems of the file use come first."""
    if kind not in ("msg", "srv", "action"):
        return
    ros_kind: Kind = kind  # type: ignore[assignment]
    uses = (use for system in request.systems for automaton in system.automata for use in automaton.outline.interfaces)
    used = {use.type for use in uses}
    for package, kinds in request.analysis.registry.search_path.packages().items():
        for name in kinds[ros_kind]:
            label = f"{package}/{name}"
            rank = Rank.LIKELY if label in used else Rank.USUAL
            yield CompletionItem(label, ItemKind.TYPE, about=Symbol("", SymbolKind.ROS_TYPE, label, kind), rank=rank)


def _constants(request: Request, subject: CompletionSubject) -> Iterator[CompletionItem]:
    """Typical initial values of a variable."""
    if property_files.is_property_file(request):
        yield from initial_values(property_files.variable_type(request, subject))
    else:
        yield from initial_values(_data_type(request, subject))


def _bounds(request: Request, subject: CompletionSubject) -> Iterator[CompletionItem]:
    """The smallest and the greatest value of the integer type of a variable."""
    inner, _ = unwrap(_data_type(request, subject))
    for number in INTEGER_RANGES.get(inner.name, ()) if isinstance(inner, Scalar) else ():
        yield CompletionItem(str(number), ItemKind.VALUE, detail=str(inner))


def _data_type(request: Request, subject: CompletionSubject) -> Type:
    """The declared type of the variable whose value is completed."""
    element = subject.element
    if subject.type.name != "data" and subject.parents:
        element = subject.parents[-1].element  # the parent of `<expr>` declares the variable
    type_ = type_of(element.get("type")) if element is not None else None
    if type_ is None or type_.name is None:
        return UNKNOWN
    return resolve_type(type_.name, request.environment.struct) or UNKNOWN


# ----------------------------------------------------------------------- others


def _children(request: Request) -> Iterator[CompletionItem]:
    """The indices of the children of the plugin's nodes, and integer variables."""
    machine = request.machine
    if machine is None:
        return
    counts = [
        len(instance.children)
        for system in request.systems
        for instance in system.instances
        if machine.name and instance.plugin == machine.name.value
    ]
    for index in range(max(counts, default=1)):
        yield CompletionItem(str(index), ItemKind.VALUE, detail="child", rank=Rank.BEST)
    for data in request.chart.data if request.chart else ():
        if data.id is not None and data.type is not None and "int" in data.type.text:
            yield CompletionItem(data.id.value, ItemKind.VARIABLE, detail=data.type.text)


def _remaining_probability(subject: CompletionSubject) -> Iterator[CompletionItem]:
    """The difference between 1 and the sum of the other probabilities."""
    if not subject.parents:
        return
    others = [child for child in subject.parents[-1].element.elements if child is not subject.element]
    given = 0.0
    for child in others:
        probability = child.get("prob")
        try:
            given += float(probability.value) if probability else 0.0
        except ValueError:
            return
    rest = round(1 - given, 9)
    if 0 < rest <= 1:
        yield CompletionItem(f"{rest:g}", ItemKind.VALUE, detail="the remaining probability", rank=Rank.BEST)
