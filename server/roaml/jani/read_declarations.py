# SPDX-License-Identifier: Apache-2.0
"""Reads the declarations of a model or an automaton from JSON: actions, constants, variables, datatypes and
functions."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.jani.expressions import Expression, LValue, Missing
from roaml.jani.members import Members, ObjectShape, shape
from roaml.jani.model import (
    Action,
    Clause,
    Constant,
    Datatype,
    DatatypeMember,
    Function,
    Parameter,
    Variable,
)
from roaml.jani.names import DeclaredNames
from roaml.jani.notes import SYNTAX, Notes
from roaml.jani.read_formulas import FormulaReader
from roaml.jani.types import INT, REAL, UNKNOWN, ArrayType, BasicType, BoundedType, DatatypeType, OptionType, Type
from roaml.json_syntax import JsonObject, JsonString, JsonValue
from roaml.text import Span

_ACTION = shape("an action", "name", "comment")
_CONSTANT = shape("a constant", "name type", "value comment")
_VARIABLE = shape("a variable", "name type", "transient initial-value comment")
_DATATYPE = shape("a datatype", "name members", "comment")
_DATATYPE_MEMBER = shape("a member of a datatype", "name type", "comment")
_FUNCTION = shape("a function", "name type parameters body", "comment")
_PARAMETER = shape("a parameter", "name type", "comment")
_BOUNDED_TYPE = shape("a bounded type", "kind base", "lower-bound upper-bound")
_ARRAY_TYPE = shape("an array type", "kind base")
_OPTION_TYPE = shape("an option type", "kind base")
_DATATYPE_TYPE = shape("a reference to a datatype", "kind ref")
_CLAUSE = shape("an expression with a comment", "exp", "comment")


class DeclarationReader(FormulaReader):
    """Reads the declarations of one file and collects their names."""

    def __init__(self, path: str, notes: Notes) -> None:
        super().__init__(path, notes)
        self.actions = DeclaredNames("action", notes)
        self.variables = DeclaredNames("variable", notes)
        self.functions = DeclaredNames("function", notes)

    def actions_of(self, model: Members) -> tuple[Action, ...]:
        actions: list[Action] = []
        for members in self.objects(model, "actions", _ACTION):
            if name := self.declare(members, self.actions):
                actions.append(Action(name, comment=members.comment(), origin=members.origin))
        return tuple(actions)

    def constants(self, model: Members) -> tuple[Constant, ...]:
        constants: list[Constant] = []
        for members in self.objects(model, "constants", _CONSTANT):
            if name := self.declare(members, self.variables):
                value = self.optional(members, "value")
                type_ = self.type(members, "type")
                constants.append(Constant(name, type_, value, comment=members.comment(), origin=members.origin))
        return tuple(constants)

    def variables_of(self, owner: Members, names: DeclaredNames) -> tuple[Variable, ...]:
        """The variables of a model or an automaton."""
        variables: list[Variable] = []
        for members in self.objects(owner, "variables", _VARIABLE):
            if name := self.declare(members, names):
                variable = Variable(
                    name,
                    self.type(members, "type"),
                    self.optional(members, "initial-value"),
                    members.flag("transient") or False,
                    comment=members.comment(),
                    origin=members.origin,
                )
                variables.append(variable)
        return tuple(variables)

    def datatypes(self, model: Members) -> tuple[Datatype, ...]:
        datatypes: list[Datatype] = []
        names = DeclaredNames("datatype", self.notes)
        for members in self.objects(model, "datatypes", _DATATYPE):
            parts: list[DatatypeMember] = []
            part_names = DeclaredNames("member", self.notes)
            for part in self.objects(members, "members", _DATATYPE_MEMBER):
                if name := self.declare(part, part_names):
                    type_ = self.type(part, "type")
                    parts.append(DatatypeMember(name, type_, comment=part.comment(), origin=part.origin))
            if name := self.declare(members, names):
                datatypes.append(Datatype(name, tuple(parts), comment=members.comment(), origin=members.origin))
        return tuple(datatypes)

    def functions_of(self, owner: Members, names: DeclaredNames) -> tuple[Function, ...]:
        """The functions of a model or an automaton."""
        functions: list[Function] = []
        for members in self.objects(owner, "functions", _FUNCTION):
            parameters: list[Parameter] = []
            parameter_names = DeclaredNames("parameter", self.notes)
            for part in self.objects(members, "parameters", _PARAMETER):
                if name := self.declare(part, parameter_names):
                    type_ = self.type(part, "type")
                    parameters.append(Parameter(name, type_, comment=part.comment(), origin=part.origin))
            if name := self.declare(members, names):
                function = Function(
                    name,
                    self.type(members, "type"),
                    tuple(parameters),
                    self.required(members, "body"),
                    comment=members.comment(),
                    origin=members.origin,
                )
                functions.append(function)
        return tuple(functions)

    def type(self, members: Members, key: str) -> Type:
        """The type in the member `key`. Types can be nested as deeply as expressions, so this is a loop."""
        value = members.values.get(key)
        wrappers: list[type[ArrayType | OptionType]] = []
        while isinstance(value, JsonObject) and (kind := value.get("kind")) and isinstance(kind, JsonString):
            if kind.value not in ("array", "option"):
                break
            is_array = kind.value == "array"
            wrappers.append(ArrayType if is_array else OptionType)
            value = Members(value, _ARRAY_TYPE if is_array else _OPTION_TYPE, self).values.get("base")
        type_ = UNKNOWN if value is None else self.simple_type(value)
        for wrapper in reversed(wrappers):
            type_ = wrapper(type_)
        return type_

    def simple_type(self, value: JsonValue) -> Type:
        if not isinstance(value, JsonObject):
            return self.choice(value, "type", BasicType) or UNKNOWN
        kind = value.get("kind")
        if isinstance(kind, JsonString) and kind.value == "bounded":
            members = Members(value, _BOUNDED_TYPE, self)
            base = self.choice(members.values.get("base"), "type", BasicType)
            if base is not None and base not in (INT, REAL):
                self.notes.syntax(members.values["base"].span, "only int and real can have bounds")
            return BoundedType(
                base or INT, self.optional(members, "lower-bound"), self.optional(members, "upper-bound")
            )
        if isinstance(kind, JsonString) and kind.value == "datatype":
            return DatatypeType(Members(value, _DATATYPE_TYPE, self).text("ref") or "")
        if isinstance(kind, JsonString):
            kinds = ("array", "bounded", "datatype", "option")
            self.notes.unknown("kind of type", kind.value, kind.content_span, kinds, code=SYNTAX)
        else:
            self.notes.syntax(Span(value.start, value.start + 1), "a type needs `kind`")
        return UNKNOWN

    # ---------------------------------------------------------------- members

    def objects(self, owner: Members, key: str, form: ObjectShape) -> Iterator[Members]:
        """The members of each object in the list `key`. Items that are not objects are reported and left out."""
        for item in owner.items(key):
            if isinstance(item, JsonObject):
                yield Members(item, form, self)
            else:
                self.members(item, form)

    def declare(self, members: Members, names: DeclaredNames) -> str | None:
        name = members.string("name")
        if name is None:
            return None
        names.declare(name)
        return name.value

    def use(self, members: Members, key: str, names: DeclaredNames) -> str | None:
        """The name in the member `key`. A name that is not declared is reported."""
        name = members.string(key)
        if name is None:
            return None
        names.use(name)
        return name.value

    def uses(self, members: Members, key: str, names: DeclaredNames) -> tuple[str, ...]:
        """The names in the list `key`. Names that are not declared are reported."""
        used: list[str] = []
        for item in members.items(key):
            if isinstance(item, JsonString):
                names.use(item)
                used.append(item.value)
            else:
                self.wrong_kind(item, f"an entry of `{key}` must be a string")
        return tuple(used)

    def required(self, members: Members, key: str) -> Expression:
        value = members.values.get(key)
        return Missing(origin=members.origin) if value is None else self.expression(value)

    def optional(self, members: Members, key: str) -> Expression | None:
        value = members.values.get(key)
        return None if value is None else self.expression(value)

    def target(self, members: Members) -> LValue:
        value = members.values.get("ref")
        return Missing(origin=members.origin) if value is None else self.lvalue(value)

    def clause(self, owner: Members, key: str) -> Clause | None:
        value = owner.values.get(key)
        members = None if value is None else self.members(value, _CLAUSE)
        if members is None:
            return None
        return Clause(self.required(members, "exp"), comment=members.comment(), origin=members.origin)
