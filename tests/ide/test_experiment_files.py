# SPDX-License-Identifier: Apache-2.0
"""Files with the arguments of an experiment in editors: their keys, which are the options of the command, mistakes,
completion and hover."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from as2fm_lsp.cli.experiment_arguments import parser
from roaml import api
from roaml.ide.completion import complete
from roaml.ide.hover import hover
from roaml.project.experiment_file import KEYS, MODEL, KeyForm
from roaml.project.settings import Settings
from roaml.project.workspace import Workspace

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
FILE = """model = "main.xml"
property = ["all_delivered"]
scheduler = "uniform"

[set]
capacity = "20:120:10"
"""
ASKED, MEETS = 'property = ["all_delivered"]\n', 'meets = "all_delivered >= 0.99"\n'


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("robots")
    for name in ("battery", "delivery_robot"):
        shutil.copytree(EXAMPLES / name, root / name)
    return root / "battery"


def findings(folder: Path, text: str) -> list[tuple[str, str]]:
    """The code and message of each finding, with the text at its place."""
    path = str(folder / "new.experiment.toml")
    Path(path).write_text(text, encoding="utf-8")
    return [
        (text[d.span.start : d.span.end], f"{d.message} [{d.code}]")
        for d in api.check([str(folder)]).diagnostics
        if d.path == path
    ]


def test_the_keys_are_the_options_of_the_command() -> None:
    actions = {
        option.removeprefix("--"): action
        for action in parser()._actions
        for option in action.option_strings
        if option.startswith("--")
    }
    assert set(KEYS) - {MODEL} == set(actions) - {"help"}
    for name, action in actions.items():
        if name != "help":
            key = KEYS[name]
            assert key.words == tuple(map(str, action.choices or ())), name
            assert (key.form is KeyForm.FLAG) == (action.nargs == 0), name
            assert (key.form is KeyForm.ENTRIES) == isinstance(action.default, list), name


def test_a_right_file_has_no_findings(folder: Path) -> None:
    assert findings(folder, FILE) == []
    by_hand = (EXAMPLES / "battery/battery.experiment.toml").read_text(encoding="utf-8")
    assert findings(folder, by_hand) == []
    assert findings(folder, FILE.replace('"all_delivered"', "'P=? [ F all_delivered ]'")) == []


@pytest.mark.parametrize(
    ("old", "new", "place", "message"),
    [
        ("property =", "proprety =", "proprety", "there is no option `proprety`; did you mean `property`?"),
        ('"all_delivered"', '"all_deliverd"', '"all_deliverd"', "has no property `all_deliverd`; did you mean"),
        ("capacity", "capacty", "capacty", "the system has no parameter `capacty`; did you mean `capacity`?"),
        ('"uniform"', '"unifrm"', '"unifrm"', "`unifrm` is not a value of `scheduler`; did you mean `uniform`?"),
        ('"uniform"', "true", "true", "`scheduler` must be a text or a number"),
        ("scheduler", 'slopes = "yes"\nscheduler', '"yes"', "`slopes` must be `true` or `false`"),
        ('"main.xml"', '"mian.xml"', '"mian.xml"', "there is no file `mian.xml`; paths are relative to the folder"),
        ('model = "main.xml"\n', "", "p", "the file names no model; add `model ="),
        (ASKED, 'find = "capasity"\n' + MEETS, '"capasity"', "has no values to try; add it to `set`; did you"),
        (
            ASKED,
            'find = "capacity"\n' + MEETS.replace("0.99", "99"),
            '"all_delivered >= 99"',
            "`all_delivered` is a probability, which is from 0 to 1, so this is never met; change it",
        ),
        (ASKED, 'find = "capacity"\n', "find", "`find` needs `meets`, such as"),
        (ASKED, MEETS, "meets", "`meets` needs `find`, the parameter"),
        ("scheduler", f'find = "capacity"\n{MEETS}scheduler', "property", "computes the property in `meets`; remove"),
        (ASKED, f'find = "capacity"\n{MEETS}resume = "a.json"\n', "resume", "`find` saves no points; remove `resume`"),
        ("scheduler", 'beside = ["a.csv"]\nscheduler', '"a.csv"', "there is no file `a.csv`"),
        ('"20:120:10"', '"20:20:220"', '"20:20:220"', "`capacity` must be at most 200, but one of the values is 220"),
        ('"20:120:10"', "[50, 10]", "10", "`capacity` must be at least 20, but one of the values is 10"),
        (
            '"20:120:10"',
            '"20:10:200"\npresent = [0, 1.5]',
            "1.5",
            "`present` must be at most 1, but one of the values is",
        ),
        ("[set]", "[unit]\npresent = '%'\n[set]", "present", "`present` is not a parameter of this experiment"),
    ],
)
def test_mistakes(old: str, new: str, place: str, message: str, folder: Path) -> None:
    (found,) = findings(folder, FILE.replace(old, new, 1))
    assert found[0] == place
    assert message in found[1]
    assert "[invalid-setting]" in found[1]


def test_a_file_that_is_not_toml(folder: Path) -> None:
    ((_, message),) = findings(folder, FILE + "property = [\n")
    assert message.endswith("[toml-syntax]")


def test_a_fix_corrects_a_name(folder: Path) -> None:
    path = folder / "new.experiment.toml"
    path.write_text(FILE.replace("capacity", "capacty"), encoding="utf-8")
    (found,) = [d for d in api.check([str(folder)]).diagnostics if d.path == str(path)]
    assert [fix.title for fix in found.fixes] == ["Change to `capacity`"]


def opened(folder: Path, text: str) -> tuple[Workspace, str]:
    path, workspace = str(folder / "new.experiment.toml"), Workspace((str(folder),), Settings())
    workspace.open(path, text)
    return workspace, path


@pytest.mark.parametrize(
    ("text", "expected", "inserted"),
    [
        ("prop|", "property", 'property = ["$1"]'),
        ("|", "[set]", "[set]\n"),
        ("model = |", "main.xml", '"main.xml"'),
        ('model = "ma|"', "main.xml", "main.xml"),
        ('model = "main.xml"\nproperty = ["|"]', "all_delivered", "all_delivered"),
        ('model = "main.xml"\nfind = |', "capacity", '"capacity"'),
        ('model = "main.xml"\nmeets = "|"', "all_delivered >= 0.99", "all_delivered >= 0.99"),
        ("scheduler = |", "uniform", '"uniform"'),
        ('model = "main.xml"\n[set]\n|', "capacity", 'capacity = "${1:20:200:20}"'),
        ('model = "main.xml"\n[unit]\n|', "capacity", 'capacity = "$1"'),
    ],
)
def test_completion(text: str, expected: str, inserted: str, folder: Path) -> None:
    offset = text.index("|")
    workspace, path = opened(folder, text.replace("|", "", 1))
    found = complete(workspace.snapshot(), path, offset)
    assert found is not None
    assert {item.label: item.snippet for item in found.items}[expected] == inserted


@pytest.mark.parametrize(
    ("at", "expected"),
    [
        ("property", "The properties that are computed"),
        ("scheduler", "Values: `uniform`"),
        ("capacity", "Parameter `capacity`: 100 in the system; at least 20 and at most 200"),
        ("all_delivered", None),
    ],
)
def test_hover(at: str, expected: str | None, folder: Path) -> None:
    workspace, path = opened(folder, FILE)
    shown = hover(workspace.snapshot().analysis, path, FILE.index(at) + 1)
    assert shown is None if expected is None else shown is not None and expected in shown.text
