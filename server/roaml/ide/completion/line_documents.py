# SPDX-License-Identifier: Apache-2.0
"""Completion in files that are read line by line, and in comments: codes of rules in `as2fm: ignore[…]`, settings,
their values and properties in `as2fm.toml`, types in ROS interface definitions, and names of nodes and distributions in
files of mocks."""

from __future__ import annotations

import re
from collections.abc import Iterator

from roaml.diagnostics import Symbol
from roaml.distributions.laws import HISTOGRAM, LAWS
from roaml.ide.completion.experiments import experiment_keys, experiment_values
from roaml.ide.completion.item import CompletionItem, ItemKind, Rank
from roaml.interfaces import PRIMITIVES
from roaml.mocks.likeness import library_parents, needs_likeness
from roaml.mocks.mock import KEYWORD
from roaml.model.config_files import CONFIG_FILE
from roaml.model.kinds import EXPERIMENT_SUFFIX, MOCKS_EXTENSION, FileKind
from roaml.model.tree import nodes
from roaml.project.analysis import Analysis
from roaml.project.paths import folder_of, name_of
from roaml.project.settings import SETTING_DOCUMENTATION, SEVERITIES, TABLES_OF_SETTINGS, VALUES_OF_SETTINGS
from roaml.regex import regex
from roaml.roles import SymbolKind
from roaml.rules import RULES
from roaml.text import Span

_IN_SUPPRESSION = regex(r"as2fm:\s*ignore\s*\[[^\]<>]*\Z")
_WORD_BEFORE = regex(r"[\w/-]*\Z", re.ASCII)
_VALUE_BEFORE = regex(r"[\w/.-]*\Z", re.ASCII)
_WORD_AFTER = regex(r"[\w/-]*", re.ASCII)
_KEY = regex(r"\s*([\w-]*)\Z", re.ASCII)
_VALUE = regex(r"^\s*([\w.-]+)\s*=[^=]*\Z", re.ASCII)
_DURATION = regex(r":.*\sin\s+\w*\Z")
_LIKE = regex(r"^\s*(.+?)\s*:\s*(as\s+)?\w*\Z")
_PORT_OF_LIKE = regex(r":\s*as\s+(\w+)\s*\((?:[^)]*,)?\s*\w*\Z")
_BARE_KEY = regex(r"[\w-]+", re.ASCII)
_CODE_SETTINGS = ("select", "ignore", "severity")


def in_lines(analysis: Analysis, path: str, offset: int) -> tuple[Span, list[CompletionItem]] | None:
    """The completions at a caret, and the span that they replace; `None` if the caret is not in a place that this
    module knows."""
    source = analysis.source(path)
    if source is None:
        return None
    text = source.text
    line = text[text.rfind("\n", 0, offset) + 1 : offset]
    if _IN_SUPPRESSION.search(line):
        return _word(text, offset), list(_codes())
    if name_of(path) == CONFIG_FILE:
        items = list(_in_configuration(analysis, path, text[:offset], line))
        return (_word(text, offset), items) if items else None
    if path.endswith(EXPERIMENT_SUFFIX):
        items = list(_in_experiment(analysis, path, text[:offset], line))
        return (_word(text, offset, _VALUE_BEFORE if "=" in line else _WORD_BEFORE), items) if items else None
    if path.endswith(MOCKS_EXTENSION):
        if "#" not in line and (likes := list(_likes(analysis, path, line))):
            return _word(text, offset), likes
        if "#" in line or (":" in line and not _DURATION.search(line)):
            return None
        return _word(text, offset), list(_durations() if ":" in line else _nodes(analysis, path))
    if analysis.kind(path) is FileKind.INTERFACE and re.fullmatch(r"\s*[\w/]*", line, re.ASCII):
        return _word(text, offset), list(_message_types(analysis))
    return None


def _word(text: str, offset: int, word: re.Pattern[str] = _WORD_BEFORE) -> Span:
    before, after = word.search(text, 0, offset), _WORD_AFTER.match(text, offset)
    assert before is not None
    assert after is not None
    return Span(before.start(), after.end())


def _codes() -> Iterator[CompletionItem]:
    for rule in RULES:
        yield CompletionItem(rule.code, ItemKind.VALUE, detail=rule.summary)


def _in_configuration(analysis: Analysis, path: str, before: str, line: str) -> Iterator[CompletionItem]:
    """Settings and names of properties at the beginning of a line; codes and other words where a setting has them as
    values."""
    section = _section(before)
    value = _VALUE.match(_statement(before))
    if value is not None:
        if value[1] in _CODE_SETTINGS:
            yield from _codes()
        for word in VALUES_OF_SETTINGS.get(_within(section, value[1]), ()):
            insert = word if '"' in line or word in ("true", "false") else f'"{word}"'
            yield CompletionItem(word, ItemKind.VALUE, insert)
        if section == "severity":
            for word in SEVERITIES:
                yield CompletionItem(word, ItemKind.VALUE, word if '"' in line else f'"{word}"')
    elif _KEY.fullmatch(line):
        if section == "severity":
            yield from _codes()
        if section == "verify.expect":
            for name in sorted(analysis.property_names_below(folder_of(path))):
                if _BARE_KEY.fullmatch(name):
                    yield CompletionItem(name, ItemKind.ATTRIBUTE, f'{name} = "$1"', detail="property")
        for name in TABLES_OF_SETTINGS.get(section, ()):
            yield CompletionItem(name, ItemKind.ATTRIBUTE, detail=SETTING_DOCUMENTATION[_within(section, name)])


def _in_experiment(analysis: Analysis, path: str, before: str, line: str) -> Iterator[CompletionItem]:
    """Keys and names of parameters at the beginning of a line; values and names where a key has them."""
    section = _section(before)
    value = _VALUE.match(_statement(before))
    if value is not None and not section:
        is_quoted = line.count('"') % 2 == 1
        for word, about in experiment_values(analysis, path, value[1]):
            yield CompletionItem(word, ItemKind.VALUE, word if is_quoted else f'"{word}"', about)
    elif _KEY.fullmatch(line):
        yield from experiment_keys(analysis, path, section)


def _section(before: str) -> str:
    """The table that contains the end of a text; "" before the first one."""
    table = re.findall(r"^\s*\[\s*([\w.-]+)\s*\]", before, re.MULTILINE)
    return table[-1] if table else ""


def _within(section: str, name: str) -> str:
    """The whole name of a setting in a table; "" is the table of all settings."""
    return f"{section}.{name}" if section else name


def _statement(before: str) -> str:
    """The text from the beginning of the last statement: an array may continue over several lines."""
    start = len(before)
    while start > 0:
        start = before.rfind("\n", 0, start - 1) + 1 if start > 1 else 0
        statement = before[start:]
        if "=" in statement or statement.count("]") > statement.count("["):
            return statement if _is_open(statement) else before[before.rfind("\n") + 1 :]
    return before


def _is_open(statement: str) -> bool:
    """Whether a statement continues at the caret: it has one line, or an array that is not closed."""
    return "\n" not in statement or statement.count("[") > statement.count("]")


def _nodes(analysis: Analysis, path: str) -> Iterator[CompletionItem]:
    """The names and types of the nodes of the tree that a file of mocks belongs to."""
    file = analysis.tree(f"{path.removesuffix(MOCKS_EXTENSION)}.xml")
    names: dict[str, str] = {}
    for tree in file.trees if file is not None else ():
        for node in nodes(tree):
            if node.plugin is not None and not node.is_subtree and not node.children:
                names.setdefault(node.plugin.value, "node")
    names.update((name, "node with children") for name in _own_parents(analysis, path))
    for name, detail in names.items():
        yield CompletionItem(name, ItemKind.PLUGIN, detail=detail)


def _own_parents(analysis: Analysis, path: str) -> Iterator[str]:
    """The types and names of the nodes with children that no library describes. A file of mocks belongs to their
    tree."""
    forest = analysis.forest(f"{path.removesuffix(MOCKS_EXTENSION)}.xml")
    for _, _, node in forest.all_nodes if forest is not None else ():
        if forest is not None and node.plugin is not None and needs_likeness(forest, node):
            yield from (word.value for word in (node.plugin, node.name) if word is not None)


def _likes(analysis: Analysis, path: str, line: str) -> Iterator[CompletionItem]:
    """The nodes of libraries like which a node with children can be executed, and their ports."""
    if (ports := _PORT_OF_LIKE.search(line)) is not None:
        known = library_parents().get(ports[1])
        for port in known.ports if known is not None else ():
            yield CompletionItem(port.name, ItemKind.PORT, f"{port.name}=$1", port.text)
    elif (like := _LIKE.match(line)) is not None and (like[2] or like[1] in _own_parents(analysis, path)):
        for name, node in library_parents().items():
            yield CompletionItem(name, ItemKind.PLUGIN, name if like[2] else f"{KEYWORD} {name}", node.text)


def _durations() -> Iterator[CompletionItem]:
    """The distributions of the durations of mocks."""
    for law in LAWS.values():
        if law.name != HISTOGRAM:
            stops = (f"${{{number}:{name}}}" for number, name in enumerate(law.parameters, 1))
            factor = "" if law.has_units else f" * ${{{len(law.parameters) + 1}:100 ms}}"
            call = f"{law.name}({', '.join(stops)}){factor}"
            yield CompletionItem(law.name, ItemKind.FUNCTION, call, law.documentation)
    about = "The values in a CSV file, with their unit: a column of values, and optionally one with their numbers."
    yield CompletionItem(HISTOGRAM, ItemKind.FUNCTION, f"{HISTOGRAM}('${{1:times.csv}}', ${{2:s}})", about)


def _message_types(analysis: Analysis) -> Iterator[CompletionItem]:
    for name in sorted(PRIMITIVES):
        yield CompletionItem(name, ItemKind.TYPE, rank=Rank.LIKELY)
    for package, kinds in analysis.registry.search_path.packages().items():
        for name in kinds["msg"]:
            label = f"{package}/{name}"
            about = Symbol("", SymbolKind.ROS_TYPE, label, "msg")
            yield CompletionItem(label, ItemKind.TYPE, about=about)
