# SPDX-License-Identifier: Apache-2.0
"""The warehouse of the examples: 20 machines from 12 files. Copies of the files that are made by plain replacements of
texts, as authors make them without instances, have the same translation."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

from as2fm_lsp.cli.main import run
from roaml import api
from roaml.jani.writer import write

FOLDER = Path(__file__).resolve().parents[2] / "examples" / "warehouse"
ROBOTS = {1: (15, "1"), 2: (10, "1"), 3: (15, "0.5"), 4: (20, "1"), 5: (10, "0.5")}
"""Number of a robot -> the use of its battery, and the rate in Hz with which it is drained."""

CONSTANTS = {
    "dispatcher": {"% robots": "% 5"},
    "dock": {"1 / charging_time": "0.5"},
    "packer": {'"1 - loss"': '"0.95"', '"loss"': '"0.05"'},
    "conveyor": {"== places": "== 10"},
    "smoke_detector": {'"1 - smoke"': '"0.99"', '"smoke"': '"0.01"'},
    "supervisor": {"== robots": "== 5"},
}


def copied(name: str, replacements: dict[str, str]) -> str:
    """The text of a machine without its parameters, with other texts replaced."""
    text = (FOLDER / "nodes" / f"{name}.ascxml").read_text(encoding="utf-8")
    text = re.sub(r"^ *<parameter .*\n", "", text, flags=re.MULTILINE)
    for old, new in replacements.items():
        assert old in text, old
        text = text.replace(old, new)
    return text


@pytest.fixture
def copies(tmp_path: Path) -> Path:
    """The system file of a warehouse in which each machine has a file."""
    files: dict[str, str] = {}
    for number in ROBOTS:
        names = {
            'name="Robot"': f'name="robot_{number}"',
            "== number": f"== {number}",
            'expr="number"': f'expr="{number}"',
            "low": "30",
            'topic="battery"': f'topic="/robot_{number}/battery"',
            'topic="driving"': f'topic="/robot_{number}/driving"',
        }
        files[f"robot_{number}"] = copied("robot", names)
    for number, (use, rate) in ROBOTS.items():
        names = {
            'name="Battery"': f'name="battery_{number}"',
            'expr="capacity"': 'expr="100"',
            "level - use": f"level - {use}",
            "1 / period": rate,
            'topic="battery"': f'topic="/robot_{number}/battery"',
            'topic="driving"': f'topic="/robot_{number}/driving"',
        }
        files[f"battery_{number}"] = copied("battery", names)
    system = (FOLDER / "main.xml").read_text(encoding="utf-8")
    for name in re.findall(r'src="nodes/(\w+)\.ascxml" />', system):
        files[name] = copied(name, CONSTANTS.get(name, {}))
    for name, text in files.items():
        (tmp_path / f"{name}.ascxml").write_text(text, encoding="utf-8")
    properties = (FOLDER / "never_empty.xml").read_text(encoding="utf-8")
    properties = re.sub(r"^ *<parameter .*\n", "", properties, flags=re.MULTILINE)
    for number in ROBOTS:
        text = properties.replace("$(var robot)", f"robot_{number}").replace('expr="capacity"', 'expr="100"')
        (tmp_path / f"robot_{number}.xml").write_text(text, encoding="utf-8")
    nodes = "".join(f'<input type="node-ascxml" src="{name}.ascxml" />' for name in files)
    listed = "".join(f'<input type="xml" src="robot_{number}.xml" />' for number in ROBOTS)
    main = tmp_path / "main.xml"
    main.write_text(
        f"""<roaml>
    <parameters><max_time value="60" unit="s" reaction_time="instant" /></parameters>
    <node_models>{nodes}</node_models>
    <properties>{listed}</properties>
</roaml>
""",
        encoding="utf-8",
    )
    return main


def model(path: Path) -> Any:
    return json.loads("".join(write(api.to_jani(api.load(str(path))))))


def test_copies_have_the_same_translation(copies: Path) -> None:
    assert len(list((FOLDER / "nodes").iterdir())) == 12
    assert len(list(copies.parent.glob("*.ascxml"))) == 20
    assert model(copies) == model(FOLDER / "main.xml")


def test_the_warehouse_is_clean() -> None:
    findings = api.check([str(FOLDER / "main.xml")]).diagnostics
    assert {finding.code for finding in findings} == {"not-in-reference"}


def test_a_battery_is_empty_only_if_it_is_too_small(capsys: pytest.CaptureFixture[str]) -> None:
    """With a use of 60 of 50, the first message of the battery says that it is empty."""
    question = ["verify", str(FOLDER / "main.xml"), "--property", "robot_4_never_empty", "--format", "json"]
    run([*question, "--set", "capacity=50", "--set", "battery_4.use=60", "--exhaustive"])
    written = json.loads(capsys.readouterr().out)
    assert written["results"][0]["exact"]["greatest"] == 0
    assert written["parameters"]["battery_4.use"] == "60"
    run([*question, "--scheduler", "uniform", "--max-traces", "20", "--jobs", "1"])
    (result,) = json.loads(capsys.readouterr().out)["results"]
    assert (result["passed"], result["failed"]) == (20, 0)
