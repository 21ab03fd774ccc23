# SPDX-License-Identifier: Apache-2.0
"""Trees as public repositories contain them: of version 3, without names, with names that only old versions accept,
with nodes that have the names of Nav2's, and with paths of installed files."""

from __future__ import annotations

import json
from pathlib import Path
from xml.etree import ElementTree

import pytest

from as2fm_lsp.cli.main import run
from roaml import api

OLD = """<root main_tree_to_execute="Main">
<BehaviorTree ID="Main"><SequenceStar>
    <Parallel success_threshold="1" failure_threshold="2"><Never/><Always/></Parallel>
    <RetryUntilSuccesful num_attempts="3"><Always/></RetryUntilSuccesful>
    <SetBlackboard output_key="place" value="3"/>
    {subtree}
</SequenceStar></BehaviorTree>
<BehaviorTree ID="Sub">
    <BlackboardCheckInt value_A="{{here}}" value_B="3" return_on_mismatch="FAILURE"><Always/></BlackboardCheckInt>
</BehaviorTree></root>
"""
MOCKS = ("--mock", "Always: 1", "--mock", "Never: 0")


def found(folder: Path, files: dict[str, str]) -> list[tuple[str, str, str]]:
    """The severity, code and message of each finding."""
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    return [(d.severity.name, d.code, d.message) for d in api.check([str(folder)]).diagnostics]


def success(capsys: pytest.CaptureFixture[str], path: Path, *mocks: str) -> float:
    """The share of the traces in which a tree succeeds."""
    assert run(["verify", str(path), *mocks, "--max-traces", "20", "--format", "json"]) == 0, capsys.readouterr().err
    value = json.loads(capsys.readouterr().out)["tree"]["success"]["value"]
    assert isinstance(value, float)
    return value


@pytest.mark.parametrize(
    ("subtree", "expected"),
    [
        ('<SubTree ID="Sub" here="place"/>', 1.0),
        ('<SubTreePlus ID="Sub" here="{place}"/>', 1.0),
        ('<SubTreePlus ID="Sub" here="4"/>', 0.0),
    ],
)
def test_a_tree_of_version_3_is_executed_as_it_is_meant(
    subtree: str, expected: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "tree.xml"
    path.write_text(OLD.format(subtree=subtree))
    assert success(capsys, path, *MOCKS) == expected


@pytest.mark.parametrize(
    "node",
    [
        '<Parallel success_threshold="1"><A/><B/></Parallel>',
        '<Parallel failure_threshold="1"><A/><B/></Parallel>',
        "<SequenceStar><A/></SequenceStar>",
        '<RetryUntilSuccesful num_attempts="1"><A/></RetryUntilSuccesful>',
        '<BlackboardCheckInt value_A="1" value_B="1" return_on_mismatch="FAILURE"><A/></BlackboardCheckInt>',
        '<Decorator ID="RetryUntilSuccesful" num_attempts="1"><A/></Decorator>',
    ],
)
def test_a_file_of_version_3_need_not_state_it(node: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    findings = found(tmp_path, {"tree.xml": f'<root><BehaviorTree ID="Main">{node}</BehaviorTree></root>'})
    assert [(severity, code) for severity, code, _ in findings] == [("WARNING", "tree-format")]
    assert success(capsys, tmp_path / "tree.xml", "--mock", "*: 1") == 1.0


INCLUDING = """<root{form} main_tree_to_execute="Main"><include path="sub.xml"/>
<BehaviorTree ID="Main">{tree}</BehaviorTree></root>"""
INCLUDED = '<root{form}><BehaviorTree ID="Sub">{tree}</BehaviorTree></root>'
OLD_PART = '<RetryUntilSuccesful num_attempts="2"><Is here="{here}"/></RetryUntilSuccesful>'
CALL = '<Sequence><SetBlackboard output_key="place" value="3"/><SubTree ID="Sub" here="place"/></Sequence>'
MIXED = "no version reads both"


@pytest.mark.parametrize(
    ("main", "sub", "reported"),
    [
        (("", CALL), ("", OLD_PART), {"main.xml": "belongs to the same tree", "sub.xml": "is written for version 3"}),
        ((' BTCPP_format="3"', CALL), ("", "<A/>"), {"main.xml": "is written for", "sub.xml": "to the same tree"}),
        (("", CALL), (' BTCPP_format="3"', "<A/>"), {"main.xml": "to the same tree", "sub.xml": "is written for"}),
        ((' BTCPP_format="4"', CALL), ("", OLD_PART), {"sub.xml": MIXED}),
        ((' BTCPP_format="4"', CALL), (' BTCPP_format="3"', "<A/>"), {"sub.xml": MIXED}),
        (("", '<SubTree ID="Sub" _skipIf="false"/>'), ("", OLD_PART), {"main.xml": "is missing", "sub.xml": MIXED}),
        (("", CALL), ("", '<SequenceStar><A _skipIf="false"/></SequenceStar>'), {"main.xml": "same", "sub.xml": MIXED}),
        (("", CALL), (' BTCPP_format="4"', "<A/>"), {"main.xml": "is missing"}),
        (("", CALL), ("", "<A/>"), {"main.xml": "is missing", "sub.xml": "is missing"}),
    ],
)
def test_files_that_are_read_together_have_one_version(
    main: tuple[str, str], sub: tuple[str, str], reported: dict[str, str], tmp_path: Path
) -> None:
    """A program reads the files that include each other with one version, whichever of them shows it."""
    for name, form, (written, tree) in (("main.xml", INCLUDING, main), ("sub.xml", INCLUDED, sub)):
        (tmp_path / name).write_text(form.format(form=written, tree=tree))
    findings = [d for d in api.check([str(tmp_path)]).diagnostics if d.code == "tree-format"]
    assert {Path(d.path).name for d in findings} == {*reported}
    assert all(reported[Path(d.path).name] in d.message for d in findings), findings
    assert run(["verify", str(tmp_path / "main.xml"), "--mock", "*: 1", "--max-traces", "5"]) == 0


@pytest.mark.parametrize(("value", "expected"), [("3", 1.0), ("4", 0.0)])
def test_a_file_is_executed_in_the_version_of_its_tree(
    value: str, expected: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The value of the `SubTree` is the name of an entry, because the included file is of version 3."""
    part = f'<BlackboardCheckInt value_A="{{here}}" value_B="{value}" return_on_mismatch="FAILURE"><A/>'
    (tmp_path / "main.xml").write_text(INCLUDING.format(form="", tree=CALL))
    (tmp_path / "sub.xml").write_text(INCLUDED.format(form="", tree=f"{part}</BlackboardCheckInt>"))
    assert success(capsys, tmp_path / "main.xml", "--mock", "A: 1") == expected


@pytest.mark.parametrize(
    ("type_", "entry", "value", "is_equal"),
    [
        ("String", "own", "own", True),
        ("String", "own", "other", False),
        ("String", "own", "5", False),
        ("String", "5", "5", True),
        ("Double", "0.25", "0.25", True),
        ("Double", "0.25", "1", False),
        ("Bool", "true", "true", True),
        ("Bool", "true", "1", True),
        ("Bool", "true", "false", False),
    ],
)
def test_values_of_each_type_are_compared_in_version_3(
    type_: str, entry: str, value: str, is_equal: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Either port can be bound, and the child is ticked only if the values are equal."""
    ports = f'value_A="{{entry}}" value_B="{value}"', f'value_A="{value}" value_B="{{entry}}"'
    for number, given in enumerate(ports):
        node = f'<BlackboardCheck{type_} {given} return_on_mismatch="FAILURE"><A/></BlackboardCheck{type_}>'
        tree = f'<Sequence><SetBlackboard output_key="entry" value="{entry}"/>{node}</Sequence>'
        path = tmp_path / f"tree{number}.xml"
        path.write_text(f'<root BTCPP_format="3"><BehaviorTree ID="Main">{tree}</BehaviorTree></root>')
        assert success(capsys, path, "--mock", "A: 1") == is_equal


@pytest.mark.parametrize(
    ("node", "is_refused"),
    [
        ("<RoundRobin><A/><B/></RoundRobin>", False),
        ("<PipelineSequence><A/><B/></PipelineSequence>", False),
        ('<Control ID="RoundRobin" name="try"><A/><B/></Control>', False),
        ('<RateController hz="2"><A/></RateController>', False),
        ('<RoundRobin order="random"><A/><B/></RoundRobin>', True),
        ("<Shuffle><A/><B/></Shuffle>", True),
        ('<Wait seconds="2"/>', False),
        ('<Wait wait_duration="2"/>', False),
    ],
)
def test_a_tree_with_one_node_of_nav2(
    node: str, is_refused: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """All commands recognise a node of Nav2 with children, because a program seldom has an own one of this name."""
    tree = f'<root BTCPP_format="4"><BehaviorTree ID="Main">{node}</BehaviorTree></root>'
    assert not [text for _, _, text in found(tmp_path, {"tree.xml": tree}) if "`A`" not in text and "`B`" not in text]
    for command in ("verify", "simulate"):
        assert run([command, str(tmp_path / "tree.xml"), "--mock", "*: 1"]) == (2 if is_refused else 0), command
    assert ("no library describes these nodes" in capsys.readouterr().err) is is_refused


def test_the_only_tree_of_a_file_needs_no_name(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    tree = '<root BTCPP_format="4"><BehaviorTree><Sequence><A/><B/></Sequence></BehaviorTree></root>'
    assert found(tmp_path, {"tree.xml": tree}) == []
    assert success(capsys, tmp_path / "tree.xml", "--mock", "*: 1") == 1.0
    assert success(capsys, tmp_path / "tree.xml", "--mock", "A: 1", "--mock", "B: 0") == 0.0


@pytest.mark.parametrize(
    ("script", "message"),
    [
        ("way := way + 1", "`+` needs numbers, but the port `value` of `LoopString` makes `way` a string"),
        ("x := -way", "`-` needs numbers, but the port `value` of `LoopString` makes `way` a string"),
        ("x := 'a'; y := x + 1", "`+` cannot join a string and a number; use `..`"),
        ("x := 'a' + 1; y := way .. 1", "`+` cannot join a string and a number; use `..`"),
    ],
)
def test_a_number_that_a_port_makes_a_string(script: str, message: str, tmp_path: Path) -> None:
    loop = '<LoopString queue="1;2" value="{way}"><A/></LoopString>'
    tree = f'<BehaviorTree ID="Main"><Sequence>{loop}<Script code="{script}"/></Sequence></BehaviorTree>'
    findings = found(tmp_path, {"tree.xml": f'<root BTCPP_format="4">{tree}</root>'})
    (error,) = [text for _, code, text in findings if code == "script-type"]
    assert error.startswith(message)


def test_names_that_only_newer_versions_refuse_are_a_warning(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    trees = (
        '<root BTCPP_format="4" main_tree_to_execute="Main Tree">'
        '<BehaviorTree ID="Main Tree"><Sequence><A/><SubTree ID="Go home" name="x"/></Sequence></BehaviorTree>'
        '<BehaviorTree ID="Go home"><B/></BehaviorTree></root>'
    )
    findings = found(tmp_path, {"tree.xml": trees})
    assert [(severity, code) for severity, code, _ in findings] == [("WARNING", "tree-name")] * 2
    assert success(capsys, tmp_path / "tree.xml", "--mock", "*: 1") == 1.0
    stated = found(tmp_path, {"as2fm.toml": 'behaviortree-cpp = "4.8.4"'})
    assert [(severity, code) for severity, code, _ in stated] == [("ERROR", "tree-name")] * 2
    assert found(tmp_path, {"as2fm.toml": 'behaviortree-cpp = "4.8.3"'}) == []


NAV2_TREE = """<root BTCPP_format="4" main_tree_to_execute="Main"><BehaviorTree ID="Main">
<RecoveryNode number_of_retries="1"><ComputePathToPose goal="{goal}" path="{path}"/>BACKUP</RecoveryNode>
</BehaviorTree>MODELS</root>
"""
OWN_MODEL = '<TreeNodesModel><Action ID="BackUp"><input_port name="meters"/></Action></TreeNodesModel>'


@pytest.mark.parametrize(
    ("backup", "own", "beside", "expected"),
    [
        ('<BackUp backup_dist="0.1"/>', "", "", []),
        ('<BackUp backup_dst="0.1"/>', "", "", ["unknown-port"]),
        ('<BackUp backup_dist="0.1" meters="1"/>', "", "", ["unknown-port"]),
        ('<BackUp meters="a few"/>', "", "", ["unknown-node"]),
        ('<BackUp meters="a few"/>', OWN_MODEL, "", []),
        ('<BackUp meters="a few"/>', "", OWN_MODEL, ["unknown-node"]),
        ('<BackUp backup_dist="0.1" meters="1"/>', "", OWN_MODEL, ["unknown-node"]),
    ],
)
def test_an_own_node_with_the_name_of_a_node_of_nav2(
    backup: str, own: str, beside: str, expected: list[str], tmp_path: Path
) -> None:
    """A node that no model of the file describes is only stated (`unknown-node`, information)."""
    files = {"tree.xml": NAV2_TREE.replace("BACKUP", backup).replace("MODELS", own)}
    if beside:
        files["models.xml"] = f'<root BTCPP_format="4">{beside}</root>'
    findings = found(tmp_path, files)
    assert [code for _, code, _ in findings] == expected
    assert all(severity == "INFORMATION" for severity, code, _ in findings if code == "unknown-node")
    if expected == ["unknown-node"]:
        named = found(tmp_path, {"as2fm.toml": 'tree-libraries = ["nav2"]'})
        assert {code for _, code, _ in named} == {"unknown-port"}


@pytest.mark.parametrize(
    ("path", "place", "seen"),
    [
        ("share/robot/trees/sub.xml", "trees/sub.xml", "trees/sub.xml"),
        ("share/robot/trees/sub.xml", "sub.xml", "sub.xml"),
        ("/opt/robot/share/robot/trees/sub.xml", "robot/trees/sub.xml", "robot/trees/sub.xml"),
        ("trees/sub.xml", "sub.xml", "sub.xml"),
        ("../../install/trees/sub.xml", "trees/sub.xml", "trees/sub.xml"),
    ],
)
def test_an_included_file_is_found_beside_the_file(path: str, place: str, seen: str, tmp_path: Path) -> None:
    include = f'<include path="{path}"/><BehaviorTree ID="Main"><SubTree ID="Sub"/></BehaviorTree>'
    main = f'<root BTCPP_format="4" main_tree_to_execute="Main">{include}</root>'
    sub = '<root BTCPP_format="4"><BehaviorTree ID="Sub"><A/></BehaviorTree></root>'
    findings = found(tmp_path, {"main.xml": main, place: sub})
    message = f"there is no file `{path}` in the sources; `{seen}` is read instead"
    assert findings == [("INFORMATION", "missing-include", message)]
    (tmp_path / place).unlink()
    ((severity, code, message),) = found(tmp_path, {})
    assert (severity, code) == ("ERROR", "missing-include")
    assert f"`{seen}`" in message


def test_a_path_with_share_leads_to_the_folder_of_the_package(tmp_path: Path) -> None:
    include = '<include path="/opt/ros/share/robot/trees/sub.xml"/>'
    main = f'<root BTCPP_format="4">{include}<BehaviorTree ID="Main"><SubTree ID="Sub"/></BehaviorTree></root>'
    files = {
        "src/robot/package.xml": "<package><name>robot</name></package>",
        "src/robot/trees/sub.xml": '<root BTCPP_format="4"><BehaviorTree ID="Sub"><A/></BehaviorTree></root>',
        "src/app/behaviors/main.xml": main,
    }
    findings = found(tmp_path, files)
    assert [code for _, code, _ in findings] == ["missing-include"]
    assert "`../../robot/trees/sub.xml` is read instead" in findings[0][2]


TREE = '<BehaviorTree ID="Main">{}</BehaviorTree>'
ESCAPE = chr(27)


@pytest.mark.parametrize(
    ("before", "attribute", "inside"),
    [
        ("", "", "<!-- ------ trees ------ -->"),
        ("", "", "<!------ trees ------>"),
        ("", "", "<!-- trees --->"),
        ('\n \n<?xml version="1.0"?>\n', "", ""),
        ("", 'name="x"', ""),
        ("", ' name="&nbsp;a"', ""),
        ("", ' name="a & b <c"', ""),
        ("", f' name="a{ESCAPE}[0m"', ""),
        ("", "", '<A _description="a && b << c"/>' * 60),
    ],
)
def test_xml_that_only_the_parser_of_the_library_accepts(
    before: str, attribute: str, inside: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    content = f"<Sequence>{inside}<A/><B/></Sequence>"
    text = f'{before}<root BTCPP_format="4"{attribute}>{TREE.format(content)}</root>'
    assert {severity for severity, code, _ in found(tmp_path, {"tree.xml": text}) if "unknown" not in code} == {
        "WARNING"
    }
    path = tmp_path / "tree.xml"
    assert success(capsys, path, "--mock", "*: 1") == 1.0
    assert run(["format", str(path)]) == 0
    assert {finding[0] for finding in found(tmp_path, {}) if "unknown" not in finding[1]} <= {"WARNING"}
    assert run(["--check", "--fix", str(path)]) == 0
    if "nbsp" not in text and ESCAPE not in text:  # these need a decision
        ElementTree.fromstring(path.read_bytes())
    capsys.readouterr()
    library = pytest.importorskip("behaviortreepy")
    for version in (text, path.read_text(encoding="utf-8")):
        factory = library.BehaviorTreeFactory()
        for node in "AB":
            factory.register_simple_action(node, lambda *_: library.NodeStatus.SUCCESS)
        factory.create_tree_from_text(version)


def test_the_same_xml_is_an_error_in_a_machine(tmp_path: Path) -> None:
    machine = '<ascxml name="Fan" version="1.0" initial="off"><!-- a -- b --><state id="off"/></ascxml>'
    findings = found(tmp_path, {"fan.ascxml": machine})
    assert ("ERROR", "xml-syntax", "`--` is not allowed inside a comment") in findings


def test_a_tree_that_is_never_created_may_contain_itself(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    recursive = '<BehaviorTree ID="Other"><Fallback><A/><SubTree ID="Other"/></Fallback></BehaviorTree>'
    head = '<root BTCPP_format="4" main_tree_to_execute="{}">'
    text = f"{head.format('Main')}{TREE.format('<A/>')}{recursive}</root>"
    findings = found(tmp_path, {"tree.xml": text})
    assert ("WARNING", "tree-structure", "a tree cannot contain itself: Other → Other") in findings
    assert success(capsys, tmp_path / "tree.xml", "--mock", "*: 1") == 1.0
    executed = f"{head.format('Other')}{TREE.format('<A/>')}{recursive}</root>"
    assert "ERROR" in {severity for severity, code, _ in found(tmp_path, {"tree.xml": executed})}


@pytest.mark.parametrize("name", ["QueueSize", "PopFromQueue"])
def test_a_class_template_that_programs_register(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    node = f'<{name} queue="{{q}}"/>'
    text = f'<root BTCPP_format="4">{TREE.format(node)}</root>'
    findings = found(tmp_path, {"tree.xml": text})
    assert {severity for severity, _, _ in findings} <= {"INFORMATION"}
    assert success(capsys, tmp_path / "tree.xml", "--mock", "*: 1") == 1.0
