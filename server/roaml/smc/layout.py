# SPDX-License-Identifier: Apache-2.0
"""The registers of variables and constants, and the meanings of names in each instance of an automaton."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, MutableSequence, Sequence
from typing import Any

from roaml.jani.expressions import ArrayAccess, Expression, Name
from roaml.jani.model import Assignment, Automaton, Function, Model, Variable
from roaml.jani.semantics import EvaluationError, Value, evaluate
from roaml.jani.types import ArrayType, BoundedType, Type
from roaml.record import Record
from roaml.smc import shapes
from roaml.smc.fault import FaultError
from roaml.smc.initial import OVERFLOW, InitialChoice, InitialCondition, OpenVariable, initial_choices
from roaml.smc.names import Meaning, Storage, StorageNames
from roaml.smc.registers import INT, REAL, Number, Operand, Tape, product
from roaml.smc.shapes import kind_of, larger, shape_of


class AutomatonInstance(Record, frozen=True):
    """An automaton as an element of the system. `own` contains the variables that it declares, and `transient` the
    names of those that are transient."""

    automaton: Automaton
    names: StorageNames
    own: tuple[Storage, ...]
    transient: frozenset[str]


class MemoryLayout(Record, frozen=True):
    """All variables of a model.

    Attributes:
        names: the meanings of names outside of automata.
        shared: the variables of the model.
        initial: the value of each storage in the first initial state, by the identity (`id`) of the storage.
        choices: the choices between initial values; empty if all variables have a single one.
    """

    names: StorageNames
    shared: tuple[Storage, ...]
    instances: tuple[AutomatonInstance, ...]
    initial: Mapping[int, Value]
    choices: tuple[InitialChoice, ...] = ()

    @property
    def storages(self) -> tuple[Storage, ...]:
        """All variables, in the order of their registers."""
        return (*self.shared, *(storage for instance in self.instances for storage in instance.own))


def lay_out(model: Model, tape: Tape) -> MemoryLayout:
    """Assign a register to everything that has a value; registers of variables come before all others.

    Raises:
        FaultError: a constant or variable has no value, or an invalid value or type; or an automaton of the system does
            not exist.
    """
    functions = {function.name: function for function in model.functions}
    constants = _constants(model, functions)
    initial: dict[int, Value] = {}
    values: dict[str, Meaning] = {}
    open_: list[OpenVariable] = []
    shared = _storages(model.variables, constants, functions, initial, open_)
    values.update({storage.name: storage for storage in shared})
    arrays = {c.name: constants[c.name] for c in model.constants if isinstance(c.type, ArrayType)}
    constant_arrays = []
    for constant in model.constants:
        if constant.name in arrays:
            storage = _storage(constant.name, constant.type, constants[constant.name])
            storage.is_constant = True
            initial[id(storage)] = constants[constant.name]
            constant_arrays.append(storage)
            values[constant.name] = storage
    drafts = []
    by_name = {automaton.name: automaton for automaton in model.automata}
    for element in model.system.elements:
        automaton = by_name.get(element.automaton)
        if automaton is None:
            raise FaultError(f"there is no automaton `{element.automaton}`", element.origin)
        inner = {**functions, **{function.name: function for function in automaton.functions}}
        own = _storages(automaton.variables, constants, inner, initial, open_)
        drafts.append((automaton, inner, own))
    scopes = [{**values, **{storage.name: storage for storage in own}} for _, _, own in drafts]
    named = [(a, StorageNames(scope, inner)) for (a, inner, _), scope in zip(drafts, scopes, strict=True)]
    _grow(named, constants)
    choices = initial_choices(_conditions(model, shared, drafts, functions), open_, constants, initial)
    for storage in (*shared, *(storage for _, _, own in drafts for storage in own)):
        _place(storage, initial[id(storage)], tape)
    for storage in constant_arrays:
        _place(storage, initial[id(storage)], tape)
    for constant in model.constants:
        if constant.name not in arrays:
            value = constants[constant.name]
            kind = kind_of(constant.type)
            assert isinstance(value, (bool, int, float))
            # A constant has the same register in every scope.
            operand = tape.constant(kind, float(value) if kind == REAL else value)
            values[constant.name] = operand
            for (_, _, own), scope in zip(drafts, scopes, strict=True):
                if constant.name not in {storage.name for storage in own}:
                    scope[constant.name] = operand
    instances = tuple(
        AutomatonInstance(
            automaton, StorageNames(scope, inner), own, frozenset(v.name for v in automaton.variables if v.transient)
        )
        for (automaton, inner, own), scope in zip(drafts, scopes, strict=True)
    )
    return MemoryLayout(StorageNames(values, functions), shared, instances, initial, choices)


def _conditions(
    model: Model,
    shared: tuple[Storage, ...],
    drafts: Sequence[tuple[Automaton, Mapping[str, Function], tuple[Storage, ...]]],
    functions: Mapping[str, Function],
) -> Iterator[InitialCondition]:
    """The conditions on initial states."""
    names = {storage.name: storage for storage in shared}
    if model.restrict_initial is not None:
        yield InitialCondition(model.restrict_initial.exp, names, functions)
    for automaton, inner, own in drafts:
        if automaton.restrict_initial is not None:
            known = {**names, **{storage.name: storage for storage in own}}
            yield InitialCondition(automaton.restrict_initial.exp, known, inner)


def _constants(model: Model, functions: Mapping[str, Function]) -> dict[str, Value]:
    known: dict[str, Value] = {}
    for constant in model.constants:
        if constant.value is None:
            hint = f"give it one as `{constant.name}=VALUE`"
            raise FaultError(f"the constant `{constant.name}` has no value; {hint}", constant.origin)
        known[constant.name] = _evaluated(constant.value, known, functions)
    return known


def _evaluated(expression: Expression, known: Mapping[str, Value], functions: Mapping[str, Function]) -> Value:
    try:
        value = evaluate(expression, known, functions)
    except EvaluationError as error:
        raise FaultError(error.message, error.origin or expression.origin) from None
    if not _fits(value):
        raise FaultError(OVERFLOW, expression.origin)
    return value


def _fits(value: Value) -> bool:
    """Whether all integers in a value fit into 64 bits. An element of an array of reals may be an integer."""
    if isinstance(value, tuple):
        return all(map(_fits, value))
    return not isinstance(value, int) or abs(value) < 1 << 63


def _storages(
    variables: Iterable[Variable],
    constants: Mapping[str, Value],
    functions: Mapping[str, Function],
    initial: dict[int, Value],
    open_: list[OpenVariable],
) -> tuple[Storage, ...]:
    """The storages of variables. Those without initial value are added to `open_`, the initial values of the others to
    `initial`."""
    storages = []
    for variable in variables:
        try:
            kind_of(variable.type)
        except FaultError as fault:
            raise FaultError(f"`{variable.name}`: {fault.message}", variable.origin) from None
        value: Value = None
        if variable.initial_value is not None:
            value = _evaluated(variable.initial_value, constants, functions)
        elif variable.transient or isinstance(variable.type, ArrayType):
            kind = "transient variable" if variable.transient else "array"
            raise FaultError(f"the {kind} `{variable.name}` has no initial value", variable.origin)
        storage = _storage(variable.name, variable.type, value)
        if isinstance(variable.type, BoundedType):
            ends: list[Number | None] = []
            for end in (variable.type.lower, variable.type.upper):
                bound = None if end is None else _evaluated(end, constants, functions)
                assert bound is None or isinstance(bound, (int, float))
                ends.append(bound)
            low, high = ends
            storage.bounds = low, high
            assert value is None or isinstance(value, (int, float))
            if value is not None and ((low is not None and value < low) or (high is not None and value > high)):
                raise FaultError(f"the initial value of `{variable.name}` is outside of its bounds", variable.origin)
        if value is None:
            open_.append(OpenVariable(storage, variable.origin))
        else:
            initial[id(storage)] = value
        storages.append(storage)
    return tuple(storages)


def _storage(name: str, type_: Type, value: Value) -> Storage:
    return Storage(name, type_, kind_of(type_), shape_of(value) if isinstance(type_, ArrayType) else ())


def _grow(scopes: list[tuple[Automaton, StorageNames]], constants: Mapping[str, Value]) -> None:
    """Make arrays as large as the largest value that is ever assigned to them."""
    known: dict[str, Meaning] = {
        name: Operand(INT, -1, value) for name, value in constants.items() if isinstance(value, (int, float))
    }
    assignments: list[tuple[Assignment, StorageNames, Storage, int]] = []
    for automaton, names in scopes:
        wider = StorageNames({**known, **names.values}, names.functions)
        for assignment in _assignments(automaton):
            depth = 0
            target: Expression = assignment.target
            while isinstance(target, ArrayAccess):
                depth, target = depth + 1, target.array
            storage = names.values.get(target.identifier) if isinstance(target, Name) else None
            if isinstance(storage, Storage) and depth < len(storage.shape):
                assignments.append((assignment, wider, storage, depth))
    for _ in range(len(assignments) + 1):
        changed = False
        for assignment, names, storage, depth in assignments:
            shape = shapes.shape(assignment.value, names)
            inner = storage.shape[depth:]
            if len(shape) == len(inner) and larger(inner, shape) != inner:
                storage.shape = (*storage.shape[:depth], *larger(inner, shape))
                changed = True
        if not changed:
            return
    raise FaultError(
        "assignments make the arrays of this model larger without limit; only arrays of a fixed size are supported"
    )


def _assignments(automaton: Automaton) -> Iterator[Assignment]:
    for edge in automaton.edges:
        for destination in edge.destinations:
            yield from destination.assignments


def _place(storage: Storage, value: Value, tape: Tape) -> None:
    storage.base = tape.reserve(storage.kind, product(storage.shape))
    cells: MutableSequence[Any] = tape.reals if storage.kind == REAL else tape.ints
    _fill(cells, storage.base, storage.shape, value)


def _fill(cells: MutableSequence[Any], base: int, shape: tuple[int, ...], value: Value) -> None:
    if not shape:
        assert isinstance(value, (bool, int, float))
        cells[base] = value if isinstance(value, float) else int(value)
        return
    assert isinstance(value, tuple)
    size = product(shape[1:])
    for position, element in enumerate(value):
        _fill(cells, base + position * size, shape[1:], element)
