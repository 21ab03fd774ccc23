# SPDX-License-Identifier: Apache-2.0
"""Writes a JANI model as JSON text.

- The same model always gives the same bytes.
- Reading the output gives an equal model: numbers keep their value and their type (int or real).
- The output declares the features of the model, and the features that its parts require.
- The table of synchronisations, which has an entry for each automaton and each synchronisation, is streamed: only one
  of its lines is in memory at a time.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.durations import duration_text
from roaml.exhaustive import assert_never
from roaml.jani.features import Feature
from roaml.jani.model import (
    Action,
    Assignment,
    Automaton,
    Clause,
    Clock,
    Constant,
    Datatype,
    DatatypeMember,
    Destination,
    Edge,
    Element,
    Function,
    Location,
    Metadata,
    Model,
    Parameter,
    Sync,
    TransientValue,
    Variable,
)
from roaml.jani.properties import Property
from roaml.jani.reaction import without_hold
from roaml.jani.types import ArrayType, BasicType, BoundedType, DatatypeType, OptionType, Type, UnknownType
from roaml.jani.write_formulas import FormulaWriter
from roaml.json_syntax import indented, quote


def write(model: Model, indent: int | None = None) -> Iterator[str]:
    """The JSON text of `model` in pieces: compact if `indent` is `None`, otherwise with `indent` spaces for each level.

    Raises:
        ValueError: the model has parts that the reader could not read; see `FormulaWriter.text`.
    """
    chunks = _Writer().model(without_hold(model))
    return chunks if indent is None else indented(chunks, indent)


def write_properties(properties: Iterable[Property], indent: int | None = None) -> str:
    """The JSON text of a list of properties; for `indent`, see `write`."""
    text = _list(map(_Writer().property, properties))
    return text if indent is None else "".join(indented([text], indent))


class _Writer:
    def __init__(self) -> None:
        self.formulas = FormulaWriter()

    def model(self, model: Model) -> Iterator[str]:
        """The JSON text in chunks. No chunk begins or ends inside a token, or between the brackets of an empty list."""
        declarations = self.declarations(model)
        # Automata and properties are written first, because the features that they require precede them in the file.
        automata = [self.automaton(automaton) for automaton in model.automata]
        properties = _list(map(self.property, model.properties))
        yield f'{{"jani-version":1,"name":{quote(model.name)},"type":"{model.type.value}",'
        yield f'"features":{_list(map(quote, self.features(model)))},'
        if model.metadata is not None:
            yield f'"metadata":{_metadata(model.metadata)},'
        yield declarations
        yield ',"automata":'
        if not automata:
            yield "[]"
        for number, automaton in enumerate(automata):
            yield f",{automaton}" if number else f"[{automaton}"
        yield '],"system":' if automata else ',"system":'
        yield from _system(model)
        yield f',"properties":{properties}}}'

    def declarations(self, model: Model) -> str:
        """The members of the model that precede the automata."""
        members = _object(
            datatypes=_unless_empty(map(self.datatype, model.datatypes)),
            variables=_list(map(self.variable, model.variables)),
            constants=_list(map(self.constant, model.constants)),
            functions=_unless_empty(map(self.function, model.functions)),
            actions=_list(map(_action, model.actions)),
            restrict_initial=self.clause(model.restrict_initial),
        )
        return members[1:-1]

    def features(self, model: Model) -> list[str]:
        """The features that the model declares, followed by those that the parts written so far require."""
        if model.functions or any(automaton.functions for automaton in model.automata):
            self.formulas.features.add(Feature.FUNCTIONS)
        if model.datatypes:
            self.formulas.features.add(Feature.DATATYPES)
        needed = {feature.value for feature in self.formulas.features}
        return [*model.features, *sorted(needed.difference(model.features))]

    def datatype(self, datatype: Datatype) -> str:
        members = _list(map(self.typed, datatype.members))
        return _object(name=quote(datatype.name), members=members, comment=_text(datatype.comment))

    def variable(self, variable: Variable) -> str:
        return _object(
            name=quote(variable.name),
            type=self.type(variable.type),
            transient="true" if variable.transient else "false",
            initial_value=None if variable.initial_value is None else self.formulas.text(variable.initial_value),
            comment=_text(variable.comment),
        )

    def constant(self, constant: Constant) -> str:
        return _object(
            name=quote(constant.name),
            type=self.type(constant.type),
            value=None if constant.value is None else self.formulas.text(constant.value),
            comment=_text(constant.comment),
        )

    def function(self, function: Function) -> str:
        return _object(
            name=quote(function.name),
            type=self.type(function.type),
            parameters=_list(map(self.typed, function.parameters)),
            body=self.formulas.text(function.body),
            comment=_text(function.comment),
        )

    def typed(self, declaration: DatatypeMember | Parameter) -> str:
        comment = _text(declaration.comment)
        return _object(name=quote(declaration.name), type=self.type(declaration.type), comment=comment)

    def type(self, type_: Type) -> str:
        match type_:
            case BasicType():
                return f'"{type_.value}"'
            case BoundedType(base, lower, upper):
                return _object(
                    kind='"bounded"',
                    base=f'"{base.value}"',
                    lower_bound=None if lower is None else self.formulas.text(lower),
                    upper_bound=None if upper is None else self.formulas.text(upper),
                )
            case ArrayType():
                return self.nested(type_)
            case OptionType():
                return self.nested(type_)
            case DatatypeType(name):
                self.formulas.features.add(Feature.DATATYPES)
                return _object(kind='"datatype"', ref=quote(name))
            case UnknownType():
                raise ValueError("a model with unknown types cannot be written")
            case _:
                return assert_never(type_)

    def nested(self, type_: ArrayType | OptionType) -> str:
        """The JSON text of a type. Types can be nested as deeply as expressions, so this is a loop."""
        inner: Type = type_
        depth = 0
        text = ""
        while isinstance(inner, (ArrayType, OptionType)):
            is_array = isinstance(inner, ArrayType)
            self.formulas.features.add(Feature.ARRAYS if is_array else Feature.DATATYPES)
            text += f'{{"kind":"{"array" if is_array else "option"}","base":'
            inner = inner.element if isinstance(inner, ArrayType) else inner.content
            depth += 1
        return text + self.type(inner) + "}" * depth

    def automaton(self, automaton: Automaton) -> str:
        return _object(
            name=quote(automaton.name),
            locations=_list(map(self.location, automaton.locations)),
            initial_locations=_list(map(quote, automaton.initial_locations)),
            edges=_list(map(self.edge, automaton.edges)),
            variables=_unless_empty(map(self.variable, automaton.variables)),
            functions=_unless_empty(map(self.function, automaton.functions)),
            restrict_initial=self.clause(automaton.restrict_initial),
            comment=_text(automaton.comment),
        )

    def location(self, location: Location) -> str:
        return _object(
            name=quote(location.name),
            time_progress=self.clause(location.time_progress),
            transient_values=_unless_empty(map(self.transient_value, location.transient_values)),
            comment=_text(location.comment),
        )

    def transient_value(self, value: TransientValue) -> str:
        ref = self.formulas.text(value.target)
        return _object(ref=ref, value=self.formulas.text(value.value), comment=_text(value.comment))

    def edge(self, edge: Edge) -> str:
        return _object(
            location=quote(edge.source),
            destinations=_list(map(self.destination, edge.destinations)),
            action=None if edge.action is None else quote(edge.action),
            guard=self.clause(edge.guard),
            rate=self.clause(edge.rate),
            comment=_text(edge.comment),
        )

    def destination(self, destination: Destination) -> str:
        return _object(
            location=quote(destination.location),
            probability=self.clause(destination.probability),
            assignments=_list(map(self.assignment, destination.assignments)),
            comment=_text(destination.comment),
        )

    def assignment(self, assignment: Assignment) -> str:
        return _object(
            ref=self.formulas.text(assignment.target),
            value=self.formulas.text(assignment.value),
            index=str(assignment.index),
            comment=_text(assignment.comment),
        )

    def clause(self, clause: Clause | None) -> str | None:
        if clause is None:
            return None
        return _object(exp=self.formulas.text(clause.exp), comment=_text(clause.comment))

    def property(self, property_: Property) -> str:
        expression = self.formulas.text(property_.expression)
        return _object(name=quote(property_.name), expression=expression, comment=_text(property_.comment))


def _metadata(metadata: Metadata) -> str:
    return _object(
        version=_text(metadata.version),
        author=_text(metadata.author),
        description=_text(metadata.description),
        doi=_text(metadata.doi),
        url=_text(metadata.url),
        clock=None if metadata.clock is None else _clock(metadata.clock),
        reaction_time=None if metadata.clock is None else quote(metadata.reaction_time.text),
    )


def _clock(clock: Clock) -> str:
    actions = _list(map(quote, clock.actions))
    return _object(automaton=quote(clock.automaton), actions=actions, step=quote(duration_text(clock.step)))


def _action(action: Action) -> str:
    return _object(name=quote(action.name), comment=_text(action.comment))


def _system(model: Model) -> Iterator[str]:
    system = model.system
    yield f'{{"elements":{_list(map(_element, system.elements))},"syncs":'
    if not system.syncs:
        yield "[]"
    for position, sync in enumerate(system.syncs):
        yield ("," if position else "[") + _sync(sync, len(system.elements))
    if system.syncs:
        yield "]"
    yield "}" if system.comment is None else f',"comment":{quote(system.comment)}}}'


def _element(element: Element) -> str:
    return _object(
        automaton=quote(element.automaton),
        input_enable=_unless_empty(map(quote, element.input_enable)),
        comment=_text(element.comment),
    )


def _sync(sync: Sync, size: int) -> str:
    """A line of the table of synchronisations, with `null` for every element that does not take part."""
    parts: list[str] = []
    done = 0
    for index, action in sorted(sync.participants):
        parts += ("null," * (index - done), quote(action), ",")
        done = index + 1
    parts.append("null," * (size - done))
    return _object(
        result=_text(sync.result),
        synchronise=f"[{''.join(parts)[:-1]}]",
        comment=_text(sync.comment),
    )


def _text(text: str | None) -> str | None:
    return None if text is None else quote(text)


def _object(**members: str | None) -> str:
    """A JSON object. The argument `a_b` becomes the member `a-b`; arguments that are `None` are left out."""
    return (
        "{" + ",".join(f'"{key.replace("_", "-")}":{text}' for key, text in members.items() if text is not None) + "}"
    )


def _list(items: Iterable[str]) -> str:
    return f"[{','.join(items)}]"


def _unless_empty(items: Iterable[str]) -> str | None:
    text = _list(items)
    return None if text == "[]" else text
