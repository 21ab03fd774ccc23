# SPDX-License-Identifier: Apache-2.0
"""Lengths of received arrays that conditions test, and no machine sends."""

from __future__ import annotations

from collections.abc import Collection

from roaml.expr.infer import constant
from roaml.expr.operators import Operator
from roaml.expr.tree import Binary, Expr, Member, access_path
from roaml.model.values.analyse import ChartValues
from roaml.model.values.describe import described


def length_never_sent(chart: ChartValues, node: Binary, side: Expr, stored: Collection[str]) -> str | None:
    """A message about the comparison `node`, of which one `side` is the length of an array, if the array is stored in
    one of the variables `stored` as it is received, and never has this length. Tests for no elements are left out:
    machines are prepared for them, although none sends them."""
    path = access_path(side)
    if not isinstance(side, Member) or side.name != "length" or path is None or path[0] not in stored:
        return None
    number = constant(node.right if side is node.left else node.left)
    known = chart.at(side)
    if node.operator is not Operator.EQUAL or not number or known is None or not known.only or known.includes(number):
        return None
    return f"this comparison is never true: the lengths that machines send are {described(known)}"
