# SPDX-License-Identifier: Apache-2.0
"""Benchmarks measure what they describe. The tests do not check times."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice
from pathlib import Path

import pytest

from bench.check import opened
from bench.experiments import write_robot
from bench.generate import FIRST, write_system
from bench.keystrokes import keys, word_keys
from bench.layouts import graphs
from bench.pictures import machine
from bench.planted import groups, judged, mistakes
from bench.reductions import HEADING, Counted, Size, with_table
from bench.report import Row, percentile, seconds, table
from bench.requests import REQUESTS, REST, idle_times
from bench.server import started
from bench.trees import NODES, WORDS, write_tree
from roaml import api
from roaml.diagnostics import Severity
from roaml.ide.diagrams import DiagramKind, picture_of
from roaml.project.configuration import find_settings
from roaml.project.settings import Settings
from roaml.project.workspace import Workspace


@pytest.mark.parametrize(("files", "lines"), [(5, 700), (30, 700), (12, 200)])
def test_a_generated_system_has_no_findings(tmp_path: Path, files: int, lines: int) -> None:
    main = write_system(tmp_path, files, lines)
    result = api.check([str(main)], settings=Settings())
    assert [f"{d.path}: {d.code} {d.message}" for d in result.diagnostics] == []
    assert len(result.files) == len(list(tmp_path.iterdir())) == files
    written = (tmp_path / FIRST).read_text(encoding="utf-8").count("\n")
    assert abs(written - lines) <= 35


@pytest.mark.parametrize("name", ["ring 12", "star 12", "random 24"])
def test_a_machine_to_draw_has_the_shape_of_its_graph(tmp_path: Path, name: str) -> None:
    path = tmp_path / "machine.ascxml"
    path.write_text(machine("Machine", graphs()[name]), encoding="utf-8")
    result = api.check([str(path)], settings=Settings())
    assert [d for d in result.diagnostics if d.severity is Severity.ERROR] == []
    picture = picture_of(DiagramKind.MACHINE, result.snapshot.analysis, str(path))
    assert picture is not None
    places = {node.id: number for number, node in enumerate(picture.nodes)}
    ends = sorted((places[edge.source], places[edge.target]) for edge in picture.edges)
    assert (len(picture.nodes), ends) == (graphs()[name][0], sorted(graphs()[name][1]))


def test_a_generated_tree_has_300_nodes_and_no_mistakes(tmp_path: Path) -> None:
    path = write_tree(tmp_path)
    result = api.check([str(tmp_path)])
    assert [d.message for d in result.diagnostics if d.severity >= Severity.WARNING] == []
    file = result.snapshot.analysis.tree(str(path))
    assert file is not None
    assert abs(sum(len(nodes) for nodes in file.nodes_by_tree.values()) - NODES) <= NODES // 10


def test_each_key_in_a_tree_changes_the_diagnostics(tmp_path: Path) -> None:
    """Otherwise the server publishes none, and the benchmark waits until its time limit."""
    path = str(write_tree(tmp_path))
    text = Path(path).read_text(encoding="utf-8")
    workspace = Workspace([str(tmp_path)], find_settings(path)[0])
    known = workspace.snapshot().checker.diagnostics(path)
    for key in word_keys(text, words=WORDS):
        workspace.open(path, key.text)
        diagnostics = workspace.snapshot().checker.diagnostics(path)
        assert diagnostics != known, f"the server does not answer {key.change()}"
        known = diagnostics


def test_the_robot_of_experiments_has_a_parameter(tmp_path: Path) -> None:
    main = str(write_robot(tmp_path / "robot"))
    assert [d.message for d in api.check([main]).diagnostics if d.severity >= Severity.WARNING] == []
    points = api.experiment(main, {"drops": [0.25, 0.75]}, ["block_dropped"]).points
    assert [point.value for point in points] == pytest.approx([0.75, 0.25])


def test_a_generated_system_is_always_the_same(tmp_path: Path) -> None:
    first, second = (write_system(tmp_path / name, 6).parent for name in ("a", "b"))
    assert {f.name: f.read_bytes() for f in first.iterdir()} == {f.name: f.read_bytes() for f in second.iterdir()}


def test_keys_change_what_is_wrong(tmp_path: Path) -> None:
    write_system(tmp_path, 6, lines=350, small_lines=60)
    path = str(tmp_path / FIRST)
    text = Path(path).read_text(encoding="utf-8")
    workspace = Workspace([str(tmp_path)], Settings())
    known, last, changes = workspace.snapshot().checker.diagnostics(path), text, 0
    pressed = list(keys(text, rounds=1))
    for key in pressed:
        assert key.before == last
        assert key.text == key.before[: key.start] + key.inserted + key.before[key.end :]
        workspace.open(path, key.text)
        diagnostics = workspace.snapshot().checker.diagnostics(path)
        assert diagnostics or known, f"a server would not answer {key.change()}"
        changes += diagnostics != known
        known, last = diagnostics, key.text
    assert known == ()
    assert changes > 0.9 * len(pressed)


def test_keys_name_places_as_the_protocol_does(tmp_path: Path) -> None:
    write_system(tmp_path, 6)
    text = (tmp_path / FIRST).read_text(encoding="utf-8")
    first, second = list(keys(text))[:2]
    line = text.splitlines().index('        <data id="counter" type="int32" expr="0" />')
    start, end = ({"line": line, "character": character} for character in (24, 25))
    assert first.change() == {"range": {"start": start, "end": end}, "text": ""}
    assert second.change() == {"range": {"start": start, "end": start}, "text": "r"}


def test_the_server_answers(tmp_path: Path) -> None:
    write_system(tmp_path, 6, lines=150)
    path = tmp_path / FIRST
    text = path.read_text(encoding="utf-8")
    with started() as server:
        server.initialize(tmp_path)
        sent = server.open(path, text.replace('"speed"', '"sped"', 1))
        arrived, diagnostics = server.diagnostics(path, 1)
        assert {diagnostic["code"] for diagnostic in diagnostics} == {"undeclared-variable", "unused-variable"}
        assert server.started < sent < arrived
        server.change(path, 2, {"text": text})
        assert server.diagnostics(path, 2)[1] == []


def test_every_request_is_answered(tmp_path: Path) -> None:
    write_system(tmp_path, 6, lines=350, small_lines=60)
    path = tmp_path / FIRST
    with opened(tmp_path, REST) as (server, text):
        for request in REQUESTS:
            assert request.capability in server.capabilities
            took = list(islice(idle_times(server, path, text, request), 8))
            assert len(took) == 8
            assert min(took) > 0


def test_figures() -> None:
    assert [percentile([3, 1, 2], percent) for percent in (1, 50, 95, 100)] == [1, 2, 3, 3]
    assert percentile(range(1, 101), 95) == 95
    assert [seconds(value) for value in (0.0041, 0.29, 0.31, 12)] == ["4 ms", "290 ms", "0.31 s", "12.00 s"]
    assert table([Row("a", "1 ms", "", "b")]).splitlines()[-1] == "| a | 1 ms |  | b |"


@pytest.mark.parametrize("group", groups())
def test_planted_mistakes_change_their_files(group: str) -> None:
    for mistake in mistakes(group):
        assert mistake.edited() != mistake.file.read_text(encoding="utf-8"), str(mistake)
        assert mistake.lines(), str(mistake)


def test_a_planted_mistake_is_judged_by_the_line_of_its_finding() -> None:
    mistake = next(m for m in mistakes("answers") if m.file.name == "battery_above.ascxml")
    assert judged(mistake)[0] == "found"
    assert judged(replace(mistake, places=("</ascxml>",)))[0] == "elsewhere"
    assert judged(replace(mistake, old="<datamodel>", new="<datamodel>", after=""))[0] == "silent"


def test_the_table_of_the_numbers_of_states_is_replaced_and_nothing_else() -> None:
    known, more = Size(3_646, False, 0.1), Size(2_000_000, True, 4.1)
    found = [
        Counted("models/uc2/Main/main_bug.xml", "p", "any", more, known),
        Counted("models/uc2/Main/main_bug.xml", "p", "instant", known, known),
        Counted("models/plain/main.xml", "q", "any", known, known),
    ]
    table = (
        "| --- | --- | --- | --- | --- | --- |\n"
        "| `uc2/main_bug` | `p` | more than 2,000,000 | 3,646 | 3,646 | 3,646 |\n"
        "| `plain` | `q` | 3,646 | 3,646 | no timers | no timers |\n"
    )
    old = f"Before.\n\n{HEADING}\n| --- |\n| an old row |\n\nAfter.\n"
    new = f"Before.\n\n{HEADING}\n{table}\nAfter.\n"
    assert with_table(old, found) == new == with_table(new, found)
    with pytest.raises(ValueError, match="the page has no table"):
        with_table("Before.\n", found)
