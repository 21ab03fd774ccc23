# SPDX-License-Identifier: Apache-2.0
"""The instructions of the bytecode, which `assemble` writes and `kernel` executes.

An instruction consists of five numbers: its code and the operands d, a, b, c. `I` are the registers for ints and bools
(0 or 1), `D` those for reals; they contain variables, constants and intermediate results; `v` is the number of a
watched variable. `setup.py` makes constants of C from the names that have a number here, so that a C compiler creates a
jump table from the codes.
"""

from __future__ import annotations

WIDTH = 5
"""The number of integers in an instruction."""

RETURN = 0  # the value is I[a]
JUMP = 1  # to d
JUMP_TRUE = 2  # to d if I[a]; I[b] is 1
JUMP_FALSE = 3  # to d unless I[a]; I[b] is 0
JUMP_EQ = 4  # to d if I[a] = I[b]
JUMP_NE = 5
JUMP_LT = 6
JUMP_LE = 7
MOVE = 8  # I[d] := I[a]
SET = 9  # I[d] := I[a]; note v = b if that is a change
ADD = 10  # I[d] := I[a] + I[b]
SUB = 11
MUL = 12
MIN = 13
MAX = 14
ABS = 15
REM = 16
REAL = 17  # D[d] := I[a]
INDEX = 18  # fault unless 0 ≤ I[a] < b
OFFSET = 19  # I[d] := I[d] * b + I[a], an index that has been checked
LOAD = 20  # I[d] := I[a + I[b]]
STORE = 21  # I[d + I[a]] := I[b]; note v = c if c ≥ 0 and that is a change
COPY = 22  # c numbers from I[a...] to I[d...]; note v = b if b ≥ 0 and that is a change
COPY_INDEXED = 23  # c numbers from I[a + I[b]...] to I[d...]
STORE_MANY = 24  # c numbers from I[b...] to I[d + I[a]...]
NOTE = 25  # v = d has changed
RANGE = 26  # fault unless I[b] ≤ I[a] ≤ I[c]
FAULT = 27  # always a fault; d is its code
JUMP_EQ_REAL = 28  # to d if D[a] = D[b]
JUMP_NE_REAL = 29
JUMP_LT_REAL = 30
JUMP_LE_REAL = 31
MOVE_REAL = 32
SET_REAL = 33
ADD_REAL = 34
SUB_REAL = 35
MUL_REAL = 36
MIN_REAL = 37
MAX_REAL = 38
ABS_REAL = 39
DIVIDE = 40
LOAD_REAL = 41
STORE_REAL = 42
COPY_REAL = 43
COPY_INDEXED_REAL = 44
STORE_MANY_REAL = 45
RANGE_REAL = 46
CALL_INT = 47  # I[d] := functions[c] of the arguments that ARGUMENT and ARGUMENT_REAL have appended
CALL_REAL = 48
ARGUMENT = 49  # append I[a] to the arguments of the next call
ARGUMENT_REAL = 50
FAIL_TRUE = 51  # the value is 0 if I[a]; continue otherwise; I[b] is 1
FAIL_FALSE = 52  # I[b] is 0
FAIL_EQ = 53  # the value is 0 if I[a] = I[b]; continue otherwise
FAIL_NE = 54
FAIL_LT = 55
FAIL_LE = 56
IS_EQ = 57  # the value is 1 if I[a] = I[b], otherwise 0
IS_NE = 58
IS_LT = 59
IS_LE = 60

_LESS, _EQUAL, _GREATER = 1, 2, 4

ORDERS = {
    JUMP_TRUE: _EQUAL,
    JUMP_FALSE: _EQUAL,
    JUMP_EQ: _EQUAL,
    JUMP_NE: _LESS | _GREATER,
    JUMP_LT: _LESS,
    JUMP_LE: _LESS | _EQUAL,
    FAIL_TRUE: _EQUAL,
    FAIL_FALSE: _EQUAL,
    FAIL_EQ: _EQUAL,
    FAIL_NE: _LESS | _GREATER,
    FAIL_LT: _LESS,
    FAIL_LE: _LESS | _EQUAL,
    IS_EQ: _EQUAL,
    IS_NE: _LESS | _GREATER,
    IS_LT: _LESS,
    IS_LE: _LESS | _EQUAL,
}
"""The comparisons of ints -> their operand c: for which orders of I[a] and I[b] they hold."""
