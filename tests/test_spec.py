# SPDX-License-Identifier: Apache-2.0
"""The definition of the languages: its examples pass the check, its links and anchors are valid.

A complete file is a block after a line with its name in bold: **`battery.ascxml`**. The files of one page make one
folder.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

from as2fm_lsp.cli.main import run
from roaml import api
from roaml.expr.operators import FUNCTIONS, Operator
from roaml.expr.types import BASE_TYPES
from roaml.jani.writer import write
from roaml.language import BEHAVIOR_TREE, HL_SCXML
from roaml.lower.interfaces import ActionEvents, ServiceEvents, topic_event
from roaml.model.parameters import Parameters
from roaml.model.system import SystemAutomaton
from roaml.scxml.names import STATUSES, is_synchronising

ROOT = Path(__file__).resolve().parents[1]
SPEC = ROOT / "docs" / "spec"
PAGES = sorted(SPEC.glob("*.md"))
STYLE = SPEC.parent / "STYLE.md"

_BLOCK = re.compile(r"(?:^\*\*`(\S+)`\*\*\n\n)?^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_ANCHOR = re.compile(r'^<a id="([a-z0-9-]+)"></a>\n\n#{2,} (?:\d+\.)+(?:\d+)? \S', re.MULTILINE)
_LINK = re.compile(r"\]\(([^)\s]+)\)")
_ROOT = re.compile(r"\s*<(?:ascxml|scxml|roaml|root|types)\b")


def files_in(page: Path) -> dict[str, str]:
    """The complete files on a page, by name."""
    return {name: content for name, _, content in _BLOCK.findall(page.read_text(encoding="utf-8")) if name}


def anchors_in(page: Path) -> list[str]:
    return _ANCHOR.findall(page.read_text(encoding="utf-8"))


EXAMPLES: Mapping[str, dict[str, str]] = {page.name: files for page in PAGES if (files := files_in(page))}


def test_there_are_examples() -> None:
    assert {"machines.md", "ros.md", "trees.md", "types.md", "plugins.md"} <= EXAMPLES.keys()


@pytest.mark.parametrize("name", EXAMPLES)
def test_examples_are_clean(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for path, content in EXAMPLES[name].items():
        (tmp_path / path).write_text(content, encoding="utf-8")
    assert run(["--check", *EXAMPLES[name], "--warnings-as-errors"]) == 0, capsys.readouterr().out
    if "main.xml" in EXAMPLES[name]:
        assert run(["translate", "main.xml"]) == 0, capsys.readouterr().out


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_whole_document_has_a_name(page: Path) -> None:
    unnamed = [text for name, _, text in _BLOCK.findall(page.read_text(encoding="utf-8")) if not name]
    assert not [text for text in unnamed if _ROOT.match(text)]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_every_section_has_one_anchor(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    anchors = anchors_in(page)
    assert len(anchors) == len(set(anchors)) == len(re.findall(r"<a id=", text)) == len(re.findall(r"^##", text, re.M))


@pytest.mark.parametrize("page", [*PAGES, STYLE], ids=lambda page: page.stem)
def test_links_lead_somewhere(page: Path) -> None:
    for target in _LINK.findall(page.read_text(encoding="utf-8")):
        if target.startswith("https://"):
            continue
        path, _, anchor = target.partition("#")
        linked = (page.parent / path) if path else page
        assert linked.exists(), target
        if anchor:
            known = anchors_in(linked) if linked.parent == SPEC else headings(linked)
            assert anchor in known, target


def headings(page: Path) -> list[str]:
    """The anchors that a page gets from its headings."""
    titles = re.findall(r"^#+ (.+)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return [re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-") for title in titles]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_sections_are_numbered_in_order(page: Path) -> None:
    numbers = re.findall(r"^##+ ([\d.]+) ", page.read_text(encoding="utf-8"), re.MULTILINE)
    expected: list[str] = []
    chapter = section = 0
    for number in numbers:
        if number.endswith("."):
            chapter, section = chapter + 1, 0
            expected.append(f"{chapter}.")
        else:
            section += 1
            expected.append(f"{chapter}.{section}")
    assert numbers == expected


def test_the_contents_name_every_page() -> None:
    linked = set(re.findall(r"^\| \[[^]]+\]\((\w[\w-]*\.md)\)", (SPEC / "README.md").read_text(encoding="utf-8"), re.M))
    assert linked == {page.name for page in PAGES} - {"README.md"}


def test_the_example_of_a_translation(tmp_path: Path) -> None:
    for path, content in EXAMPLES["jani.md"].items():
        (tmp_path / path).write_text(content, encoding="utf-8")
    model = json.loads("".join(write(api.to_jani(api.load(tmp_path / "main.xml")))))
    machines = [listing(automaton) for automaton in model["automata"] if automaton["name"] in ("Sensor", "Guard")]
    (shown,) = [text for _, kind, text in _BLOCK.findall(section("jani", "example")) if kind == "text"]
    assert shown == "".join(machines)


def listing(automaton: Any) -> str:
    """The edges of an automaton in JANI, one in each line."""
    lines = [f"{automaton['name']}, initially {automaton['initial-locations'][0]}"]
    for edge in automaton["edges"]:
        guard = f"  [{infix(edge['guard']['exp'])}]" if "guard" in edge else ""
        lines.append(f"    {edge['location']}  {edge['action']}{guard}")
        for way in edge["destinations"]:
            stored = [
                f"{assignment['ref']} := {infix(assignment['value'])}" for assignment in way.get("assignments", ())
            ]
            chance = f"{way['probability']['exp']}: " if len(edge["destinations"]) > 1 else ""
            lines.append(f"        {chance}{way['location']}{'  ' if stored else ''}{'; '.join(stored)}")
    return "\n".join(lines) + "\n"


def infix(expression: Any) -> str:
    """An expression in JANI in the usual notation. Only the operators of the example are supported."""
    match expression:
        case bool():
            return str(expression).lower()
        case {"op": "¬", "exp": operand}:
            return f"¬{infix(operand)}" if isinstance(operand, str) else f"¬({infix(operand)})"
        case {"op": operator, "left": left, "right": right}:
            return f"{infix(left)} {operator} {infix(right)}"
    return str(expression)


# ---------------------------------------------------------------- what is said twice


def section(page: str, anchor: str) -> str:
    """The text of a section, up to the next section."""
    text = (SPEC / f"{page}.md").read_text(encoding="utf-8")
    return text.split(f'<a id="{anchor}"></a>')[1].partition("<a id=")[0]


def rows(page: str, anchor: str) -> Iterator[list[str]]:
    """The cells of the tables in a section, without their heads."""
    for table in re.findall(r"(?:^\|.*\|\n)+", section(page, anchor), re.MULTILINE):
        for line in table.splitlines()[2:]:
            yield [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]


def words(text: str) -> list[str]:
    """The texts in backquotes."""
    return re.findall(r"`([^`]+)`", text)


def test_base_types() -> None:
    named = {word for first, *_ in rows("types", "type-names") for word in words(first)}
    assert named - {"T[]", "T[N]"} == set(BASE_TYPES)


def test_functions_and_operators() -> None:
    named = {name for first, *_ in rows("expressions", "functions") for name in re.findall(r"Math\.(\w+)", first)}
    assert named | {"random"} == set(FUNCTIONS)
    described = {word.replace("\\|", "|") for first, *_ in rows("expressions", "operators") for word in words(first)}
    assert described == {operator.symbol for operator in Operator} | {"-x", "+x", "!x", "c ? a : b"}


def test_event_variables() -> None:
    for handlers, variables, *_ in rows("machines", "event-variables"):
        names = {word.partition(".")[0] for word in words(variables) if word.startswith("_")}
        full = [name for name in words(handlers) if name in HL_SCXML.elements]
        assert full, handlers
        for name in full:
            assert names <= {binding.name for binding in HL_SCXML.elements[name].binds}, name


def test_statuses() -> None:
    assert {words(name)[0]: int(number) for name, number in rows("plugins", "status")} == STATUSES


def test_nodes() -> None:
    nodes = {name: element for name, element in BEHAVIOR_TREE.elements.items() if element.node}
    generic = {"Action", "Condition", "Control", "Decorator", "SubTree", "SubTreePlus"}
    described = {
        word for anchor in ("control", "decorators") for first, *_ in rows("nodes", anchor) for word in words(first)
    }
    described |= set(words(section("nodes", "decorators").rpartition("|\n")[2]))
    refused = set(words(section("nodes", "absent").rpartition("cannot be translated:")[2]))
    for name in nodes.keys() - generic:
        element = nodes[name]
        kinds = (element.translated and not element.program_only, not element.translated)
        assert (name in described, name in refused) == kinds, name
    assert refused <= nodes.keys()


def test_ports_of_nodes() -> None:
    cells = [cells for anchor in ("control", "decorators") for cells in rows("nodes", anchor) if len(cells) == 4]
    known = {word: (words(type_), default) for first, type_, default, _ in cells for word in words(first)}
    for name, element in BEHAVIOR_TREE.elements.items():
        for attribute in element.ports if element.node and element.translated and not element.program_only else ():
            if attribute.port is None or name.startswith("Switch") or attribute.name.endswith("_threshold"):
                continue
            types, default = known[attribute.name]
            assert attribute.port.type in types, (name, attribute.name)
            assert default.strip("`") == (attribute.port.default or "–"), (name, attribute.name)


def test_parameters() -> None:
    defaults = {words(name)[0]: default.strip("`") for name, _, default, _ in rows("systems", "parameters")}
    known = Parameters()
    assert defaults == {
        "max_time": "required",
        "max_array_size": str(known.max_array_size),
        "bt_tick_rate": f"{known.tick_rate:g}",
        "bt_tick_if_not_running": str(known.tick_if_not_running).lower(),
        "random_values": str(known.random_values),
    }


EVENTS = {word for _, event, *_ in rows("plain-scxml", "events") for word in words(event)}


def test_events_of_interfaces() -> None:
    client = cast("SystemAutomaton", SimpleNamespace(name="C"))
    service, action = ServiceEvents("X"), ActionEvents("X")
    expected = {topic_event("X"), service.request_of(client), service.request, service.response}
    expected |= {service.response_to(client), action.goal_of(client), action.goal, action.accepted, action.rejected}
    expected |= {action.accept_for(client), action.reject_for(client), action.feedback, action.feedback_for(client)}
    expected |= {action.result, action.result_for(client), action.thread_start, action.thread_free}
    described = {event for event in EVENTS if event.startswith(("topic_X", "srv_", "action_"))}
    assert described == {event.name for event in expected}


def test_synchronising_events() -> None:
    (patterns,) = [text for _, kind, text in _BLOCK.findall(section("jani", "synchronising-names")) if kind == "text"]
    described = re.compile("|".join(patterns.split()))
    samples = {event.replace("N", "1000").replace("X", "arm__move") for event in EVENTS}
    samples |= {"open", "action_go_to_goal_feedback", "srv_x", "bt_x_tick", "global_timer_tick_event", "my_bt_1_tick"}
    assert [event for event in sorted(samples) if bool(described.search(event)) is not is_synchronising(event)] == []
    assert 0 < sum(map(is_synchronising, samples)) < len(samples)
