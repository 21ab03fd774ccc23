#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the tables that the program reads: of the grammars, from `schemas/`, and of the libraries of nodes, from their
declarations.

`docs/build.py` does so, too, but needs readable tables to start: after a change of the records in
`roaml.language.grammar` or `roaml.libraries.node`, run `python docs/tables.py`.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from roaml.language.grammar import XML_GRAMMARS
from roaml.language.schema_reader import read_schema
from roaml.libraries import BEHAVIORTREE_CPP, LIBRARIES, table_of
from roaml.libraries.declarations import read_library
from roaml.record import encoded


def grammars() -> Iterator[tuple[Path, bytes]]:
    return ((Path(grammar.tables_file), encoded(read_schema(grammar.schema))) for grammar in XML_GRAMMARS)


def libraries() -> Iterator[tuple[Path, bytes]]:
    return ((Path(table_of(name)), encoded(read_library(name))) for name in (BEHAVIORTREE_CPP, *LIBRARIES))


def update(tables: Iterator[tuple[Path, bytes]], *, check: bool) -> list[Path]:
    """Write tables, or only compare them; return the files that were not current."""
    stale = []
    for file, content in tables:
        if not file.is_file() or file.read_bytes() != content:
            stale.append(file)
            if not check:
                file.parent.mkdir(exist_ok=True)
                file.write_bytes(content)
    return stale


if __name__ == "__main__":
    update(libraries(), check=False)
    update(grammars(), check=False)
