# SPDX-License-Identifier: Apache-2.0
"""Operators on values in registers. They are evaluated at compile time if the values are known, and compiled otherwise.

An operation that always fails is compiled, too, because it may never be reached.
"""

from __future__ import annotations

from collections.abc import Sequence

from roaml.jani.expressions import Binary, Boolean, Expression, Integer, Real, Unary
from roaml.jani.node import Node
from roaml.jani.operators import BinaryOperator, Operator, Signature, UnaryOperator
from roaml.jani.semantics import DivisionByZeroError, EvaluationError, evaluate
from roaml.smc import opcodes
from roaml.smc.cells import CellAssembler
from roaml.smc.fault import FaultCode
from roaml.smc.registers import BOOL, INT, REAL, Label, Operand

MAX_INT64 = (1 << 63) - 1

COMPARISONS = {
    # operator: for ints: (the jump if it holds, the jump if it does not, whether the operands are exchanged for each)
    BinaryOperator.EQUAL: ((opcodes.JUMP_EQ, False), (opcodes.JUMP_NE, False)),
    BinaryOperator.NOT_EQUAL: ((opcodes.JUMP_NE, False), (opcodes.JUMP_EQ, False)),
    BinaryOperator.LESS: ((opcodes.JUMP_LT, False), (opcodes.JUMP_LE, True)),
    BinaryOperator.LESS_EQUAL: ((opcodes.JUMP_LE, False), (opcodes.JUMP_LT, True)),
    BinaryOperator.GREATER: ((opcodes.JUMP_LT, True), (opcodes.JUMP_LE, False)),
    BinaryOperator.GREATER_EQUAL: ((opcodes.JUMP_LE, True), (opcodes.JUMP_LT, False)),
}
_REAL_JUMPS = {
    opcodes.JUMP_EQ: opcodes.JUMP_EQ_REAL,
    opcodes.JUMP_NE: opcodes.JUMP_NE_REAL,
    opcodes.JUMP_LT: opcodes.JUMP_LT_REAL,
    opcodes.JUMP_LE: opcodes.JUMP_LE_REAL,
}
ARITHMETIC = {
    BinaryOperator.ADD: (opcodes.ADD, opcodes.ADD_REAL),
    BinaryOperator.SUBTRACT: (opcodes.SUB, opcodes.SUB_REAL),
    BinaryOperator.MULTIPLY: (opcodes.MUL, opcodes.MUL_REAL),
    BinaryOperator.MINIMUM: (opcodes.MIN, opcodes.MIN_REAL),
    BinaryOperator.MAXIMUM: (opcodes.MAX, opcodes.MAX_REAL),
}


class OperatorAssembler:
    """Writes the code of operators whose operands are already computed."""

    def __init__(self, cells: CellAssembler) -> None:
        self.tape = cells.tape
        self.cells = cells

    def applied(self, node: Unary, value: Operand, into: int) -> Operand:
        """Write code that applies an operator to its only operand."""
        op = node.operator
        is_int = value.kind != REAL
        kind = value.kind if op is UnaryOperator.ABS else INT if op.signature is Signature.ROUNDING else REAL
        if value.value is not None:
            return self.cells.moved(self.folded(node, (value,), kind), into)
        if op is UnaryOperator.ABS:
            self.tape.place(node.origin)
            register = self.cells.target(value.kind, into)
            self.tape.emit(opcodes.ABS if is_int else opcodes.ABS_REAL, register, value.register)
            return Operand(value.kind, register)
        if op in (UnaryOperator.FLOOR, UnaryOperator.CEIL, UnaryOperator.TRUNCATE) and is_int:
            return self.cells.moved(value, into)
        return self.call(node, op, (value,), kind, into)

    def computed(self, node: Binary, first: Operand, second: Operand, into: int) -> Operand:
        op = node.operator
        is_real = REAL in (first.kind, second.kind) or op.signature is Signature.REAL
        if op is BinaryOperator.POWER and not (isinstance(node.right, Integer) and node.right.value >= 0):
            is_real = True
        kind = REAL if is_real else INT
        if first.value is not None and second.value is not None:
            return self.cells.moved(self.folded(node, (first, second), kind), into)
        if op in ARITHMETIC or (op is BinaryOperator.REMAINDER and not is_real) or op is BinaryOperator.DIVIDE:
            if is_real:
                first, second = self.cells.as_real(first), self.cells.as_real(second)
            code = ARITHMETIC[op][is_real] if op in ARITHMETIC else opcodes.DIVIDE if is_real else opcodes.REM
            self.tape.place(node.origin)
            register = self.cells.target(kind, into)
            self.tape.emit(code, register, first.register, second.register)
            return Operand(kind, register)
        return self.call(node, op, (first, second), kind, into)

    def compared(self, op: BinaryOperator, first: Operand, second: Operand, label: Label, when: bool) -> None:
        """Write code that jumps to `label` if the comparison of two scalars is `when`, and continues otherwise."""
        if first.value is not None and second.value is not None:
            if bool(op.function(first.value, second.value)) is when:
                self.tape.jump(opcodes.JUMP, label)
            return
        (code, swapped), (opposite, opposite_swapped) = COMPARISONS[op]
        if REAL not in (first.kind, second.kind):
            if not when:
                code, swapped = opposite, opposite_swapped
            if swapped:
                first, second = second, first
            self.tape.jump(code, label, first.register, second.register)
            return
        first, second = self.cells.as_real(first), self.cells.as_real(second)
        if swapped:
            first, second = second, first
        if when:
            self.tape.jump(_REAL_JUMPS[code], label, first.register, second.register)
            return
        # The opposite comparison cannot be used, because with NaN neither holds.
        holds = Label()
        self.tape.jump(_REAL_JUMPS[code], holds, first.register, second.register)
        self.tape.jump(opcodes.JUMP, label)
        self.tape.mark(holds)

    def call(self, node: Node, op: Operator, arguments: Sequence[Operand], kind: str, into: int) -> Operand:
        for argument in arguments:
            self.tape.emit(opcodes.ARGUMENT_REAL if argument.kind == REAL else opcodes.ARGUMENT, a=argument.register)
        register = self.cells.target(kind, into)
        self.tape.place(node.origin)
        code = opcodes.CALL_REAL if kind == REAL else opcodes.CALL_INT
        self.tape.emit(code, register, c=self.tape.function(op))
        return Operand(kind, register)

    def folded(self, node: Unary | Binary, operands: Sequence[Operand], kind: str) -> Operand:
        """The value of an operator whose operands are constants."""
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
        except DivisionByZeroError:
            return self.cells.failing(node, FaultCode.DIVISION, kind)
        except EvaluationError:
            return self.call(node, node.operator, operands, kind, -1)
        assert isinstance(result, (bool, int, float))
        if kind == INT and abs(result) > MAX_INT64:
            return self.cells.failing(node, FaultCode.OVERFLOW, kind)
        return self.tape.constant(kind, float(result) if kind == REAL else result)
