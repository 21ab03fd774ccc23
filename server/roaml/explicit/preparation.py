# SPDX-License-Identifier: Apache-2.0
"""What the searches for all properties of a model have in common: it is computed once for each model checker."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from weakref import WeakKeyDictionary

from roaml.explicit.independence import IndependenceAnalysis
from roaml.explicit.liveness import Liveness, LivenessAnalysis, all_live
from roaml.explicit.tables import Tables, cells_written, tables_of
from roaml.explicit.uses import VariableUses
from roaml.smc.goal import CompiledProperty
from roaml.smc.model import ModelChecker
from roaml.smc.names import Storage
from roaml.smc.program import Ints

_PREPARATIONS: WeakKeyDictionary[ModelChecker, Preparation] = WeakKeyDictionary()


def preparation_of(checker: ModelChecker) -> Preparation:
    """The preparation of the searches of a model checker. It exists as long as the model checker."""
    preparation = _PREPARATIONS.get(checker)
    if preparation is None:
        preparation = _PREPARATIONS[checker] = Preparation(checker)
    return preparation


class Preparation:
    """Analyses of the model of a model checker."""

    def __init__(self, checker: ModelChecker) -> None:
        self._program = checker.program
        self._legend = checker.legend
        self._transient = _transient(checker)
        self._uses = VariableUses(self._legend)
        self._liveness: dict[int, LivenessAnalysis] = {}

    def tables(self, property_: CompiledProperty, observed: Iterable[str], *, reduces: bool) -> Tables:
        """The tables for a property.

        Args:
            observed: the names of the variables of the model that the property reads.
            reduces: whether dead variables are reset.
        """
        liveness = self.liveness(observed) if reduces else all_live(self._legend)
        return tables_of(self._program, property_.goal, self._legend, self._transient, liveness, self._cells_written)

    def liveness(self, observed: Iterable[str]) -> Liveness:
        """The dead variables for a goal that reads variables of the model with these names."""
        names = frozenset(observed)
        variables = self._uses.of(storage for storage in self._legend.layout.shared if storage.name in names)
        seen = variables & self._uses.of(self._transient)
        if seen not in self._liveness:
            self._liveness[seen] = LivenessAnalysis(self._legend, self._uses, self._transient, seen)
        return self._liveness[seen].liveness(variables)

    @cached_property
    def independence(self) -> IndependenceAnalysis:
        return IndependenceAnalysis(self._program, self._legend, self._uses)

    @cached_property
    def _cells_written(self) -> tuple[Ints, Ints]:
        return cells_written(self._program, self._legend)


def _transient(checker: ModelChecker) -> list[Storage]:
    layout = checker.legend.layout
    names = {variable.name for variable in checker.model.variables if variable.transient}
    shared = [storage for storage in layout.shared if storage.name in names]
    own = [storage for i in layout.instances for storage in i.own if storage.name in i.transient]
    return shared + own
