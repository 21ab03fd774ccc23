# SPDX-License-Identifier: Apache-2.0
"""Property files in XML in the editor: names, navigation, rename, outline."""

from __future__ import annotations

from pathlib import Path

import pytest
from ide_models import load
from ide_sweep import System

from fixture import split_files
from property_robot import PROPERTIES, ROBOT
from roaml.ide.code_lens import counted, lenses
from roaml.ide.hover import hover
from roaml.ide.inlay_hints import inlay_hints
from roaml.ide.names.occurrences import occurrences
from roaml.ide.navigation import definition, references
from roaml.ide.navigation.document_symbols import document_symbols
from roaml.ide.navigation.workspace_symbols import search
from roaml.ide.rename import RenameRefusal, Renaming, rename
from roaml.ide.verifiable import verifiable
from roaml.roles import SymbolKind
from roaml.text import Location, Span, apply_edits

TEXTS = split_files(ROBOT)


class Robot:
    """The system in a folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.analysis = load(folder, TEXTS)
        self.path = self.path_of("properties.xml")

    def path_of(self, name: str) -> str:
        return str(self.folder / name)

    def shown(self, places: tuple[Location, ...]) -> list[str]:
        names = {self.path_of(name): name for name in TEXTS}
        texts = ((names[place.path], place.span) for place in places if place.path in names)
        return sorted(f"{name}: {TEXTS[name][span.start : span.end]}" for name, span in texts)


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Robot:
    return Robot(tmp_path_factory.mktemp("robot"))


def caret(piece: str, file: str = "properties.xml") -> int:
    """The offset of `|` in a piece of a file."""
    before, after = piece.split("|")
    text = TEXTS[file]
    assert text.count(before + after) == 1, piece
    return text.index(before + after) + len(before)


def test_names(robot: Robot) -> None:
    main = robot.path_of("main.xml")
    names = [
        (PROPERTIES[use.span.start : use.span.end], use.symbol.kind.value, use.symbol.name)
        for use in occurrences(robot.analysis, robot.path, main)
    ]
    assert set(names) >= {
        ("battery/level", "topic", "battery__level"),
        ("std_msgs/Int32", "ros-type", "std_msgs/Int32"),
        ("data", "field", "data"),
        ("stamp", "field", "stamp"),
        ("sec", "field", "sec"),
        ("/charge", "service", "/charge"),
        ("Battery", "machine", "Battery"),
        ("success", "field", "success"),
        ("/count", "action", "/count"),
        ("right_pick", "tree-node", "right_pick"),
        ("Left", "tree-node", "Left"),
        ("pick", "tree-node", "pick"),
        ("Main", "tree", "Main"),
        ("Other", "tree", "Other"),
        ("full", "event", "full"),
        ("amount", "parameter", "amount"),
        ("battery__level", "topic", "battery__level"),
        ("charges", "property", "charges"),
        ("level", "port-variable", "level"),
    }
    assert names.count(("level", "port-variable", "level")) == 2
    assert names.count(("measured", "port-variable", "measured")) == 2


@pytest.mark.parametrize(
    ("piece", "expected"),
    [
        ('topic_name="/battery|/level"', ["battery.ascxml: battery/level"]),
        ('service_name="/cha|rge" type="std_srvs/SetBool" event="request"', ["charger.ascxml: /charge"]),
        ('node="Le|ft/pick"', ["tree.xml: Left"]),
        ('node="Left/p|ick"', ["tree.xml: pick"]),
        ('event="f|ull"', ["battery.ascxml: full"]),
        ('origin="Bat|tery"', ["battery.ascxml: Battery"]),
        ("<event>lev|el &lt; 30", ["properties.xml: level"]),
        ('until="pic|ked', ["properties.xml: picked"]),
        ("{ succ|ess", ["properties.xml: success"]),
    ],
)
def test_definitions(robot: Robot, piece: str, expected: list[str]) -> None:
    assert robot.shown(definition(robot.analysis, robot.path, caret(piece))) == expected


def test_references_from_a_machine(robot: Robot) -> None:
    offset = caret('topic="/battery|/level"', "battery.ascxml")
    uses = robot.shown(references(robot.analysis, robot.path_of("battery.ascxml"), offset))
    assert uses == [
        "battery.ascxml: battery/level",
        "properties.xml: battery/level",
        "properties.xml: battery__level",
    ]
    uses = robot.shown(references(robot.analysis, robot.path_of("tree.xml"), caret('Pick name="p|ick"', "tree.xml")))
    assert uses == ["properties.xml: pick", "tree.xml: pick"]


@pytest.mark.parametrize(
    ("file", "piece", "new", "expected"),
    [
        ("battery.ascxml", 'topic="/battery|/level"', "/cell/state", ['"/cell/state"', "topic_cell__state_msg"]),
        ("tree.xml", 'Pick name="p|ick"', "grab", ['node="Left/grab"']),
        ("tree.xml", 'name="L|eft"', "West", ['node="West/pick"']),
        ("tree.xml", 'BehaviorTree ID="O|ther"', "Rest", ['node="Main/Rest/right_pick"']),
        ("battery.ascxml", '<ascxml name="Bat|tery"', "Cell", ['origin="Cell"', 'target="Cell"']),
        ("battery.ascxml", 'send event="f|ull"', "loaded", ['event="loaded"']),
        ("battery.ascxml", 'param name="am|ount"', "much", ['param="much"']),
        ("properties.xml", 'state_var id="lev|el"', "charge", ['id="charge"', "<event>charge &lt; 30"]),
        ("properties.xml", 'event_var id="meas|ured"', "seen", ['id="seen"', "{ seen }"]),
        ("properties.xml", 'property id="cha|rges"', "recharges", ['id="recharges"']),
    ],
)
def test_renaming(robot: Robot, file: str, piece: str, new: str, expected: list[str]) -> None:
    renaming = rename(robot.analysis, robot.path_of(file), caret(piece, file), new)
    assert isinstance(renaming, Renaming)
    text = apply_edits(PROPERTIES, renaming.edits[robot.path])
    for part in expected:
        assert part in text


@pytest.mark.parametrize(
    ("file", "piece", "new", "reason"),
    [
        ("properties.xml", 'state_var id="lev|el"', "measured", "a port variable `measured` already exists"),
        ("properties.xml", 'state_var id="lev|el"', "a-b", "`a-b` is not a valid name of a port variable"),
        ("properties.xml", 'state_var id="lev|el"', "true", "`true` is not a valid name of a port variable"),
        ("properties.xml", 'property id="cha|rges"', "polite", "a property `polite` already exists"),
        ("properties.xml", 'property id="cha|rges"', "fills", "a property `fills` already exists"),
        ("properties.xml", 'field="stamp.s|ec"', "x", "`sec` is defined by ROS, not by this model"),
        ("tree.xml", 'Pick name="p|ick"', "right_pick", "properties refer to nodes of the tree by their names"),
    ],
)
def test_refused_renaming(robot: Robot, file: str, piece: str, new: str, reason: str) -> None:
    refusal = rename(robot.analysis, robot.path_of(file), caret(piece, file), new)
    assert isinstance(refusal, RenameRefusal)
    assert reason in refusal.reason


def test_every_name_can_be_renamed(tmp_path: Path) -> None:
    for name, text in TEXTS.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    system = System(str(tmp_path / "main.xml"))
    assert system.model is not None
    cases = [case for case in system.cases() if any(use.path.endswith("properties.xml") for use in case.thing.uses)]
    assert len(cases) >= 30
    failures = {case.name: failure for case in cases for failure in system.failures(case)}
    assert failures == {}


def test_outline(robot: Robot) -> None:
    ports, guarantees = document_symbols(robot.analysis, robot.path)
    assert [(symbol.name, symbol.detail) for symbol in ports.children][:4] == [
        ("/battery/level", "publish"),
        ("/pose", "publish"),
        ("/charge", "request"),
        ("/charge", "response"),
    ]
    assert [(symbol.name, symbol.detail) for symbol in ports.children[0].children] == [
        ("level", "int32"),
        ("measured", ""),
    ]
    assert [symbol.name for symbol in guarantees.children] == ["charges", "polite", "counts", "steady"]
    assert guarantees.children[0].detail == "Whenever level < 30 holds, /charge is called by Battery within 10 s."


def test_workspace_symbols(robot: Robot) -> None:
    symbols = [match.symbol for match in search(robot.analysis, [robot.path], "charges")]
    assert [(symbol.kind.value, symbol.name) for symbol in symbols] == [("property", "charges")]


def hovered(robot: Robot, piece: str, file: str = "properties.xml") -> str:
    shown = hover(robot.analysis, robot.path_of(file), caret(piece, file))
    return shown.text if shown is not None else ""


@pytest.mark.parametrize(
    ("piece", "parts"),
    [
        ('id="char|ges"', ["Whenever `level < 30` holds, `/charge` is called by `Battery` within 10 s."]),
        ('id="char|ges"', ["```\nG ((level < 30) ⇒ F[0, 10 s] asked)\n```"]),
        ('<prop|erty id="charges"', ["Whenever `level < 30` holds"]),
        ('id="po|lite"', ["From the first time that `filled || amount > 3` holds, whenever a response of `/charge`"]),
        ('id="cou|nts"', ["Each time from when `Main/Other/right_pick` is ticked until", "nothing is required if"]),
        ('id="ste|ady"', ["At every step, (if a message is published on `/battery/level`, then ("]),
        ('topic_name="/battery|/level"', ["**Published by** `Battery`"]),
        ('node="Left/p|ick"', ["node pick"]),
        ("<event>lev|el &lt; 30", ["level : int32", "The value of `data` at the last time", "`100` before"]),
        ('until="pic|ked', ["True in the step in which `Left/pick` answers"]),
        ("status == |1", ["1 = SUCCESS"]),
        ("code == |4", ["4 = STATUS_SUCCEEDED"]),
        ('pattern="resp|onse"', ["Whenever the first condition holds"]),
        ('field="stamp.s|ec"', ["int32"]),
    ],
)
def test_hover(robot: Robot, piece: str, parts: list[str]) -> None:
    text = hovered(robot, piece)
    for part in parts:
        assert part in text


def test_hover_in_jani(robot: Robot) -> None:
    text = hovered(robot, '"bt_1003_resp|onse__status"', "more.jani")
    assert 'Node `Left/Pick "pick"` of the tree' in text


def test_inlay_hints(robot: Robot) -> None:
    def hints(name: str) -> set[str]:
        text = TEXTS[name]
        actual_hints = inlay_hints(robot.analysis, robot.path_of(name), Span(0, len(text)))
        return {text[: hint.offset].rpartition(" ")[2] + hint.text for hint in actual_hints}

    assert hints("properties.xml") >= {
        'node="Left/pick" Left/Pick "pick"',
        'node="Main/Other/right_pick" Other/Pick "right_pick"',
        "1 SUCCESS",
        "4 STATUS_SUCCEEDED",
    }
    assert hints("more.jani") == {'"bt_1003_response__status" Left/Pick "pick"', "1 SUCCESS"}


def test_lenses(robot: Robot) -> None:
    actual_lenses = [lens for lens in lenses(robot.analysis, robot.path) if lens.symbol.kind is SymbolKind.PROPERTY]
    titles = [counted(robot.analysis, lens.symbol, robot.path).title for lens in actual_lenses]
    assert titles[0] == "Whenever level < 30 holds, /charge is called by Battery within 10 s."
    assert len(titles) == 4


def test_the_properties_that_can_be_verified(robot: Robot) -> None:
    properties = verifiable(robot.analysis, robot.path_of("main.xml"))
    assert [property_.name for property_ in properties] == ["charges", "polite", "counts", "steady", "fills"]
    first = properties[0]
    assert first.comment == "Whenever level < 30 holds, /charge is called by Battery within 10 s."
    assert PROPERTIES[first.name_span.start : first.name_span.end] == "charges"
