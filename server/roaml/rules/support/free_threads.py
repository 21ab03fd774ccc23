# SPDX-License-Identifier: Apache-2.0
"""Variables that count the free threads of an action."""

from __future__ import annotations

from roaml.model.machine import Assign, Chart, bodies, statements
from roaml.roles import ProtocolPart
from roaml.rules.support.blocks import counts, target


def counts_threads(chart: Chart, name: str) -> bool:
    """Whether a variable, such as the number of free threads, grows only when a thread becomes free."""
    growing = [
        handler
        for _, handler, body in bodies(chart)
        for s in statements(body)
        if isinstance(s, Assign) and target(s) == name and counts(s, name, 1)
    ]
    return bool(growing) and all(h is not None and h.trigger is ProtocolPart.THREAD_FREE for h in growing)
