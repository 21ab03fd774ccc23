# SPDX-License-Identifier: Apache-2.0
"""The names of a symbol in the translation: events in plain SCXML, and global variables in JANI."""

from __future__ import annotations

from collections.abc import Mapping

from roaml.diagnostics import Symbol
from roaml.ide.names.occurrences import global_names, trees_of
from roaml.model.globals import GlobalVariable
from roaml.project.analysis import Analysis
from roaml.scxml.names import FLAG


def global_variables(analysis: Analysis, symbol: Symbol) -> tuple[GlobalVariable, ...]:
    """The global variables whose names contain the name of a symbol, in all systems of the symbol. Flags (`.valid`)
    come first."""
    result: dict[str, GlobalVariable] = {}
    if symbol.path:
        systems = (symbol.path,) if symbol.path in analysis.system_paths else analysis.systems_of(symbol.path)
    else:
        systems = analysis.system_paths
    for system in systems:
        if system is not None:
            variables = analysis.globals(system)
            names = _by_symbol(analysis, system).get(symbol, ())
            result.update((name, variables[name]) for name in names if name in variables)
    return tuple(sorted(result.values(), key=lambda variable: variable.parameter != FLAG))


def _by_symbol(analysis: Analysis, system: str) -> Mapping[Symbol, tuple[str, ...]]:
    names = global_names(analysis, system)

    def invert() -> Mapping[Symbol, tuple[str, ...]]:
        names_by_symbol: dict[Symbol, dict[str, None]] = {}
        for name, pieces in names.items():
            for _, symbol, _ in pieces:
                if symbol is not None:
                    names_by_symbol.setdefault(symbol, {})[name] = None
        return {symbol: tuple(names) for symbol, names in names_by_symbol.items()}

    key = (analysis.system(system), trees_of(analysis, system, system))
    return analysis.memo.get("global names by symbol", system, key, invert)
