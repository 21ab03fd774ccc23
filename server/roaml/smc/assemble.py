# SPDX-License-Identifier: Apache-2.0
"""Expressions -> bytecode.

- Types are known in advance, so each instruction is for ints or for reals.
- Conditions become jumps; `∧`, `∨`, `⇒` and `ite` evaluate only the operands that they need, as `roaml.jani.semantics`
  defines.
- Constant expressions are evaluated at compile time. An expression that always fails is compiled, too, because it may
  never be reached.
- Arrays have a fixed shape, that of the largest value ever stored in them; a smaller value is padded with zeros.
- The body of a function is compiled at each call.
"""

from __future__ import annotations

from collections.abc import Sequence

from roaml.jani.expressions import (
    ArrayAccess,
    ArrayConstructor,
    ArrayValue,
    Binary,
    Boolean,
    Call,
    Conditional,
    Expression,
    Integer,
    Name,
    NamedNumber,
    Real,
    Unary,
)
from roaml.jani.node import Origin
from roaml.jani.operators import BinaryOperator, Signature, UnaryOperator
from roaml.jani.types import ArrayType
from roaml.smc import opcodes, shapes
from roaml.smc.cells import CellAssembler
from roaml.smc.fault import FaultCode, FaultError
from roaml.smc.names import Meaning, Storage, StorageNames, unsupported
from roaml.smc.operations import ARITHMETIC, COMPARISONS, MAX_INT64, OperatorAssembler
from roaml.smc.registers import BOOL, INT, REAL, Label, Operand, Region, product
from roaml.smc.shapes import kind_of

_LOGICAL = (BinaryOperator.AND, BinaryOperator.OR, BinaryOperator.IMPLIES)


class ExpressionAssembler:
    """Writes the code of expressions."""

    def __init__(self, cells: CellAssembler) -> None:
        self.tape = cells.tape
        self.cells = cells
        self.operators = OperatorAssembler(cells)

    # ------------------------------------------------------------ pieces of code

    def condition(self, expression: Expression, names: StorageNames, origin: Origin | None = None) -> int:
        """Write code that returns 1 if `expression` holds, and 0 otherwise. Return the address of the code."""
        start = self.tape.begin(expression.origin or origin)
        otherwise = Label()
        self.jump(expression, names, otherwise, False)
        self.tape.emit(opcodes.RETURN, a=self.tape.constant(INT, 1).register)
        self.tape.mark(otherwise)
        self.tape.emit(opcodes.RETURN, a=self.tape.constant(INT, 0).register)
        self.tape.shorten(otherwise)
        return start

    def integer(self, expression: Expression, names: StorageNames) -> int:
        """Write code that returns the value of an integer `expression`. Return the address of the code."""
        start = self.tape.begin(expression.origin)
        self.tape.emit(opcodes.RETURN, a=self.value(expression, names).register)
        return start

    def real_register(self, expression: Expression, names: StorageNames, origin: Origin | None = None) -> int:
        """Write code that returns the number of the real register with the value of `expression`. Return the address of
        the code."""
        start = self.tape.begin(expression.origin or origin)
        value = self.cells.as_real(self.value(expression, names))
        self.tape.emit(opcodes.RETURN, a=self.tape.constant(INT, value.register).register)
        return start

    # ------------------------------------------------------------ scalars

    def value(self, node: Expression, names: StorageNames, into: int = -1) -> Operand:
        """Write code that computes a scalar, in the register `into` if it is given. Return the register with the
        value."""
        match node:
            case Integer():
                if abs(node.value) > MAX_INT64:
                    raise FaultError(f"`{node.value}` does not fit into 64 bits", node.origin)
                return self.cells.moved(self.tape.constant(INT, node.value), into)
            case Boolean():
                return self.cells.moved(self.tape.constant(BOOL, node.value), into)
            case Real():
                return self.cells.moved(self.tape.constant(REAL, node.value), into)
            case NamedNumber():
                return self.cells.moved(self.tape.constant(REAL, node.constant.number), into)
            case Name(identifier):
                meaning = names.meaning(node)
                if isinstance(meaning, Region) or (isinstance(meaning, Storage) and meaning.shape):
                    raise FaultError(f"`{identifier}` is an array; a single value is needed here", node.origin)
                if isinstance(meaning, Storage):
                    meaning = Operand(meaning.kind, meaning.base)
                return self.cells.moved(meaning, into)
            case Unary():
                return self.unary(node, names, into)
            case Binary():
                return self.binary(node, names, into)
            case Conditional(test, then, otherwise):
                return self.conditional(test, then, otherwise, names, into)
            case ArrayAccess():
                region = self.element(node, names)
                if region.shape:
                    raise FaultError("this is an array; a single value is needed here", node.origin)
                return self.cells.load(region, into)
            case Call():
                body, inner = self.called(node, names)
                return self.value(body, inner, into)
            case ArrayValue() | ArrayConstructor():
                raise FaultError("this is an array; a single value is needed here", node.origin)
            case _:
                raise FaultError(unsupported(node), node.origin)

    def stored(self, node: Expression, kind: str, names: StorageNames, into: int = -1) -> Operand:
        """Like `value`, with the result converted to `kind`.

        Raises:
            FaultError: a real number is stored as an integer, which JANI does not allow.
        """
        if kind != REAL:
            operand = self.value(node, names, into)
            if operand.kind == REAL:
                raise FaultError("a real number cannot be assigned to an integer; use `floor` or `ceil`", node.origin)
            return operand
        if shapes.kind(node, names) == REAL:
            return self.value(node, names, into)
        return self.cells.as_real(self.value(node, names), into)

    def unary(self, node: Unary, names: StorageNames, into: int) -> Operand:
        if node.operator is UnaryOperator.NOT:
            return self.boolean(node, names, into)
        return self.operators.applied(node, self.value(node.operand, names), into)

    def binary(self, node: Binary, names: StorageNames, into: int) -> Operand:
        op = node.operator
        if op in _LOGICAL or op in COMPARISONS:
            return self.boolean(node, names, into)
        left, right = node.left, node.right
        if isinstance(left, Binary) and left.operator is op and op in ARITHMETIC:
            return self.chain(node, names, into)
        first = self.value(left, names)
        return self.operators.computed(node, first, self.value(right, names), into)

    def chain(self, node: Binary, names: StorageNames, into: int) -> Operand:
        """Write code that applies one arithmetic operator to any number of operands, such as `a + b + c`."""
        parts: list[Binary] = [node]
        while isinstance(parts[-1].left, Binary) and parts[-1].left.operator is node.operator:
            parts.append(parts[-1].left)
        result = self.value(parts[-1].left, names)
        for part in reversed(parts):
            result = self.operators.computed(part, result, self.value(part.right, names), into if part is node else -1)
        return result

    def conditional(
        self, test: Expression, then: Expression, otherwise: Expression, names: StorageNames, into: int
    ) -> Operand:
        kind = REAL if REAL in (shapes.kind(then, names), shapes.kind(otherwise, names)) else shapes.kind(then, names)
        # The branches may read the target, so they do not write directly into it.
        register = self.tape.temporary(kind)
        no, end = Label(), Label()
        self.jump(test, names, no, False)
        self.stored(then, kind, names, register)
        self.tape.jump(opcodes.JUMP, end)
        self.tape.mark(no)
        self.stored(otherwise, kind, names, register)
        self.tape.mark(end)
        return self.cells.moved(Operand(kind, register), into)

    def boolean(self, node: Expression, names: StorageNames, into: int) -> Operand:
        register = self.tape.temporary(BOOL)
        no, end = Label(), Label()
        self.jump(node, names, no, False)
        self.tape.emit(opcodes.MOVE, register, self.tape.constant(INT, 1).register)
        self.tape.jump(opcodes.JUMP, end)
        self.tape.mark(no)
        self.tape.emit(opcodes.MOVE, register, self.tape.constant(INT, 0).register)
        self.tape.mark(end)
        return self.cells.moved(Operand(BOOL, register), into)

    # ------------------------------------------------------------ conditions

    def jump(self, node: Expression, names: StorageNames, label: Label, when: bool) -> None:
        """Write code that jumps to `label` if the value of `node` is `when`, and continues otherwise."""
        while isinstance(node, Unary) and node.operator is UnaryOperator.NOT:
            node, when = node.operand, not when
        match node:
            case Binary(operator=op) if op in _LOGICAL:
                self.logical(node, names, label, when)
            case Binary(operator=op) if op in COMPARISONS:
                self.comparison(node, names, label, when)
            case Conditional(test, then, otherwise):
                no, end = Label(), Label()
                self.jump(test, names, no, False)
                self.jump(then, names, label, when)
                self.tape.jump(opcodes.JUMP, end)
                self.tape.mark(no)
                self.jump(otherwise, names, label, when)
                self.tape.mark(end)
            case _:
                value = self.value(node, names)
                if value.value is not None:
                    if bool(value.value) is when:
                        self.tape.jump(opcodes.JUMP, label)
                else:
                    self.tape.jump(opcodes.JUMP_TRUE if when else opcodes.JUMP_FALSE, label, value.register)

    def logical(self, node: Binary, names: StorageNames, label: Label, when: bool) -> None:
        """Like `jump`, for a logical operator. Chains of one operator may have any length."""
        parts: list[Expression] = [node]
        while isinstance(parts[-1], Binary) and parts[-1].operator is node.operator:
            last = parts.pop()
            assert isinstance(last, Binary)
            parts += (last.right, last.left)
            if node.operator is BinaryOperator.IMPLIES:
                break
        parts.reverse()
        # a ⇒ b is ¬a ∨ b. An operand with the value `decisive` decides the result.
        decisive = node.operator is not BinaryOperator.AND
        is_implication = node.operator is BinaryOperator.IMPLIES
        if when is decisive:
            for number, part in enumerate(parts):
                self.jump(part, names, label, decisive is not (is_implication and number == 0))
            return
        end = Label()
        for number, part in enumerate(parts[:-1]):
            self.jump(part, names, end, decisive is not (is_implication and number == 0))
        self.jump(parts[-1], names, label, when)
        self.tape.mark(end)

    def comparison(self, node: Binary, names: StorageNames, label: Label, when: bool) -> None:
        op, left, right = node.operator, node.left, node.right
        if op.signature is Signature.EQUALITY and (shapes.shape(left, names) or shapes.shape(right, names)):
            self.array_comparison(node, names, label, when)
            return
        self.operators.compared(op, self.value(left, names), self.value(right, names), label, when)

    def array_comparison(self, node: Binary, names: StorageNames, label: Label, when: bool) -> None:
        equal = node.operator is BinaryOperator.EQUAL
        shape, other = shapes.shape(node.left, names), shapes.shape(node.right, names)
        if shape != other:
            if equal is not when:
                self.tape.jump(opcodes.JUMP, label)
            return
        kind = REAL if REAL in (shapes.kind(node.left, names), shapes.kind(node.right, names)) else INT
        left, right = (self.materialized(operand, kind, shape, names) for operand in (node.left, node.right))
        unequal = Label()
        goes = label if equal is not when else unequal
        code = opcodes.JUMP_NE_REAL if kind == REAL else opcodes.JUMP_NE
        for i in range(product(shape)):
            self.tape.jump(code, goes, left.base + i, right.base + i)
        if equal is when:
            self.tape.jump(opcodes.JUMP, label)
        self.tape.mark(unequal)

    # ------------------------------------------------------------ arrays

    def element(self, node: ArrayAccess, names: StorageNames) -> Region:
        """The part of an array that is accessed; its shape is () for a single element."""
        indexes: list[ArrayAccess] = []
        inner: Expression = node
        while isinstance(inner, ArrayAccess):
            indexes.append(inner)
            inner = inner.array
        indexes.reverse()
        array = self.region(inner, names)
        if len(indexes) > len(array.shape):
            raise FaultError("this is not an array", node.origin)
        return self.indexed(array, indexes, names)

    def indexed(self, array: Region, accesses: Sequence[ArrayAccess], names: StorageNames) -> Region:
        offset = array.offset
        base, shape = array.base, array.shape
        fixed = 0
        for access in accesses:
            length, shape = shape[0], shape[1:]
            index = self.value(access.index, names)
            size = product(shape)
            if index.value is not None:
                if not 0 <= index.value < length:
                    value = int(index.value)
                    self.cells.failing(access, FaultCode.INDEX, INT, max(min(value, 2**31 - 1), -(2**31)), length)
                else:
                    fixed += int(index.value) * size
                continue
            self.tape.place(access.origin)
            self.tape.emit(opcodes.INDEX, a=index.register, b=length)
            step = self.tape.temporary(INT)
            self.tape.emit(opcodes.MOVE, step, index.register)
            zero = self.tape.constant(INT, 0).register
            if size != 1:
                self.tape.emit(opcodes.OFFSET, step, zero, size)
            if offset >= 0:
                self.tape.emit(opcodes.ADD, step, step, offset)
            offset = step
        return Region(array.kind, shape, base + fixed, offset)

    def region(self, node: Expression, names: StorageNames) -> Region:
        """The registers of an array; an array that is not in registers is copied to new ones."""
        match node:
            case Name():
                meaning = names.meaning(node)
                if isinstance(meaning, Storage):
                    return Region(meaning.kind, meaning.shape, meaning.base)
                if isinstance(meaning, Region):
                    return meaning
                raise FaultError(f"`{node.identifier}` is not an array", node.origin)
            case ArrayAccess():
                return self.element(node, names)
            case _:
                return self.materialized(node, shapes.kind(node, names), shapes.shape(node, names), names)

    def materialized(self, node: Expression, kind: str, shape: tuple[int, ...], names: StorageNames) -> Region:
        """Write code that stores an array in new registers; return these registers."""
        region = Region(kind, shape, self.tape.reserve(kind, product(shape)))
        self.fill(node, region, names)
        return region

    def fill(self, node: Expression, into: Region, names: StorageNames, watch: int = -1) -> None:
        """Write code that stores an array in a region whose `offset` is -1. A smaller array is padded with zeros."""
        match node:
            case ArrayValue(elements):
                if len(elements) > into.shape[0]:
                    self.cells.failing(node, FaultCode.INDEX, INT, into.shape[0], into.shape[0])
                    return
                for position in range(into.shape[0]):
                    part = self.cells.part(into, position)
                    if position >= len(elements):
                        self.cells.clear(part, watch)
                    elif part.shape:
                        self.fill(elements[position], part, names, watch)
                    else:
                        self.put(elements[position], part, names, watch)
            case ArrayConstructor(variable, _, body):
                size = shapes.length(node, names)
                for position in range(into.shape[0]):
                    part = self.cells.part(into, position)
                    if position >= size:
                        self.cells.clear(part, watch)
                        continue
                    inner = names.bound({variable: self.tape.constant(INT, position)})
                    if part.shape:
                        self.fill(body, part, inner, watch)
                    else:
                        self.put(body, part, inner, watch)
            case Conditional(test, then, otherwise):
                no, end = Label(), Label()
                self.jump(test, names, no, False)
                self.fill(then, into, names, watch)
                self.tape.jump(opcodes.JUMP, end)
                self.tape.mark(no)
                self.fill(otherwise, into, names, watch)
                self.tape.mark(end)
            case Call():
                body, inner = self.called(node, names)
                self.fill(body, into, inner, watch)
            case _:
                self.cells.copy(self.region(node, names), into, watch, node)

    def put(self, node: Expression, cell: Region, names: StorageNames, watch: int) -> None:
        """Write code that stores a scalar in a single cell."""
        if watch < 0 and cell.offset < 0:
            self.stored(node, cell.kind, names, cell.base)
            return
        self.cells.write(self.stored(node, cell.kind, names), cell, watch)

    # ------------------------------------------------------------ functions

    def called(self, node: Call, names: StorageNames) -> tuple[Expression, StorageNames]:
        """The body of a function, and the meanings of names in it."""
        function = names.called(node)
        bound: dict[str, Meaning] = {}
        for parameter, argument in zip(function.parameters, node.arguments, strict=True):
            if isinstance(parameter.type, ArrayType):
                bound[parameter.name] = self.region(argument, names)
            else:
                kind = kind_of(parameter.type)
                value = self.stored(argument, kind, names)
                bound[parameter.name] = Operand(kind, value.register, value.value)
        return function.body, names.inside(function, bound)
