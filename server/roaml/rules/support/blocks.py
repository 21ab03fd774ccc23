# SPDX-License-Identifier: Apache-2.0
"""The blocks of a machine: bodies and parts of an `<if>`, whose statements are executed together."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.expr.infer import constant
from roaml.expr.operators import Operator
from roaml.expr.tree import Binary, Name
from roaml.model.machine import Assign, Chart, If, Statement, bodies
from roaml.model.syntax import Expression
from roaml.model.values.evaluate import place_of
from roaml.record import Record


class Block(Record, frozen=True):
    """The statements of a body, or of a part of an `<if>`.

    Attributes:
        cond: the condition of the part, if it has one.
        outer: the blocks around it, the nearest one first.
    """

    statements: tuple[Statement, ...]
    cond: Expression | None
    outer: tuple[Block, ...] = ()

    def assigned(self, name: str) -> list[Assign]:
        return [s for s in self.statements if isinstance(s, Assign) and target(s) == name]


def blocks(chart: Chart) -> Iterator[Block]:
    for _, _, body in bodies(chart):
        yield from _inside(Block(body, None))


def _inside(block: Block) -> Iterator[Block]:
    yield block
    for statement in block.statements:
        for part in statement.parts if isinstance(statement, If) else ():
            yield from _inside(Block(part.body, part.cond, (block, *block.outer)))


def sets(block: Iterable[Statement], array: str) -> bool:
    """Whether statements set a whole array, or its length."""
    return any(isinstance(s, Assign) and target(s) in (array, f"{array}.length") for s in block)


def is_reset(chart: Chart, statement: Assign, array: str) -> bool:
    """Whether the block of an assignment also sets a whole array, or its length."""
    return any(statement in block.statements and sets(block.statements, array) for block in blocks(chart))


def target(statement: Assign) -> str | None:
    return place_of(statement.location.tree) if statement.location is not None else None


def counts(statement: Assign, counter: str, step: int) -> bool:
    """Whether an assignment changes a counter by a number with the sign of `step`, 1 or -1."""
    tree = statement.value.tree if isinstance(statement.value, Expression) else None
    if not isinstance(tree, Binary) or not isinstance(tree.left, Name) or tree.left.name != counter:
        return False
    sign = {Operator.ADD: 1, Operator.SUBTRACT: -1}.get(tree.operator)
    number = constant(tree.right)
    return sign is not None and number is not None and sign * number * step >= 1
