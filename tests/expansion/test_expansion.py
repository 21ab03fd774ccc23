# SPDX-License-Identifier: Apache-2.0
"""Systems with parameters and instances: they mean what the expanded systems mean; places lead back to the files."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import pytest

from as2fm_lsp.cli.main import run
from roaml import api
from roaml.diagnostics import Severity, Symbol
from roaml.ide.code_actions import new_parameter
from roaml.ide.completion import complete
from roaml.ide.describe import describe
from roaml.ide.hover import hover
from roaml.ide.names.lookup import symbol_group, symbol_group_at
from roaml.ide.rename import RenameRefusal, Renaming, rename
from roaml.jani.writer import write
from roaml.project.workspace import Snapshot
from roaml.roles import SymbolKind
from roaml.text import Span, apply_edits

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "spec" / "parameters.md").read_text(encoding="utf-8")
FILES = dict(re.findall(r"^\*\*`(\S+)`\*\*\n\n```xml\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL))
"""The files of the example in the definition."""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


def jani(path: Path, **values: object) -> str:
    overrides = api.Overrides(values=tuple((name.replace("__", "."), str(value)) for name, value in values.items()))
    return "".join(write(api.to_jani(api.load(str(path), overrides=overrides))))


def test_the_expanded_files_have_the_same_translation(folder: Path, tmp_path: Path) -> None:
    values = ("--set", "capacity=80", "--set", "right.period=0.25")
    assert run(["translate", str(folder / "main.xml"), "--expand", str(tmp_path / "plain"), *values]) == 0
    plain = tmp_path / "plain"
    assert sorted(path.name for path in plain.iterdir()) == [
        "left.ascxml",
        "main.xml",
        "monitor.ascxml",
        "properties.xml",
        "right.ascxml",
        "second.ascxml",
    ]
    for path in plain.iterdir():
        text = path.read_text(encoding="utf-8")
        assert not re.search(r"capacity\b(?!\")|period|loss|<param |<remap|namespace=|\$\(var", text), text
    assert jani(plain / "main.xml") == jani(folder / "main.xml", capacity=80, right__period=0.25)
    # The written files may be written again.
    assert run(["translate", str(folder / "main.xml"), "--expand", str(plain), *values]) == 0


def test_an_instance_keeps_handles_that_are_names_of_interfaces(folder: Path) -> None:
    """Without `name`, the handle of an interface is its name, which the namespace of an instance changes."""
    named = jani(folder / "main.xml")
    for file in ("battery.ascxml", "monitor.ascxml"):
        text = (folder / file).read_text()
        assert 'name="level" topic="level"' in text
        (folder / file).write_text(text.replace('name="level" topic="level"', 'topic="level"'))
    assert jani(folder / "main.xml") == named


def test_names_of_the_node_without_a_namespace(folder: Path) -> None:
    """Instances with names do not share `~/level`, as in ROS 2. A file without a name keeps it as it is written."""
    main, battery = folder / "main.xml", folder / "battery.ascxml"
    main.write_text(main.read_text().replace(' namespace="left"', "").replace(' namespace="right"', ""))
    battery.write_text(battery.read_text().replace('topic="level"', 'topic="~/level"'))
    monitor = folder / "monitor.ascxml"
    monitor.write_text(monitor.read_text().replace('topic="level"', 'topic="~/level"'))
    main.write_text(main.read_text().replace('from="level"', 'from="~/level"'))
    system = jani(main)
    assert "topic_left__level_msg" in system
    assert "topic_right__level_msg" in system
    assert "~" not in system


def test_values_in_python(folder: Path) -> None:
    system = api.load(str(folder / "main.xml"), parameters={"capacity": 80, "loss": 0.25, "left.period": 2})
    assert system.parameters == {"capacity": "80", "loss": "0.25", "left.period": "2"}
    assert "".join(write(api.to_jani(system))) == jani(folder / "main.xml", capacity=80, loss="1 / 4", left__period=2)
    with pytest.raises(api.ParameterError, match="no parameter `los`; did you mean `loss`"):
        api.load(str(folder / "main.xml"), parameters={"los": 1})


def test_values_from_outside_replace_those_of_the_files(folder: Path) -> None:
    default = jani(folder / "main.xml")
    assert default == jani(folder / "main.xml", capacity=100, left__period=0.5, right__period=1)
    assert default != jani(folder / "main.xml", capacity=90)
    assert default != jani(folder / "main.xml", left__period=1)
    (folder / "as2fm.toml").write_text("[parameters]\ncapacity = 90\n[parameters.left]\nperiod = 1\n")
    assert jani(folder / "main.xml") != default
    assert jani(folder / "main.xml", capacity=100, left__period=0.5) == default


@pytest.mark.parametrize("command", ["verify", "simulate", "translate", "check"])
def test_an_unknown_parameter_is_a_usage_error(command: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run([command, str(folder / "main.xml"), "--set", "capactiy=80"]) == 2
    assert "no parameter `capactiy`; did you mean `capacity`?" in capsys.readouterr().err


def test_a_parameter_of_a_property_file_has_no_name_outside_of_it(folder: Path) -> None:
    file = folder / "properties.xml"
    file.write_text(file.read_text().replace("<ports>", '<parameter name="bed" type="int32" value="1" /><ports>'))
    with pytest.raises(api.ParameterError) as error:
        api.load(str(folder / "main.xml"), parameters={"bed": 1})
    assert str(error.value).endswith("it declares `capacity`, `left.period`, `loss` and `right.period`")


def test_a_value_out_of_range_is_an_error_of_the_declaration(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["check", str(folder / "main.xml"), "--set", "capacity=250"]) == 1
    out = capsys.readouterr().out
    assert "main.xml:3:26: error: the value 250 that `--set` or a setting gives for the parameter `capacity`" in out
    assert out.count("error:") == 1


def test_findings_are_at_the_places_in_the_files(folder: Path) -> None:
    battery = folder / "battery.ascxml"
    text = battery.read_text().replace("level - capacity / 10", "level - capacity / 10 + nothing")
    battery.write_text(text)
    found = [d for d in api.check([str(folder / "main.xml")]).diagnostics if d.severity is Severity.ERROR]
    assert [(d.path, text[d.span.start : d.span.end]) for d in found] == [(str(battery), "nothing")]


def test_origins_are_places_in_the_files(folder: Path) -> None:
    system = api.load(str(folder / "main.xml"))
    places = api.source_map(system, api.to_jani(system))
    automata = {entry["name"]: entry for entry in places["automata"]}
    for name in ("left", "right"):
        assert automata[name]["file"] == "battery.ascxml"
        lines = (folder / "battery.ascxml").read_text().splitlines()
        level = next(v for v in automata[name]["variables"] if v["name"].endswith("level"))
        assert '<data id="level"' in lines[level["line"] - 1]
        assert any("<ros_rate_callback" in lines[edge["line"] - 1] for edge in automata[name]["edges"])


def snapshot(folder: Path) -> Snapshot:
    return api.check([str(folder / "main.xml")]).snapshot


def test_names_of_parameters_are_found_in_all_files(folder: Path) -> None:
    analysis = snapshot(folder).analysis
    text = (folder / "monitor.ascxml").read_text()
    group = symbol_group_at(analysis, str(folder / "monitor.ascxml"), text.index("capacity") + 2)
    assert group is not None
    counts = {name: FILES[name].count("capacity") for name in FILES}
    counts["properties.xml"] -= 1  # the name of a property contains the word
    found = [Path(use.path).name for use in group.uses]
    assert {name: found.count(name) for name in set(found)} == {name: n for name, n in counts.items() if n}
    assert [Path(place.path).name for place in group.definitions] == ["main.xml"]
    assert [symbol.kind for symbol in group.symbols] == [SymbolKind.MODEL_PARAMETER]
    assert "capacity : uint8 = 100" in describe(analysis, group.symbols[0])


def test_a_parameter_is_hovered_where_it_is_used(folder: Path) -> None:
    analysis = snapshot(folder).analysis
    for name, text in FILES.items():
        for match in re.finditer(r"\bcapacity\b", text):
            shown = hover(analysis, str(folder / name), match.start() + 1)
            assert shown is not None
            assert "capacity : uint8 = 100" in shown.text
            assert "unknown" not in shown.text
            assert "No port" not in shown.text


def test_a_misspelled_parameter_is_corrected(folder: Path) -> None:
    path = folder / "battery.ascxml"
    path.write_text(FILES["battery.ascxml"].replace("- capacity / 10", "- capactiy / 10"))
    result = api.check([str(folder / "main.xml")])
    (finding,) = [d for d in result.diagnostics if d.severity is Severity.ERROR]
    assert finding.code == "undeclared-variable"
    assert "did you mean the parameter `capacity`?" in finding.message
    (fix,) = [fix for fix in finding.fixes if "capacity" in fix.title]
    assert apply_edits(path.read_text(), fix.edits) == FILES["battery.ascxml"]


def test_a_parameter_is_renamed_in_all_files(folder: Path) -> None:
    before = jani(folder / "main.xml")
    current = snapshot(folder)
    path = str(folder / "battery.ascxml")
    offset = FILES["battery.ascxml"].index('"period"') + 1
    renaming = rename(current.analysis, path, offset, "interval")
    assert isinstance(renaming, Renaming), renaming
    for changed, edits in renaming.edits.items():
        file = Path(changed)
        file.write_text(apply_edits(file.read_text(), tuple(edits)))
    assert "period" not in "".join(file.read_text() for file in folder.glob("*.*xml"))
    assert jani(folder / "main.xml") == before


@pytest.mark.parametrize(
    ("file", "before", "typed", "expected"),
    [
        ("battery.ascxml", 'expr="', "", {"capacity", "loss", "period"}),
        ("battery.ascxml", 'rate_hz="', "", {"capacity", "loss", "period"}),
        ("battery.ascxml", 'prob="', "", {"capacity", "loss", "period"}),
        ("battery.ascxml", 'topic="', "$(var ca", {"capacity", "loss", "period"}),
        ("monitor.ascxml", 'cond="', "", {"capacity", "loss"}),
        ("main.xml", '<param name="', "", {"period"}),
        ("properties.xml", "<event>", "", {"capacity", "loss"}),
    ],
)
def test_parameters_are_completed(file: str, before: str, typed: str, expected: set[str], folder: Path) -> None:
    text = FILES[file]
    at = text.index(before) + len(before)
    (folder / file).write_text(text[:at] + typed + text[at:])
    found = complete(snapshot(folder), str(folder / file), at + len(typed))
    assert found is not None
    assert {item.label for item in found.items if item.detail.startswith("parameter: ")} == expected


@pytest.mark.parametrize(
    ("file", "before", "name", "line"),
    [
        ("nodes/battery.ascxml", 'id="level" type="uint8" expr="', "initial_level", "initial_level"),
        ("nodes/battery.ascxml", 'name="second" rate_hz="', "rate", 'rate_hz="rate"'),
        ("nodes/battery.ascxml", "Math.max(level - ", "parameter", "Math.max(level - parameter, 0)"),
        ("tree.xml", 'level="', "level_2", 'level="$(var level_2)"'),
        ("properties.xml", "battery &lt;= ", "parameter", "battery &lt;= parameter</event>"),
    ],
)
def test_a_number_becomes_a_parameter(file: str, before: str, name: str, line: str, tmp_path: Path) -> None:
    shutil.copytree(ROOT / "examples" / "delivery_robot", tmp_path / "robot")
    main, path = tmp_path / "robot" / "main.xml", tmp_path / "robot" / file
    before_jani = jani(main)
    place = path.read_text().index(before) + len(before)
    current = api.check([str(main)]).snapshot
    found = list(new_parameter.actions(current.analysis, str(path), Span(place, place)))
    assert [f"`{name}`" in action.title for action in found] == [True]
    for changed, edits in found[0].make().edits.items():
        edited = Path(changed)
        edited.write_text(apply_edits(edited.read_text(), tuple(edits)))
    assert line in path.read_text()
    # The initial value of a variable has its type, so that an experiment proposes no value that is too large for it.
    type_ = {"initial_level": "uint8", "rate": "float64"}.get(name, "int32")
    assert f'<parameter name="{name}" type="{type_}"' in main.read_text()
    assert not [d for d in api.check([str(main)]).diagnostics if d.severity >= Severity.WARNING]
    assert jani(main) == before_jani


def test_an_instance_is_a_definition(folder: Path) -> None:
    analysis = snapshot(folder).analysis
    symbol = Symbol(str(folder / "battery.ascxml"), SymbolKind.MACHINE, "left")
    places = symbol_group(analysis, (symbol,)).definitions
    assert [Path(place.path).name for place in places] == ["main.xml"]
    system = analysis.system(str(folder / "main.xml"))
    assert system is not None
    assert [automaton.name for automaton in system.automata] == ["left", "right", "Monitor", "second"]
    assert {Path(automaton.path).name for automaton in system.automata} == {"battery.ascxml", "monitor.ascxml"}
    assert sorted(system.topics) == ["left__level", "right__level"]


def test_an_instance_is_renamed_with_its_references(folder: Path) -> None:
    properties = folder / "properties.xml"
    properties.write_text(FILES["properties.xml"].replace('event="publish">', 'event="publish" origin="left">'))
    analysis = snapshot(folder).analysis
    offset = properties.read_text().index('origin="left"') + 9
    renaming = rename(analysis, str(properties), offset, "port")
    assert isinstance(renaming, Renaming), renaming
    for changed, edits in renaming.edits.items():
        file = Path(changed)
        file.write_text(apply_edits(file.read_text(), tuple(edits)))
    assert 'name="port" namespace="left"' in (folder / "main.xml").read_text()
    assert 'origin="port"' in properties.read_text()
    assert not [d for d in api.check([str(folder / "main.xml")]).diagnostics if d.severity >= Severity.WARNING]


def test_a_name_that_instances_change_is_not_renamed(folder: Path) -> None:
    offset = FILES["battery.ascxml"].index('topic="level"') + 8
    refusal = rename(snapshot(folder).analysis, str(folder / "battery.ascxml"), offset, "charge")
    assert isinstance(refusal, RenameRefusal)
    assert "instances of its machine have other names" in refusal.reason


def test_a_machine_alone_has_its_own_values(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "lamp.ascxml").write_text(
        """<ascxml name="Lamp" version="1.0" initial="off">
    <parameter name="n" type="int32" value="3" />
    <datamodel><data id="levels" type="int32[n + 1]" expr="[n, -n]" /></datamodel>
    <ros_time_rate name="blink" rate_hz="1 / n" />
    <state id="off">
        <ros_rate_callback name="blink" target="off"><assign location="levels[n]" expr="-n" /></ros_rate_callback>
    </state>
</ascxml>
"""
    )
    assert run(["check", str(tmp_path / "lamp.ascxml"), "--warnings-as-errors"]) == 0, capsys.readouterr().out


def test_a_warning_that_depends_on_a_value_is_left_out(tmp_path: Path) -> None:
    lamp = """<ascxml name="Lamp" version="1.0" initial="off">
    <parameter name="n" type="int32" value="{value}" min="0" />
    <ros_time_rate name="blink" rate_hz="1" />
    <state id="off">
        <ros_rate_callback name="blink" cond="n &gt; 2" target="off" />
        <ros_rate_callback name="blink" cond="{second}" target="off" />
    </state>
</ascxml>
"""
    path = tmp_path / "lamp.ascxml"

    def codes(value: int, second: str) -> set[str]:
        path.write_text(lamp.format(value=value, second=second))
        return {d.code for d in api.check([str(path)]).diagnostics if d.severity >= Severity.WARNING}

    assert codes(2, "n &gt; 1") == set()
    assert codes(4, "n &gt; 2") == {"shadowed-transition"}  # with the value 5 as well


ROS_FILE = """
/**:
  ros__parameters:
    capacity: 80
    use_sim_time: true
/left:
  left:
    ros__parameters: {period: 0.25}
/right/right:
  ros__parameters:
    period: 2
"""


def test_values_from_a_parameter_file_of_ros(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "robot.yaml").write_text(ROS_FILE)
    main, file = str(folder / "main.xml"), str(folder / "robot.yaml")
    assert run(["translate", main, "--params-file", file, "--set", "right.period=1"]) == 0
    assert (folder / "main.jani").read_text().rstrip("\n") == jani(
        folder / "main.xml", capacity=80, left__period=0.25, right__period=1
    )
    assert run(["check", main, "--params-file", file]) == 0
    (folder / "robot.yaml").write_text("capacity: 80")
    for command in ("check", "verify", "translate", "simulate"):
        capsys.readouterr()
        assert run([command, main, "--params-file", file]) == 2
        assert "not a parameter file of ROS 2: no node has `ros__parameters`" in capsys.readouterr().err


TREE_SYSTEM = """<roaml>
    <parameter_declarations>
        <parameter name="grasps" type="float64" value="0.25" min="0" max="1" />
        <parameter name="tries" type="int32" value="1" />
    </parameter_declarations>
    <parameters><max_time value="20" unit="s" /></parameters>
    <behavior_tree><input type="bt.cpp-xml" src="tree.xml" /></behavior_tree>
    <properties><input type="jani" src="properties.jani" /></properties>
</roaml>
"""
TREE = """<root BTCPP_format="4">
    <BehaviorTree ID="Main">
        <RetryUntilSuccessful num_attempts="$(var tries)"><Grasp /></RetryUntilSuccessful>
    </BehaviorTree>
</root>
"""


def test_mocks_and_trees_use_parameters(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The probability that one of n tries succeeds is 1 - (1 - p)^n."""
    done = {"op": "=", "left": "bt_1000_response__status", "right": 1}
    done = {"op": "∧", "left": "bt_1000_response.valid", "right": done}
    value = {"op": "filter", "fun": "values", "values": {"op": "Pmin", "exp": {"op": "F", "exp": done}}}
    value["states"] = {"op": "initial"}
    properties = {"properties": [{"name": "done", "expression": value}]}
    for name, text in (("main.xml", TREE_SYSTEM), ("tree.xml", TREE), ("properties.jani", json.dumps(properties))):
        (tmp_path / name).write_text(text, encoding="utf-8")
    command = ["verify", str(tmp_path / "main.xml"), "--mock", "Grasp: $(var grasps)", "--exhaustive"]
    for values, expected in (
        ([], 0.25),
        (["--set", "grasps=0.5"], 0.5),
        (["--set", "grasps=0.5", "--set", "tries=3"], 0.875),
    ):
        capsys.readouterr()
        assert run([*command, "--format", "json", *values]) in (0, 1)
        written = json.loads(capsys.readouterr().out)
        (result,) = written["results"]
        assert result["exact"]["least"] == pytest.approx(expected, abs=1e-6)
        assert written["parameters"]["grasps"] == str(0.5 if values else 0.25)
    assert run(["verify", str(tmp_path / "main.xml"), "--mock", "Grasp: $(var grsps)"]) == 2
    assert "there is no parameter `grsps`; did you mean `grasps`?" in capsys.readouterr().err


# ------------------------------------------------------------- probabilities of 0 and 1

LOSS = ('prob="loss"', 'prob="1 - loss"')
"""The probabilities of the example: a message is lost, or it is not."""


@pytest.mark.parametrize(("loss", "left"), [("0", 1), ("1", 0)])
@pytest.mark.parametrize("has_rest", [False, True])
def test_a_probability_can_be_0_or_1(loss: str, left: int, has_rest: bool, folder: Path, tmp_path: Path) -> None:
    """The other target is never chosen. The translation has no destination for it, and the expanded files lack it."""
    main, battery = folder / "main.xml", folder / "battery.ascxml"
    if has_rest:
        battery.write_text(battery.read_text(encoding="utf-8").replace(f" {LOSS[1]}", ""), encoding="utf-8")
    assert {0.1, 0.9} < set(_destinations(jani(main)))
    assert set(_destinations(jani(main, loss=loss))) == {1.0}
    plain = tmp_path / "plain"
    assert (
        run(["translate", str(main), "--set", f"loss={loss}", "--expand", str(plain), "-o", str(tmp_path / "x")]) == 0
    )
    for name in ("left", "right"):
        text = (plain / f"{name}.ascxml").read_text(encoding="utf-8")
        assert (text.count("<target "), text.count("<ros_topic_publish ")) == (1, left)
    if left:  # otherwise nothing publishes the topic in the expanded files, which is an error
        assert jani(plain / "main.xml") == jani(main, loss=loss)


def _destinations(text: str) -> list[float]:
    """The probabilities of the destinations of the machine `left`."""
    (automaton,) = (a for a in json.loads(text)["automata"] if a["name"] == "left")
    destinations = [d for edge in automaton["edges"] for d in edge["destinations"]]
    return [d.get("probability", {"exp": 1.0})["exp"] for d in destinations]


@pytest.mark.parametrize("written", [0, 1])
def test_a_written_probability_of_0_is_a_mistake(written: int, folder: Path) -> None:
    battery = folder / "battery.ascxml"
    text = battery.read_text(encoding="utf-8").replace(LOSS[written], 'prob="0"').replace(LOSS[1 - written], 'prob="1"')
    battery.write_text(text, encoding="utf-8")
    found = [d.code for d in api.check([str(folder / "main.xml")]).diagnostics if d.severity is Severity.ERROR]
    assert found == ["invalid-value"]


def test_other_numbers_of_parameters_are_checked(folder: Path) -> None:
    """A rate of 0, and probabilities that do not add up to 1, stay mistakes."""
    main, battery = folder / "main.xml", folder / "battery.ascxml"
    text = battery.read_text(encoding="utf-8")
    for changed, code in (
        (text.replace("1 / period", "period - period"), "invalid-rate"),
        (text.replace("1 - loss", "0.5 - loss").replace('"loss"', '"loss - loss"'), "probability-sum"),
    ):
        battery.write_text(changed, encoding="utf-8")
        errors = {d.code for d in api.check([str(main)]).diagnostics if d.severity is Severity.ERROR}
        assert code in errors


def test_written_files_are_utf_8_and_find_each_other(folder: Path, tmp_path: Path) -> None:
    """The system is in Latin-1, and the path of one of its files leads through folders that contain no other file."""
    inner = folder / "robots" / "höhle"
    inner.mkdir(parents=True)
    for file in ("battery.ascxml", "monitor.ascxml", "properties.xml"):
        (folder / file).rename(inner / file)
    (folder / "main.xml").rename(inner / "main.xml")
    main = (inner / "main.xml").read_text().replace('src="monitor', 'src="../../robots/höhle/monitor')
    (inner / "main.xml").write_text(f'<?xml version="1.0" encoding="iso-8859-1"?>\n{main}', encoding="latin-1")
    assert run(["translate", str(inner / "main.xml"), "--expand", str(tmp_path / "plain"), "-o", "-"]) == 0
    written = tmp_path / "plain" / "robots" / "höhle" / "main.xml"
    assert written.read_text(encoding="utf-8").startswith('<?xml version="1.0" encoding="UTF-8"?>')
    assert jani(written) == jani(inner / "main.xml")
