# SPDX-License-Identifier: Apache-2.0
"""Expressions -> bytecode.

- Types are known beforehand, so each instruction is for ints or for reals.
- Conditions become jumps; `∧`, `∨`, `⇒` and `ite` compute only what they need, as `roaml.jani.semantics` defines.
- What has a value already is computed here. What can only go wrong stays in the code: it may never be reached.
- Arrays have a fixed shape, that of the largest value ever stored in them; a smaller value is filled up with zeros.
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
from roaml.jani.model import Function
from roaml.jani.node import Node, Origin
from roaml.jani.operators import BinaryOperator, Operator, Signature, UnaryOperator
from roaml.jani.semantics import EvaluationError, evaluate
from roaml.jani.types import ArrayType
from roaml.smc.fault import FaultError
from roaml.smc.names import Meaning, Names, Storage, kind_of, larger, unsupported
from roaml.smc.opcodes import FaultCode, Op
from roaml.smc.registers import BOOL, INT, REAL, Label, Number, Operand, Region, Tape, product

MOST_ELEMENTS = 1_000_000
MOST = (1 << 63) - 1

_JUMPS = {
    # operator: for ints: (jump if it holds, jump if not, whether operands change places for either)
    BinaryOperator.EQUAL: ((Op.JUMP_EQ, False), (Op.JUMP_NE, False)),
    BinaryOperator.NOT_EQUAL: ((Op.JUMP_NE, False), (Op.JUMP_EQ, False)),
    BinaryOperator.LESS: ((Op.JUMP_LT, False), (Op.JUMP_LE, True)),
    BinaryOperator.LESS_EQUAL: ((Op.JUMP_LE, False), (Op.JUMP_LT, True)),
    BinaryOperator.GREATER: ((Op.JUMP_LT, True), (Op.JUMP_LE, False)),
    BinaryOperator.GREATER_EQUAL: ((Op.JUMP_LE, True), (Op.JUMP_LT, False)),
}
_REAL_JUMPS = {
    Op.JUMP_EQ: Op.JUMP_EQ_REAL,
    Op.JUMP_NE: Op.JUMP_NE_REAL,
    Op.JUMP_LT: Op.JUMP_LT_REAL,
    Op.JUMP_LE: Op.JUMP_LE_REAL,
}
_ARITHMETIC = {
    BinaryOperator.ADD: (Op.ADD, Op.ADD_REAL),
    BinaryOperator.SUBTRACT: (Op.SUB, Op.SUB_REAL),
    BinaryOperator.MULTIPLY: (Op.MUL, Op.MUL_REAL),
    BinaryOperator.MINIMUM: (Op.MIN, Op.MIN_REAL),
    BinaryOperator.MAXIMUM: (Op.MAX, Op.MAX_REAL),
}
_LOGICAL = (BinaryOperator.AND, BinaryOperator.OR, BinaryOperator.IMPLIES)


class Assembler:
    """Writes code onto a tape."""

    def __init__(self) -> None:
        self.tape = Tape()
        self._calls: list[str] = []

    # ------------------------------------------------------------ pieces of code

    def condition(self, expression: Expression, names: Names, origin: Origin | None = None) -> int:
        """Code that tells whether `expression` holds."""
        start = self.tape.begin(expression.origin or origin)
        otherwise = Label()
        self.jump(expression, names, otherwise, False)
        self.tape.emit(Op.RETURN, a=self.tape.constant(INT, 1).register)
        self.tape.mark(otherwise)
        self.tape.emit(Op.RETURN, a=self.tape.constant(INT, 0).register)
        return start

    def real_register(self, expression: Expression, names: Names, origin: Origin | None = None) -> int:
        """Code that gives the number of the real register with the value of `expression`."""
        start = self.tape.begin(expression.origin or origin)
        value = self.as_real(self.value(expression, names))
        self.tape.emit(Op.RETURN, a=self.tape.constant(INT, value.register).register)
        return start

    def end(self) -> None:
        """The end of a piece of code whose result nobody wants."""
        self.tape.emit(Op.RETURN, a=self.tape.constant(INT, 0).register)

    # ------------------------------------------------------------ values

    def known(self, node: Expression, names: Names) -> Number | None:
        """The value of a scalar that does not depend on the state."""
        match node:
            case Integer() | Real() | Boolean():
                return node.value
            case NamedNumber():
                return node.constant.number
            case Name(identifier):
                meaning = names.values.get(identifier)
                return meaning.value if isinstance(meaning, Operand) else None
            case _:
                return None

    def value(self, node: Expression, names: Names, into: int = -1) -> Operand:
        """Compute a scalar; with `into`, in that register."""
        match node:
            case Integer():
                if abs(node.value) > MOST:
                    raise FaultError("this number does not fit into 64 bits", node.origin)
                return self.moved(self.tape.constant(INT, node.value), into)
            case Boolean():
                return self.moved(self.tape.constant(BOOL, node.value), into)
            case Real():
                return self.moved(self.tape.constant(REAL, node.value), into)
            case NamedNumber():
                return self.moved(self.tape.constant(REAL, node.constant.number), into)
            case Name(identifier):
                meaning = self.meaning(node, names)
                if isinstance(meaning, Region) or (isinstance(meaning, Storage) and meaning.shape):
                    raise FaultError(f"`{identifier}` is an array, a single value is needed here", node.origin)
                if isinstance(meaning, Storage):
                    meaning = Operand(meaning.kind, meaning.base)
                return self.moved(meaning, into)
            case Unary():
                return self.unary(node, names, into)
            case Binary():
                return self.binary(node, names, into)
            case Conditional(test, then, otherwise):
                return self.conditional(test, then, otherwise, names, into)
            case ArrayAccess():
                region = self.element(node, names)
                if region.shape:
                    raise FaultError("this is an array, a single value is needed here", node.origin)
                return self.load(region, into)
            case Call():
                body, inner = self.called(node, names)
                try:
                    return self.value(body, inner, into)
                finally:
                    self._calls.pop()
            case ArrayValue() | ArrayConstructor():
                raise FaultError("this is an array, a single value is needed here", node.origin)
            case _:
                raise FaultError(unsupported(node), node.origin)

    def meaning(self, node: Name, names: Names) -> Meaning:
        meaning = names.values.get(node.identifier)
        if meaning is None:
            raise FaultError(f"there is no variable `{node.identifier}`", node.origin)
        return meaning

    def moved(self, operand: Operand, into: int) -> Operand:
        if into < 0 or operand.register == into:
            return operand
        self.tape.emit(Op.MOVE_REAL if operand.kind == REAL else Op.MOVE, into, operand.register)
        return Operand(operand.kind, into)

    def target(self, kind: str, into: int) -> int:
        return into if into >= 0 else self.tape.temporary(kind)

    def as_real(self, operand: Operand, into: int = -1) -> Operand:
        if operand.kind == REAL:
            return self.moved(operand, into)
        if operand.value is not None:
            return self.moved(self.tape.constant(REAL, float(operand.value)), into)
        register = self.target(REAL, into)
        self.tape.emit(Op.REAL, register, operand.register)
        return Operand(REAL, register)

    def stored(self, node: Expression, kind: str, names: Names, into: int = -1) -> Operand:
        """Compute a scalar as a value of `kind`."""
        if kind != REAL:
            return self.value(node, names, into)
        if self.kind(node, names) == REAL:
            return self.value(node, names, into)
        return self.as_real(self.value(node, names), into)

    def kind(self, node: Expression, names: Names) -> str:
        """The kind of a scalar, or of the elements of an array."""
        match node:
            case Integer():
                return INT
            case Boolean():
                return BOOL
            case Real() | NamedNumber():
                return REAL
            case Name():
                return self.meaning(node, names).kind
            case Unary(op, operand):
                if op.signature is Signature.LOGICAL:
                    return BOOL
                if op.signature is Signature.ROUNDING:
                    return INT
                return REAL if op.signature is Signature.REAL else self.kind(operand, names)
            case Binary(op, left, right):
                if op.signature in (Signature.LOGICAL, Signature.EQUALITY, Signature.ORDER):
                    return BOOL
                if op.signature is Signature.REAL:
                    return REAL
                if op is BinaryOperator.POWER and not (isinstance(right, Integer) and right.value >= 0):
                    return REAL
                first: Expression = node
                while isinstance(first, Binary) and first.operator in _ARITHMETIC:
                    if self.kind(first.right, names) == REAL:
                        return REAL
                    first = first.left
                if first is not node:
                    return REAL if self.kind(first, names) == REAL else INT
                return REAL if REAL in (self.kind(left, names), self.kind(right, names)) else INT
            case Conditional(_, then, otherwise):
                kinds = (self.kind(then, names), self.kind(otherwise, names))
                return REAL if REAL in kinds else kinds[0]
            case ArrayAccess(array, _):
                return self.kind(array, names)
            case ArrayValue(elements):
                inside = {self.kind(each, names) for each in elements}
                return REAL if REAL in inside else min(inside, default=INT)
            case ArrayConstructor(variable, _, body):
                return self.kind(body, names.bound({variable: Operand(INT, 0)}))
            case Call():
                return kind_of(self.function(node, names).type)
            case _:
                raise FaultError(unsupported(node), node.origin)

    def unary(self, node: Unary, names: Names, into: int) -> Operand:
        op, operand = node.operator, node.operand
        if op is UnaryOperator.NOT:
            return self.boolean(node, names, into)
        value = self.value(operand, names)
        is_int = value.kind != REAL
        kind = value.kind if op is UnaryOperator.ABS else INT if op.signature is Signature.ROUNDING else REAL
        if value.value is not None:
            return self.moved(self.folded(node, (value,), kind), into)
        if op is UnaryOperator.ABS:
            self.tape.place(node.origin)
            register = self.target(value.kind, into)
            self.tape.emit(Op.ABS if is_int else Op.ABS_REAL, register, value.register)
            return Operand(value.kind, register)
        if op in (UnaryOperator.FLOOR, UnaryOperator.CEIL, UnaryOperator.TRUNCATE) and is_int:
            return self.moved(value, into)
        return self.call(node, op, (value,), kind, into)

    def binary(self, node: Binary, names: Names, into: int) -> Operand:
        op = node.operator
        if op in _LOGICAL or op in _JUMPS:
            return self.boolean(node, names, into)
        left, right = node.left, node.right
        if isinstance(left, Binary) and left.operator is op and op in _ARITHMETIC:
            return self.chain(node, names, into)
        first = self.value(left, names)
        return self.computed(node, first, self.value(right, names), into)

    def chain(self, node: Binary, names: Names, into: int) -> Operand:
        """`a + b + c ...`: as deep as it likes."""
        parts: list[Binary] = [node]
        while isinstance(parts[-1].left, Binary) and parts[-1].left.operator is node.operator:
            parts.append(parts[-1].left)
        result = self.value(parts[-1].left, names)
        for part in reversed(parts):
            result = self.computed(part, result, self.value(part.right, names), into if part is node else -1)
        return result

    def computed(self, node: Binary, first: Operand, second: Operand, into: int) -> Operand:
        op = node.operator
        is_real = REAL in (first.kind, second.kind) or op.signature is Signature.REAL
        if op is BinaryOperator.POWER and not (isinstance(node.right, Integer) and node.right.value >= 0):
            is_real = True
        kind = REAL if is_real else INT
        if first.value is not None and second.value is not None:
            return self.moved(self.folded(node, (first, second), kind), into)
        if op in _ARITHMETIC or (op is BinaryOperator.REMAINDER and not is_real) or op is BinaryOperator.DIVIDE:
            if is_real:
                first, second = self.as_real(first), self.as_real(second)
            code = _ARITHMETIC[op][is_real] if op in _ARITHMETIC else Op.DIVIDE if is_real else Op.REM
            self.tape.place(node.origin)
            register = self.target(kind, into)
            self.tape.emit(code, register, first.register, second.register)
            return Operand(kind, register)
        return self.call(node, op, (first, second), kind, into)

    def call(self, node: Node, op: Operator, arguments: Sequence[Operand], kind: str, into: int) -> Operand:
        for argument in arguments:
            self.tape.emit(Op.ARGUMENT_REAL if argument.kind == REAL else Op.ARGUMENT, a=argument.register)
        register = self.target(kind, into)
        self.tape.place(node.origin)
        code = Op.CALL_REAL if kind == REAL else Op.CALL_INT
        self.tape.emit(code, register, c=self.tape.function(op))
        return Operand(kind, register)

    def folded(self, node: Unary | Binary, operands: Sequence[Operand], kind: str) -> Operand:
        """An operator whose operands are constants."""
        constants: list[Expression] = []
        for operand in operands:
            value = operand.value
            assert value is not None
            if operand.kind == BOOL:
                constants.append(Boolean(bool(value)))
            else:
                constants.append(Real(value) if isinstance(value, float) else Integer(value))
        plain: Expression
        plain = Unary(node.operator, *constants) if isinstance(node, Unary) else Binary(node.operator, *constants)
        try:
            result = evaluate(plain, {})
        except EvaluationError as error:
            code = FaultCode.DIVISION if "division" in error.message else FaultCode.DOMAIN
            return self.failing(node, code, kind)
        assert isinstance(result, (bool, int, float))
        if kind == INT and abs(result) > MOST:
            return self.failing(node, FaultCode.OVERFLOW, kind)
        return self.tape.constant(kind, float(result) if kind == REAL else result)

    def failing(self, node: Node, code: FaultCode, kind: str, value: int = 0, size: int = 0) -> Operand:
        """Something that has no value, if it is ever reached."""
        self.tape.place(node.origin)
        self.tape.emit(Op.FAULT, code, value, size)
        return Operand(kind, self.tape.temporary(kind))

    def conditional(
        self, test: Expression, then: Expression, otherwise: Expression, names: Names, into: int
    ) -> Operand:
        kind = REAL if REAL in (self.kind(then, names), self.kind(otherwise, names)) else self.kind(then, names)
        # Not directly into the target: the branches may read it while it is written.
        register = self.tape.temporary(kind)
        no, end = Label(), Label()
        self.jump(test, names, no, False)
        self.stored(then, kind, names, register)
        self.tape.jump(Op.JUMP, end)
        self.tape.mark(no)
        self.stored(otherwise, kind, names, register)
        self.tape.mark(end)
        return self.moved(Operand(kind, register), into)

    def boolean(self, node: Expression, names: Names, into: int) -> Operand:
        register = self.tape.temporary(BOOL)
        no, end = Label(), Label()
        self.jump(node, names, no, False)
        self.tape.emit(Op.MOVE, register, self.tape.constant(INT, 1).register)
        self.tape.jump(Op.JUMP, end)
        self.tape.mark(no)
        self.tape.emit(Op.MOVE, register, self.tape.constant(INT, 0).register)
        self.tape.mark(end)
        return self.moved(Operand(BOOL, register), into)

    # ------------------------------------------------------------ conditions

    def jump(self, node: Expression, names: Names, label: Label, when: bool) -> None:
        """Jump to `label` if the value of `node` is `when`, else go on."""
        while isinstance(node, Unary) and node.operator is UnaryOperator.NOT:
            node, when = node.operand, not when
        match node:
            case Binary(operator=op) if op in _LOGICAL:
                self.logical(node, names, label, when)
            case Binary(operator=op) if op in _JUMPS:
                self.comparison(node, names, label, when)
            case Conditional(test, then, otherwise):
                no, end = Label(), Label()
                self.jump(test, names, no, False)
                self.jump(then, names, label, when)
                self.tape.jump(Op.JUMP, end)
                self.tape.mark(no)
                self.jump(otherwise, names, label, when)
                self.tape.mark(end)
            case _:
                value = self.value(node, names)
                if value.value is not None:
                    if bool(value.value) is when:
                        self.tape.jump(Op.JUMP, label)
                else:
                    self.tape.jump(Op.JUMP_TRUE if when else Op.JUMP_FALSE, label, value.register)

    def logical(self, node: Binary, names: Names, label: Label, when: bool) -> None:
        """Chains of one operator are as long as they like."""
        parts: list[Expression] = [node]
        while isinstance(parts[-1], Binary) and parts[-1].operator is node.operator:
            last = parts.pop()
            assert isinstance(last, Binary)
            parts += (last.right, last.left)
            if node.operator is BinaryOperator.IMPLIES:
                break
        parts.reverse()
        # a ⇒ b is ¬a ∨ b; one operand with the value `decisive` decides.
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

    def comparison(self, node: Binary, names: Names, label: Label, when: bool) -> None:
        op, left, right = node.operator, node.left, node.right
        if op.signature is Signature.EQUALITY and (self.shape(left, names) or self.shape(right, names)):
            self.array_comparison(node, names, label, when)
            return
        first, second = self.value(left, names), self.value(right, names)
        if first.value is not None and second.value is not None:
            if bool(op.function(first.value, second.value)) is when:
                self.tape.jump(Op.JUMP, label)
            return
        (code, swapped), (opposite, opposite_swapped) = _JUMPS[op]
        if REAL not in (first.kind, second.kind):
            if not when:
                code, swapped = opposite, opposite_swapped
            if swapped:
                first, second = second, first
            self.tape.jump(code, label, first.register, second.register)
            return
        first, second = self.as_real(first), self.as_real(second)
        if swapped:
            first, second = second, first
        if when:
            self.tape.jump(_REAL_JUMPS[code], label, first.register, second.register)
            return
        # Not the opposite comparison: with a number that is none, neither holds.
        holds = Label()
        self.tape.jump(_REAL_JUMPS[code], holds, first.register, second.register)
        self.tape.jump(Op.JUMP, label)
        self.tape.mark(holds)

    def array_comparison(self, node: Binary, names: Names, label: Label, when: bool) -> None:
        equal = node.operator is BinaryOperator.EQUAL
        shape, other = self.shape(node.left, names), self.shape(node.right, names)
        if shape != other:
            if equal is not when:
                self.tape.jump(Op.JUMP, label)
            return
        kind = REAL if REAL in (self.kind(node.left, names), self.kind(node.right, names)) else INT
        left, right = (self.materialized(each, kind, shape, names) for each in (node.left, node.right))
        unequal = Label()
        goes = label if equal is not when else unequal
        code = Op.JUMP_NE_REAL if kind == REAL else Op.JUMP_NE
        for i in range(product(shape)):
            self.tape.jump(code, goes, left.base + i, right.base + i)
        if equal is when:
            self.tape.jump(Op.JUMP, label)
        self.tape.mark(unequal)

    # ------------------------------------------------------------ arrays

    def shape(self, node: Expression, names: Names) -> tuple[int, ...]:
        """The lengths of an array in all dimensions; () for a scalar."""
        match node:
            case Name():
                meaning = self.meaning(node, names)
                return () if isinstance(meaning, Operand) else meaning.shape
            case ArrayAccess(array, _):
                return self.shape(array, names)[1:]
            case ArrayValue(elements):
                inner: tuple[int, ...] = ()
                for each in elements:
                    inner = larger(inner, self.shape(each, names))
                return (len(elements), *inner)
            case ArrayConstructor(variable, length, body):
                size = self.length(node, length, names)
                inner = self.shape(body, names.bound({variable: self.tape.constant(INT, 0)}))
                return (size, *inner)
            case Conditional(_, then, otherwise):
                return larger(self.shape(then, names), self.shape(otherwise, names))
            case Call():
                function = self.function(node, names)
                if not isinstance(function.type, ArrayType):
                    return ()
                body, inner_names = self.called(node, names, shapes_only=True)
                try:
                    return self.shape(body, inner_names)
                finally:
                    self._calls.pop()
            case _:
                return ()

    def length(self, node: ArrayConstructor, length: Expression, names: Names) -> int:
        known = {name: m.value for name, m in names.values.items() if isinstance(m, Operand) and m.value is not None}
        try:
            size = evaluate(length, known, names.functions)
        except EvaluationError as error:
            raise FaultError(
                "the length of an array must not depend on the state", error.origin or node.origin
            ) from None
        if not isinstance(size, int) or not 0 <= size <= MOST_ELEMENTS:
            raise FaultError(f"an array cannot have {size} elements", length.origin)
        return size

    def element(self, node: ArrayAccess, names: Names) -> Region:
        """The part of an array that is accessed; its shape is () for a single element."""
        indexes: list[ArrayAccess] = []
        inner: Expression = node
        while isinstance(inner, ArrayAccess):
            indexes.append(inner)
            inner = inner.array
        indexes.reverse()
        whole = self.region(inner, names)
        if len(indexes) > len(whole.shape):
            raise FaultError("this is not an array", node.origin)
        return self.indexed(whole, indexes, names)

    def indexed(self, whole: Region, accesses: Sequence[ArrayAccess], names: Names) -> Region:
        offset = whole.offset
        base, shape = whole.base, whole.shape
        fixed = 0
        for access in accesses:
            length, shape = shape[0], shape[1:]
            index = self.value(access.index, names)
            size = product(shape)
            if index.value is not None:
                if not 0 <= index.value < length:
                    value = int(index.value)
                    self.failing(access, FaultCode.INDEX, INT, max(min(value, 2**31 - 1), -(2**31)), length)
                else:
                    fixed += int(index.value) * size
                continue
            self.tape.place(access.origin)
            self.tape.emit(Op.INDEX, a=index.register, b=length)
            step = self.tape.temporary(INT)
            self.tape.emit(Op.MOVE, step, index.register)
            zero = self.tape.constant(INT, 0).register
            if size != 1:
                self.tape.emit(Op.OFFSET, step, zero, size)
            if offset >= 0:
                self.tape.emit(Op.ADD, step, step, offset)
            offset = step
        return Region(whole.kind, shape, base + fixed, offset)

    def region(self, node: Expression, names: Names) -> Region:
        """The registers of an array; what is not in registers is put there."""
        match node:
            case Name():
                meaning = self.meaning(node, names)
                if isinstance(meaning, Storage):
                    return Region(meaning.kind, meaning.shape, meaning.base)
                if isinstance(meaning, Region):
                    return meaning
                raise FaultError(f"`{node.identifier}` is not an array", node.origin)
            case ArrayAccess():
                return self.element(node, names)
            case _:
                return self.materialized(node, self.kind(node, names), self.shape(node, names), names)

    def materialized(self, node: Expression, kind: str, shape: tuple[int, ...], names: Names) -> Region:
        """A copy of an array in registers of its own."""
        region = Region(kind, shape, self.tape.room(kind, product(shape)))
        self.fill(node, region, names)
        return region

    def fill(self, node: Expression, into: Region, names: Names, watch: int = -1) -> None:
        """Store an array into a region without offset; where it is smaller, zeros are added."""
        match node:
            case ArrayValue(elements):
                if len(elements) > into.shape[0]:
                    self.failing(node, FaultCode.INDEX, INT, into.shape[0], into.shape[0])
                    return
                for position in range(into.shape[0]):
                    part = self.part(into, position)
                    if position >= len(elements):
                        self.clear(part, watch)
                    elif part.shape:
                        self.fill(elements[position], part, names, watch)
                    else:
                        self.put(elements[position], part, names, watch)
            case ArrayConstructor(variable, length, body):
                size = self.length(node, length, names)
                for position in range(into.shape[0]):
                    part = self.part(into, position)
                    if position >= size:
                        self.clear(part, watch)
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
                self.tape.jump(Op.JUMP, end)
                self.tape.mark(no)
                self.fill(otherwise, into, names, watch)
                self.tape.mark(end)
            case Call():
                body, inner = self.called(node, names)
                try:
                    self.fill(body, into, inner, watch)
                finally:
                    self._calls.pop()
            case _:
                self.copy(self.region(node, names), into, watch, node)

    def part(self, region: Region, position: int) -> Region:
        shape = region.shape[1:]
        return Region(region.kind, shape, region.base + position * product(shape), region.offset)

    def put(self, node: Expression, cell: Region, names: Names, watch: int) -> None:
        """Store a scalar into a single cell."""
        if watch < 0 and cell.offset < 0:
            self.stored(node, cell.kind, names, cell.base)
            return
        self.write(self.stored(node, cell.kind, names), cell, watch)

    def write(self, value: Operand, cell: Region, watch: int) -> None:
        is_real = cell.kind == REAL
        if cell.offset >= 0:
            code = Op.STORE_REAL if is_real else Op.STORE
            self.tape.emit(code, cell.base, cell.offset, value.register, watch)
        elif watch >= 0:
            self.tape.emit(Op.SET_REAL if is_real else Op.SET, cell.base, value.register, watch)
        else:
            self.moved(value, cell.base)

    def clear(self, into: Region, watch: int) -> None:
        zero = self.tape.constant(into.kind, 0)
        for i in range(into.size):
            self.write(zero, Region(into.kind, (), into.base + i, into.offset), watch)

    def copy(self, source: Region, into: Region, watch: int, node: Node) -> None:
        """Copy an array to a region without offset."""
        if len(source.shape) != len(into.shape):
            raise FaultError("arrays of different dimensions", node.origin)
        if source.kind != into.kind and into.kind == REAL:
            for i in range(into.size):
                value = self.load(Region(source.kind, (), source.base + i, source.offset))
                self.write(self.as_real(value), Region(REAL, (), into.base + i), watch)
            return
        if source.shape[1:] == into.shape[1:] and source.shape[0] <= into.shape[0]:
            self.copy_block(source, into, watch)
            rest = into.size - source.size
            if rest:
                self.clear(Region(into.kind, (rest,), into.base + source.size), watch)
            return
        if source.shape[0] > into.shape[0]:
            self.failing(node, FaultCode.INDEX, INT, into.shape[0], into.shape[0])
            return
        for position in range(into.shape[0]):
            part = self.part(into, position)
            if position < source.shape[0]:
                self.copy(self.part(source, position), part, watch, node)
            else:
                self.clear(part, watch)

    def copy_block(self, source: Region, into: Region, watch: int) -> None:
        is_real = into.kind == REAL
        if source.offset < 0:
            code = Op.COPY_REAL if is_real else Op.COPY
            self.tape.emit(code, into.base, source.base, watch, source.size)
            return
        code = Op.COPY_INDEXED_REAL if is_real else Op.COPY_INDEXED
        self.tape.emit(code, into.base, source.base, source.offset, source.size)
        if watch >= 0:
            self.tape.emit(Op.NOTE, watch)

    def load(self, cell: Region, into: int = -1) -> Operand:
        """The value of a single cell."""
        if cell.offset < 0:
            return self.moved(Operand(cell.kind, cell.base), into)
        register = self.target(cell.kind, into)
        self.tape.emit(Op.LOAD_REAL if cell.kind == REAL else Op.LOAD, register, cell.base, cell.offset)
        return Operand(cell.kind, register)

    # ------------------------------------------------------------ functions

    def function(self, node: Call, names: Names) -> Function:
        function = names.functions.get(node.function)
        if function is None:
            raise FaultError(f"there is no function `{node.function}`", node.origin)
        return function

    def called(self, node: Call, names: Names, shapes_only: bool = False) -> tuple[Expression, Names]:
        """The body of a function, and what names mean in it: it is compiled where it is called. Who asks takes the
        function off `_calls` afterwards."""
        function = self.function(node, names)
        if node.function in self._calls:
            raise FaultError(f"`{node.function}` calls itself, which is not supported", node.origin)
        if len(node.arguments) != len(function.parameters):
            wanted, given = len(function.parameters), len(node.arguments)
            raise FaultError(f"`{node.function}` takes {wanted} arguments, not {given}", node.origin)
        bound: dict[str, Meaning] = {}
        for parameter, argument in zip(function.parameters, node.arguments, strict=True):
            kind = kind_of(parameter.type)
            if isinstance(parameter.type, ArrayType):
                shape = self.shape(argument, names)
                bound[parameter.name] = Region(kind, shape, 0) if shapes_only else self.region(argument, names)
            elif shapes_only:
                known = self.known(argument, names)
                bound[parameter.name] = Operand(kind, 0, known)
            else:
                value = self.stored(argument, kind, names)
                bound[parameter.name] = Operand(kind, value.register, value.value)
        self._calls.append(node.function)
        return function.body, names.bound(bound)
