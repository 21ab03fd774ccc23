# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp translate MAIN.xml`"""

from __future__ import annotations

import contextlib
import itertools
import json
import os
import pty
import subprocess
import sys
from pathlib import Path

import pytest
from command import Command
from lxml import etree

import as2fm_lsp.cli.status_line
import as2fm_lsp.cli.translate
from as2fm_lsp.cli.output import Verbosity, set_verbosity
from roaml import api
from roaml.jani.reader import read_model
from roaml.json_syntax import parse
from roaml.language.resources import schema_path
from roaml.scxml.names import TRANSLATION_MARK

SCXML = "{http://www.w3.org/2005/07/scxml}"


@pytest.fixture
def robot(command: Command, tmp_path: Path) -> Path:
    """A small system, the working directory of the command."""
    command("init", ".")
    return tmp_path


def test_writes_beside_the_system_file(command: Command, robot: Path) -> None:
    done = command("translate", "main.xml")
    assert (done.status, done.err) == (0, "")
    text = (robot / "main.jani").read_text(encoding="utf-8")
    value, findings = parse(text)
    model, notes = read_model(value)
    assert (findings, notes) == ((), ())
    assert model is not None
    edges = sum(len(automaton.edges) for automaton in model.automata)
    assert done.out == (
        f"main.jani: {len(model.automata)} automata, {edges} edges, {len(model.variables)} global variables, "
        f"{len(model.properties)} properties\n"
    )
    assert text.count("\n") == 1


def test_standard_output(command: Command, robot: Path) -> None:
    command("translate", "main.xml")
    done = command("translate", "main.xml", "-o", "-")
    assert (done.status, done.err) == (0, "")
    assert done.out == (robot / "main.jani").read_text(encoding="utf-8")


def test_layout_for_people(command: Command, robot: Path) -> None:
    compact = command("translate", "main.xml", "-o", "-").out
    wide = command("translate", "main.xml", "-o", "-", "--indent", "2").out
    assert json.loads(wide) == json.loads(compact)
    assert wide.splitlines()[:2] == ["{", '  "jani-version": 1,']


@pytest.mark.parametrize("form", ["text", "json"])
def test_errors_are_those_of_the_check(command: Command, robot: Path, form: str) -> None:
    battery = robot / "nodes" / "battery.ascxml"
    battery.write_text(battery.read_text().replace('location="level"', 'location="lewel"'))
    (robot / "main.jani").write_text("mine")
    checked = command("--check", "main.xml", "--format", form, "--severity", "error")
    done = command("translate", "main.xml", "--format", form, "--scxml-dir", "scxml", "--map", "map.json")
    assert done.status == 1
    if form == "json":
        assert (done.out, done.err) == (checked.out, "")
        assert done.codes == ["undeclared-variable"] * 2
    else:
        assert (done.out, done.err) == ("", f"{checked.out}as2fm-lsp: main.jani was not written\n")
    assert (robot / "main.jani").read_text() == "mine"
    assert not (robot / "scxml").exists()
    assert not (robot / "map.json").exists()


def test_an_ignored_error_prevents_the_translation(command: Command, robot: Path) -> None:
    battery = robot / "nodes" / "battery.ascxml"
    battery.write_text(battery.read_text().replace('location="level"', 'location="lewel"'))
    (robot / "as2fm.toml").write_text('ignore = ["undeclared-variable"]')
    assert command("--check", "main.xml").status == 0
    done = command("translate", "main.xml", "--format", "json")
    assert (done.status, set(done.codes)) == (1, {"undeclared-variable"})


def test_warnings_do_not_matter(command: Command, robot: Path) -> None:
    main = robot / "main.xml"
    main.write_text(main.read_text().replace("roaml>", "convince_mc_tc>").replace("parameters>", "mc_parameters>"))
    (robot / "as2fm.toml").write_text('severity = { deprecated-spelling = "error" }')
    assert command("--check", "main.xml").status == 1
    assert command("translate", "main.xml").status == 0


def test_properties_by_name(command: Command, robot: Path) -> None:
    names = [p["name"] for p in json.loads(command("translate", "main.xml", "-o", "-").out)["properties"]]
    assert len(names) == 4
    for name in names:  # two are of the file in JANI, two of the file in XML
        one = json.loads(command("translate", "main.xml", "-o", "-", "--property", name).out)
        assert [p["name"] for p in one["properties"]] == [name]
    done = command("translate", "main.xml", "--property", "none_such")
    assert (done.status, done.out) == (2, "")
    assert f"the system has no property `none_such`; its properties are: {', '.join(names)}" in done.err


def test_parts_of_properties_without_effect(command: Command, robot: Path) -> None:
    """Comments below properties change nothing in a translation. That of a property is kept, as its sentence."""
    path = robot / "properties.jani"
    written = json.loads(path.read_text())
    plain = command("translate", "main.xml", "-o", "-").out
    for property_ in written["properties"]:
        property_["expression"]["comment"] = property_["expression"]["values"]["comment"] = "a remark"
    path.write_text(json.dumps(written))
    done = command("translate", "main.xml", "-o", "-")
    assert (done.status, done.out) == (0, plain)
    for property_ in written["properties"]:
        property_["expression"]["values"]["exp"] |= {"comment": "a remark", "step-bounds": {"upper": 3}}
    path.write_text(json.dumps(written))
    path_formulas = [
        property_["expression"]["values"]["exp"]
        for property_ in json.loads(command("translate", "main.xml", "-o", "-").out)["properties"][:2]
    ]
    assert [(formula["comment"], formula["step-bounds"]) for formula in path_formulas] == [
        ("a remark", {"upper": 3})
    ] * 2


def test_bounds_on_rewards_are_translated(command: Command, robot: Path) -> None:
    path = robot / "properties.jani"
    written = json.loads(path.read_text())
    bounds = [{"exp": 1, "accumulate": ["steps"], "bounds": {"upper": 3}}]
    written["properties"][0]["expression"]["values"]["exp"]["reward-bounds"] = bounds
    path.write_text(json.dumps(written))
    done = command("translate", "main.xml", "-o", "-")
    assert done.status == 0
    translated = {row["name"]: row["expression"]["values"]["exp"] for row in json.loads(done.out)["properties"]}
    assert translated[written["properties"][0]["name"]]["reward-bounds"] == bounds


@pytest.mark.parametrize("depth", [0, 1])
def test_a_property_with_bounds_on_time_is_left_out_and_reported(command: Command, robot: Path, depth: int) -> None:
    """Without its bounds, the property would have another meaning; with them, Storm reads seconds as steps."""
    path = robot / "properties.jani"
    written = json.loads(path.read_text())
    bounded, other = (row["name"] for row in written["properties"])
    formula = written["properties"][0]["expression"]["values"]["exp"]
    if depth:
        formula["exp"] = {"op": "F", "exp": formula["exp"]}
        formula = formula["exp"]
    formula["time-bounds"] = {"upper": 3}
    path.write_text(json.dumps(written, indent=1))
    done = command("translate", "main.xml", "-o", "-")
    assert done.status == 0
    translated = [property_["name"] for property_ in json.loads(done.out)["properties"]]
    assert bounded not in translated
    assert translated[0] == other
    assert f"warning: the property `{bounded}` is left out of the JANI file: bounds on " in done.err
    assert "[ignored-bounds]" in done.err
    line = next(n for n, text in enumerate(path.read_text().splitlines(), 1) if '"time-bounds"' in text)
    assert f"properties.jani:{line}:" in done.err
    as_json = command("translate", "main.xml", "-o", "out.jani", "--format", "json")
    assert [row["code"] for row in json.loads(as_json.out)] == ["ignored-bounds"]
    (robot / "main.jani").unlink(missing_ok=True)
    named = command("translate", "main.xml", "--property", bounded)
    assert (named.status, named.out) == (1, "")
    assert "main.jani was not written" in named.err
    assert not (robot / "main.jani").exists()
    assert command("translate", "main.xml", "--property", other).err == ""


def test_a_model_keeps_bounds_that_cannot_be_answered(robot: Path) -> None:
    """The model keeps the bounds, and a verification from Python reports them."""
    path = robot / "properties.jani"
    written = json.loads(path.read_text())
    written["properties"][0]["expression"]["values"]["exp"]["time-bounds"] = {"upper": 3}
    path.write_text(json.dumps(written))
    model = api.to_jani(api.load(str(robot / "main.xml")))
    first, *_ = api.verify(model)
    assert isinstance(first.outcome, api.Refused)
    assert first.outcome.reason.code == "ignored-bounds"
    assert not first.is_met


def test_parameters(command: Command, robot: Path) -> None:
    def clock_end(*options: str) -> int:
        text = command("translate", "main.xml", "-o", "-", *options).out
        assert text, options
        numbers = set()

        def visit(value: object) -> None:
            if isinstance(value, dict):
                if value.get("op") in ("<", "≤", "≥", ">") and isinstance(value.get("right"), int):
                    numbers.add(value["right"])
                for inner in value.values():
                    visit(inner)
            elif isinstance(value, list):
                for inner in value:
                    visit(inner)

        clock = next(a for a in json.loads(text)["automata"] if a["name"] == "autogenerated_global_timer")
        visit(clock)
        return max(numbers)

    ends = [clock_end("--max-time", time) for time in ("20 s", "10s", "1000ms")]
    assert ends[0] == 2 * ends[1] == 20 * ends[2]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--max-time", "5"), "a time must be a whole number and h, min, s, ms, us or ns"),
        (("--max-time", "0 s"), "a time must be"),
        (("--max-array-size", "0"), "a whole number of at least 1"),
        (("--indent", "-1"), "from 0 to 16"),
        (("--output", "-", "--map", "-"), "cannot both go to standard output"),
        (("--output", "nodes/battery.ascxml"), "is an input of the command"),
        (("--map", "./tree.xml"), "is an input of the command"),
        (("--output", "nowhere/x.jani"), "nowhere/x.jani: No such file or directory"),
        (("--scxml-dir", "main.xml"), "main.xml: File exists"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else "",
)
def test_wrong_use(command: Command, robot: Path, options: tuple[str, ...], message: str) -> None:
    before = {path: path.read_bytes() for path in robot.rglob("*") if path.is_file()}
    done = command("translate", "main.xml", *options)
    assert done.status == 2
    assert message in done.err
    assert {path: path.read_bytes() for path in robot.rglob("*") if path.is_file()} == before


def test_no_system_file(command: Command, robot: Path) -> None:
    for path, message in (("nothing.xml", "there is no such file"), ("tree.xml", "not a system file")):
        done = command("translate", path)
        assert done.status == 2
        assert message in done.err


def test_a_property_file_of_the_default_name_is_kept(command: Command, robot: Path) -> None:
    (robot / "properties.jani").rename(robot / "main.jani")
    main = robot / "main.xml"
    main.write_text(main.read_text().replace("properties.jani", "main.jani"))
    before = (robot / "main.jani").read_bytes()
    done = command("translate", "main.xml")
    assert done.status == 2
    assert "main.jani: this file is an input of the command; write the output to another file" in done.err
    assert (robot / "main.jani").read_bytes() == before


def test_a_failure_while_writing_leaves_the_old_file(
    command: Command, robot: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    old = f"old, {TRANSLATION_MARK}"
    (robot / "main.jani").write_text(old)

    def failing(*_: object) -> object:
        yield "{"
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(as2fm_lsp.cli.translate, "jani_text", failing)
    done = command("translate", "main.xml")
    assert (done.status, done.err) == (2, "as2fm-lsp: main.jani: No space left on device\n")
    assert (robot / "main.jani").read_text() == old
    assert not list(robot.glob(".as2fm-*"))


def test_map(command: Command, robot: Path) -> None:
    """Every automaton, edge and variable of the JANI file has a place in a file of the system."""
    done = command("translate", "main.xml", "--map", "map.json")
    assert done.status == 0
    model = json.loads((robot / "main.jani").read_text())
    places = json.loads((robot / "map.json").read_text())
    assert (places["version"], places["system"]) == (1, "main.xml")
    assert [v["name"] for v in places["variables"]] == [v["name"] for v in model["variables"]]
    assert [a["name"] for a in places["automata"]] == [a["name"] for a in model["automata"]]
    everything = [*places["variables"], *places["automata"]]
    for automaton, mapped in zip(model["automata"], places["automata"], strict=True):
        assert [v["name"] for v in mapped["variables"]] == [v["name"] for v in automaton.get("variables", ())]
        edges = [(e["location"], e.get("action")) for e in automaton["edges"]]
        assert [(e["location"], e["action"]) for e in mapped["edges"]] == edges
        everything += [*mapped["variables"], *mapped["edges"]]
    for place in everything:
        lines = (robot / place["file"]).read_text().splitlines()
        assert lines[place["line"] - 1][place["column"] - 1 :], place
    battery = next(a for a in places["automata"] if a["name"] == "Battery")
    level = next(v for v in battery["variables"] if v["name"] == "level")
    text = (robot / level["file"]).read_text().splitlines()[level["line"] - 1][level["column"] - 1 :]
    assert text.startswith('<data id="level"')


def test_plain_scxml(command: Command, robot: Path) -> None:
    done = command("translate", "main.xml", "--scxml-dir", "deep/scxml")
    assert done.status == 0
    schema = etree.XMLSchema(etree.parse(str(schema_path("scxml.xsd"))))
    files = sorted((robot / "deep/scxml").glob("*.scxml"))
    assert "Battery.scxml" in {path.name for path in files}
    delayed = []
    for path in files:
        root = etree.parse(str(path)).getroot()
        delayed += [(path.stem, send.get("target"), send.get("delay")) for send in root.iterfind(".//*[@delay]")]
        assert root.tag == f"{SCXML}scxml"
        assert root.get("name") == path.stem
        for element in root.iter(etree.Element):
            element.tag = etree.QName(element).localname
        assert schema.validate(root), schema.error_log
    assert delayed == [("autogenerated_global_timer", "autogenerated_global_timer", "1")]


@pytest.mark.parametrize(("name", "extension"), [("dot", "dot"), ("mermaid", "mmd"), ("plantuml", "puml")])
def test_diagrams(command: Command, robot: Path, name: str, extension: str) -> None:
    assert command("translate", "main.xml", f"--{name}", "views").status == 0
    names = {path.name for path in (robot / "views").iterdir()}
    assert {f"{stem}.{extension}" for stem in ("tree", "network", "machine-Battery")} <= names
    assert all(n.endswith(f".{extension}") for n in names)


def test_closed_pipe(robot: Path) -> None:
    line = f"{sys.executable} -m as2fm_lsp translate main.xml -o - | head -c 10"
    done = subprocess.run(["sh", "-c", line], cwd=robot, capture_output=True, text=True, check=False)
    assert (done.stdout, done.stderr) == ('{"jani-ver', "")


def test_same_bytes_whatever_the_hashes(robot: Path) -> None:
    outputs = set()
    for seed in ("0", "1", "2"):
        command = [sys.executable, "-m", "as2fm_lsp", "translate", "main.xml", "-o", "-"]
        environment = {**os.environ, "PYTHONHASHSEED": seed}
        outputs.add(subprocess.run(command, cwd=robot, env=environment, capture_output=True, check=True).stdout)
    assert len(outputs) == 1


def test_progress_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    """The stages are shown after the delay and removed at the end."""
    leader, follower = pty.openpty()
    monkeypatch.setattr(as2fm_lsp.cli.status_line, "SHOW_DELAY_S", 0.0)
    with os.fdopen(follower, "w") as terminal:
        monkeypatch.setattr(sys, "stderr", terminal)
        with as2fm_lsp.cli.status_line.StatusLine() as status:
            status.stage("reading")
            status.shown.wait(10)
            status.stage("translating")
    said = b""
    with contextlib.suppress(OSError):  # as the end of what a terminal holds is told
        while chunk := os.read(leader, 1000):
            said += chunk
    os.close(leader)
    assert "\r\x1b[Kreading …\r\x1b[Ktranslating …\r\x1b[K".encode().endswith(said[-20:])
    assert "translating …".encode() in said


def test_progress_in_a_log(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """A line appears after a delay, and further lines after delays that grow. The line is not removed at the end."""
    monkeypatch.setattr(as2fm_lsp.cli.status_line, "LOG_DELAY_S", 10.0)
    times = iter(range(1000))
    monkeypatch.setattr(as2fm_lsp.cli.status_line.time, "monotonic", lambda: float(next(times)))
    with as2fm_lsp.cli.status_line.StatusLine() as status:
        status.stage("reading")
        written = []
        for _ in range(300):
            if status.is_due:
                status.show("half of it")
                written.append(next(times))
    assert capsys.readouterr().err == "as2fm-lsp: half of it\n" * len(written)
    waits = [later - earlier for earlier, later in itertools.pairwise(written)]
    assert waits == sorted(waits)
    assert 10 < waits[0] < waits[-1]
    assert len(written) < 10


def test_no_progress_of_short_work(capsys: pytest.CaptureFixture[str]) -> None:
    with as2fm_lsp.cli.status_line.StatusLine() as status:
        status.stage("reading")
    assert capsys.readouterr().err == ""


def test_no_progress_if_nothing_is_to_be_written(capsys: pytest.CaptureFixture[str]) -> None:
    set_verbosity(Verbosity.QUIET)
    with as2fm_lsp.cli.status_line.StatusLine() as status:
        status.stage("reading")
        assert not status.is_due
    set_verbosity(Verbosity.VERBOSE)
    with as2fm_lsp.cli.status_line.StatusLine() as status:
        status.stage("reading")
        status.stage("translating")
    set_verbosity(Verbosity.NORMAL)
    said = capsys.readouterr().err
    assert [line.rpartition(":")[0] for line in said.splitlines()] == ["as2fm-lsp: reading", "as2fm-lsp: translating"]
