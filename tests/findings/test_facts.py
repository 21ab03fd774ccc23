# SPDX-License-Identifier: Apache-2.0
"""Fixes are selected by facts, never by the text of a message. Facts are unchanged after they are sent through a
client."""

from __future__ import annotations

import ast
import enum
import json
import types
import typing
from collections.abc import Iterator
from pathlib import Path

import pytest

import roaml
from fixture import Case, write_files
from mending import found, offered, workspace_of
from roaml.diagnostics import Finding
from roaml.facts import Facts, facts_from_json, facts_to_json
from roaml.ide.code_actions.quick_fixes import FIXES_ACROSS_FILES
from roaml.rules import BY_CODE, RULES
from rule_files import cases_of_rules, documents, examples

SERVER = Path(roaml.__file__).parents[1]
TEXT_METHODS = {"startswith", "endswith", "find", "index", "count", "partition", "rpartition", "split", "removeprefix"}
MATCHERS = {"search", "match", "fullmatch", "finditer", "findall", "sub"}

WITH_FIX = [code for code, text in documents().items() if "\n## Fix\n" in text]
CASES = [
    *(case for code in WITH_FIX for case in examples(code, "Bad")),
    *(case for case in cases_of_rules() if case.subject in FIXES_ACROSS_FILES),
]


# ------------------------------------------------------------------ messages


def reworded(message: str) -> str:
    """Messages in which every word is replaced. Different messages stay different."""
    return message.encode("utf-8").hex()


def reword_all(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let all findings have other messages for all code that reads them."""
    original = vars(Finding)["message"]
    monkeypatch.setattr(Finding, "message", property(lambda finding: reworded(original.__get__(finding))))


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case.subject}: {case.title}")
def test_every_fix_is_offered_with_other_messages(case: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_files(tmp_path, case.text)
    before = shown(tmp_path)
    reword_all(monkeypatch)
    assert shown(tmp_path) == before


def shown(folder: Path) -> list[tuple[object, ...]]:
    """All fixes that are offered in a folder."""
    fixes = offered(workspace_of(folder).snapshot())
    return sorted((d.path, d.span, d.code, action.title, action.preferred) for d, action in fixes)


def test_messages_are_reworded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the rewording, the test above would prove nothing."""
    [case] = examples("missing-file", "Bad")[:1]
    write_files(tmp_path, case.text)
    messages = {d.message for d in found(workspace_of(tmp_path).snapshot())}
    reword_all(monkeypatch)
    assert {d.message for d in found(workspace_of(tmp_path).snapshot())} == set(map(reworded, messages))


@pytest.mark.parametrize("path", sorted(SERVER.rglob("*.py")), ids=lambda path: path.relative_to(SERVER).as_posix())
def test_no_code_reads_a_message(path: Path) -> None:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    assert [node.lineno for node in ast.walk(tree) if _looks_into_a_message(node)] == []


def _looks_into_a_message(node: ast.AST) -> bool:
    match node:
        case ast.Compare():
            return any(map(_is_message, (node.left, *node.comparators)))
        case ast.Call(func=ast.Attribute(value=value, attr=name)):
            is_method = _is_message(value) and name in TEXT_METHODS
            return is_method or (name in MATCHERS and any(map(_is_message, node.args)))
        case ast.Match():
            return _is_message(node.subject)
    return False


def _is_message(node: ast.AST) -> bool:
    return isinstance(node, ast.Attribute) and node.attr == "message"


@pytest.mark.parametrize(
    "code",
    ['d.message.startswith("a")', '"a" in d.message', 'd.message == "a"', "FORM.search(d.message)", "x[d.message < y]"],
)
def test_code_that_reads_a_message_is_noticed(code: str) -> None:
    assert any(_looks_into_a_message(node) for node in ast.walk(ast.parse(code)))


# ------------------------------------------------------------------- as JSON

TYPES = sorted({rule.facts for rule in RULES if rule.facts}, key=lambda type_: type_.__name__)


class Color(enum.Enum):
    RED = "red"
    BLUE = "blue"


class Sample(Facts, frozen=True):
    text: str
    number: int
    flag: bool
    color: Color
    names: tuple[str, ...]
    other: Color | None


def values(hint: object) -> Iterator[object]:
    """Some values of the type of a field."""
    if isinstance(hint, types.UnionType):
        for part in typing.get_args(hint):
            yield from values(part)
    elif hint is type(None):
        yield None
    elif typing.get_origin(hint) is tuple:
        yield ()
        yield tuple(values(typing.get_args(hint)[0]))
    elif isinstance(hint, type) and issubclass(hint, enum.Enum):
        yield from hint
    else:
        yield from {str: ("", "a `b`"), int: (0, -7), bool: (True, False)}[hint]  # type: ignore[index]


@pytest.mark.parametrize("type_", [*TYPES, Sample])
def test_facts_survive_json(type_: type[Facts]) -> None:
    hints = typing.get_type_hints(type_)
    columns = [list(values(hints[name])) for name in type_.__struct_fields__]
    for number in range(max(map(len, columns), default=1)):
        facts = type_(*(column[number % len(column)] for column in columns))
        assert facts_from_json(type_, json.loads(json.dumps(facts_to_json(facts)))) == facts


SOUND = {"text": "a", "number": 1, "flag": True, "color": "RED", "names": ["a"], "other": None}


@pytest.mark.parametrize(
    "sent",
    [
        None,
        [],
        "facts",
        {},
        {**SOUND, "more": 1},
        {key: value for key, value in SOUND.items() if key != "flag"},
        {**SOUND, "text": 1},
        {**SOUND, "text": None},
        {**SOUND, "number": True},
        {**SOUND, "number": "1"},
        {**SOUND, "number": 1.0},
        {**SOUND, "flag": 1},
        {**SOUND, "color": "red"},
        {**SOUND, "color": "__class__"},
        {**SOUND, "color": ["RED"]},
        {**SOUND, "names": "a"},
        {**SOUND, "names": [1]},
        {**SOUND, "names": {"a": 1}},
        {**SOUND, "other": "GREEN"},
    ],
)
def test_foreign_json_is_refused(sent: object) -> None:
    assert facts_from_json(Sample, SOUND) == Sample("a", 1, True, Color.RED, ("a",), None)
    assert facts_from_json(Sample, sent) is None


def test_rules_with_facts_declare_them() -> None:
    assert {"missing-file", "input-count", "invalid-name"} <= {code for code, rule in BY_CODE.items() if rule.facts}
