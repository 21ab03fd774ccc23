# SPDX-License-Identifier: Apache-2.0
"""The target of a verification: a model, with the texts that its positions refer to."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, NamedTuple

from roaml.comparison import Comparison
from roaml.jani.constants import constant_values
from roaml.jani.expressions import Binary, Integer, Name
from roaml.jani.model import Model
from roaml.jani.nesting import is_nested
from roaml.jani.node import Node, Origin
from roaml.jani.properties import Property, walk
from roaml.jani.sentences import sentence
from roaml.record import Record, field, replace
from roaml.scxml.names import CLOCK_VARIABLES, STATUS_NAMES, assumptions_of, is_status
from roaml.text import SourceFile
from roaml.verification.expectations import Expectation, expectation_of
from roaml.views.ends import is_translation

if TYPE_CHECKING:
    from roaml.expansion.draws import DrawnNumber


class LineColumn(NamedTuple):
    """A position in a file; lines and columns begin at 1."""

    path: str
    line: int
    column: int


class VerificationTarget(Record, frozen=True):
    """A model, with the texts that its positions refer to.

    Attributes:
        path: the file that the user has named; "" for a model that was not read from a file.
        files: all files that were read, `path` first.
        source_of: the path of an origin -> the text of the file; `None` if it is unknown.
        clock: the variables with the seconds and nanoseconds of the time; `None` if the model has none.
        assumptions: the name of a property with assumptions -> the property which states that these hold.
        expectations: the expected values of the properties, from their files and from the configuration.
        parameters: name of a parameter of the system -> the text of its value (docs/spec/parameters.md).
        has_intervals: whether parameters are only known to be in intervals, so that schedulers choose their values
            (docs/spec/parameters.md#intervals).
        drawn: the numbers that machines draw from distributions (docs/spec/distributions.md#error).
    """

    path: str
    files: tuple[str, ...]
    model: Model
    source_of: Callable[[str], SourceFile | None]
    clock: tuple[str, str] | None
    assumptions: Mapping[str, Property] = field(default_factory=dict)
    expectations: tuple[Expectation, ...] = ()
    parameters: Mapping[str, str] = field(default_factory=dict)
    drawn: tuple[DrawnNumber, ...] = ()
    has_intervals: bool = False

    @property
    def properties(self) -> tuple[Property, ...]:
        """The properties of the model that can be verified: all except those that state assumptions."""
        assumed = {property_.name for property_ in self.assumptions.values()}
        return tuple(property_ for property_ in self.model.properties if property_.name not in assumed)

    def expecting(self, comparisons: Mapping[str, Comparison]) -> VerificationTarget:
        """The same target with further expectations. Comparisons for properties that it does not have are ignored."""
        names = {property_.name for property_ in self.properties}
        more = [expectation_of(name, comparison) for name, comparison in comparisons.items() if name in names]
        return replace(self, expectations=(*self.expectations, *more)) if more else self

    def place(self, origin: Origin | None) -> LineColumn | None:
        """The position of an origin; `None` if it is unknown."""
        source = None if origin is None else self.source_of(origin.path)
        if origin is None or source is None:
            return None
        start = source.lines.position(origin.span.start)
        return LineColumn(origin.path, start.line + 1, start.column + 1)


def target_of(
    model: Model,
    path: str = "",
    files: tuple[str, ...] = (),
    source_of: Callable[[str], SourceFile | None] = lambda _: None,
    conditional: Iterable[str] = (),
    clock_step: int | None = None,
) -> VerificationTarget:
    """A model as a target, with its clock if it has one, and with observers for nested formulas.

    Args:
        conditional: the names of the properties with assumptions.
        clock_step: the step of the clock in ns, if it is known.
    """
    if any(is_nested(formula) for property_ in model.properties for formula in walk(property_.expression)):
        from roaml.to_jani.state_observers import with_state_observers  # noqa: PLC0415 - most properties need none

        model = with_state_observers(model, clock_step)
    by_name = {property_.name: property_ for property_ in model.properties}
    assumptions = {name: by_name[assumptions_of(name)] for name in conditional if name in by_name}
    names = {variable.name for variable in model.variables}
    return VerificationTarget(
        path, files, model, source_of, CLOCK_VARIABLES if names.issuperset(CLOCK_VARIABLES) else None, assumptions
    )


def with_sentences(model: Model) -> Model:
    """The model with sentences as the comments of the properties that have none."""
    says = _Sentences(model)
    commented = (p if p.comment else replace(p, comment=says(p) or None) for p in model.properties)
    return replace(model, properties=tuple(commented))


def own_words(target: VerificationTarget, name: str) -> str:
    """What the files say about a property in words; "" if its sentence is computed from its formula."""
    says = _Sentences(target.model)
    comments = (p.comment for p in target.properties if p.name == name and p.comment != says(p))
    return next(comments, None) or ""


class _Sentences:
    """Sentences for the properties of a model, with names for users, such as those of topics, nodes of the tree and
    their statuses, and the values of constants."""

    def __init__(self, model: Model) -> None:
        self._constants = constant_values(model)
        self._names: Mapping[str, str] = {}
        self._statuses: frozenset[str] = frozenset()
        if is_translation(model):
            from roaml.views.actors import names_of  # noqa: PLC0415 - models that are no systems have no topics
            from roaml.views.shared_names import operand_names  # noqa: PLC0415 - as above

            self._names = operand_names((variable.name for variable in model.variables), names_of(model.automata))
            self._statuses = frozenset(name for variable, name in self._names.items() if is_status(variable))

    def __call__(self, property_: Property) -> str:
        if not self._names:
            return sentence(property_.expression, self._constants)
        from roaml.jani.rewrite import rewrite  # noqa: PLC0415 - as above

        return sentence(rewrite(property_.expression, self._in_words), self._constants)

    def _in_words(self, node: Node) -> Node:
        match node:
            case Name(identifier) if identifier in self._names:
                return replace(node, identifier=self._names[identifier])
            case Binary(left=Name(identifier), right=Integer(value) as number):
                if identifier in self._statuses and value in STATUS_NAMES:  # parts are rewritten first
                    return replace(node, right=Name(STATUS_NAMES[value], origin=number.origin))
        return node


def asking(target: VerificationTarget, names: Iterable[str]) -> VerificationTarget:
    """The same target with further properties: those among `names` that are not names but properties, which are written
    as in PRISM (`roaml.jani.property_text`). Their names are their texts.

    Raises:
        PropertyTextError: a text is not a property, names something that the model does not declare, or has a wrong
            type.
    """
    texts = [name for name in names if "[" in name]
    if not texts:
        return target
    # Most verifications need no parser of properties.
    from roaml.jani.property_text import PropertyTextError, is_property_text, read_property_text  # noqa: PLC0415
    from roaml.to_jani.counters import CounterError, is_counter, with_counter  # noqa: PLC0415

    model = target.model
    known = {property_.name for property_ in target.model.properties}
    added: list[Property] = []
    assumptions = dict(target.assumptions)
    for text in dict.fromkeys(texts):
        if text in known or not is_property_text(text):
            continue
        written = read_property_text(text, target.clock)
        if is_counter(written.reward):
            try:
                model = with_counter(model, written.reward)
            except CounterError as error:
                raise PropertyTextError(f"`{text}`: {error}") from None
        added.append(replace(_checked(model, text, text, written.expression), comment=written.remark or None))
        if written.given is not None:
            assumptions[text] = _checked(model, text, assumptions_of(text), written.given)
            added.append(assumptions[text])
    model = replace(model, properties=(*model.properties, *added))
    if any(is_nested(formula) for property_ in added for formula in walk(property_.expression)):
        from roaml.to_jani.state_observers import with_state_observers  # noqa: PLC0415

        model = with_state_observers(model)
    return replace(target, model=model, assumptions=assumptions)


def _checked(model: Model, text: str, name: str, expression: object) -> Property:
    """The property with a name and an expression, which is a value for JSON and a part of a text.

    Raises:
        PropertyTextError: it names something that the model does not declare, or has a wrong type.
    """
    import json  # noqa: PLC0415

    from roaml.jani.notes import NAME  # noqa: PLC0415
    from roaml.jani.properties import identifiers  # noqa: PLC0415
    from roaml.jani.property_text import PropertyTextError  # noqa: PLC0415
    from roaml.jani.reader import read_properties  # noqa: PLC0415
    from roaml.jani.typecheck import check_property, model_scope  # noqa: PLC0415
    from roaml.json_syntax import parse  # noqa: PLC0415
    from roaml.verification.labels import with_labels  # noqa: PLC0415
    from roaml.verification.unknown_names import unknown_variable  # noqa: PLC0415

    labelled = with_labels(expression, model)
    source = json.dumps({"properties": [{"name": name, "expression": labelled}]})
    value, _ = parse(source)
    properties, findings = read_properties(value)
    findings += tuple(finding for property_ in properties for finding in check_property(property_, model_scope(model)))
    if findings:
        span = findings[0].span
        named = next((p.name for p in model.properties if p.name == source[span.start : span.end].strip('"')), None)
        other = "" if named is None else f"; the property `{named}` is no condition, because it has not the form `F c`"
        message = findings[0].message
        unknown = next((n for n, span in identifiers(properties[0].expression) if span == findings[0].span), None)
        if findings[0].code == NAME and unknown is not None and named is None:
            message = unknown_variable(unknown, model, message)
        raise PropertyTextError(f"`{text}`: {message}{other}")
    return properties[0]
