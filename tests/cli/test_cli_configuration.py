# SPDX-License-Identifier: Apache-2.0
"""`as2fm.toml` and `[tool.as2fm]` in `pyproject.toml`."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path

import pytest
from command import Command

import clock
from roaml.project.discover import candidates, is_candidate
from roaml.project.exclude import Exclude

BOTH = clock.UNHEARD_CLOCK.replace('location="count"', 'location="coutn"')
"""`topic-without-subscriber`, a hint, and `undeclared-variable`, an error."""


@pytest.fixture(params=["as2fm.toml", "pyproject.toml"])
def configure(request: pytest.FixtureRequest, tmp_path: Path):  # type: ignore[no-untyped-def]
    """Writes a configuration into a folder, in one of the two kinds of files."""

    def write(text: str, folder: Path = tmp_path) -> Path:
        header = "" if request.param == "as2fm.toml" else '[project]\nname = "robot"\n[tool.as2fm]\n'
        path = folder / request.param
        path.write_text(header + text)
        return path

    return write


def test_ignore_select_severity(check: Command, tmp_path: Path, configure) -> None:  # type: ignore[no-untyped-def]
    clock.write(tmp_path, clock=BOTH)
    configure('ignore = ["undeclared-variable"]')
    assert check(".").codes == ["topic-without-subscriber"]
    configure('ignore = "undeclared-variable"')
    assert check(".").codes == ["topic-without-subscriber"], "one text is as good as a list with one"
    configure('select = ["undeclared-variable"]')
    assert check(".").codes == ["undeclared-variable"]
    assert check(".", "--select", "topic-without-subscriber").codes == ["topic-without-subscriber"]
    configure('severity = { undeclared-variable = "hint", topic-without-subscriber = "error" }')
    rows = check(".").rows
    assert [(row["severity"], row["code"]) for row in rows] == [
        ("error", "topic-without-subscriber"),
        ("hint", "undeclared-variable"),
    ]
    configure("")
    assert len(check(".").rows) == 2


def test_paths_are_relative_to_the_configuration(  # type: ignore[no-untyped-def]
    check: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, configure
) -> None:
    """Paths do not depend on the working directory or on the files that are named."""
    message = tmp_path / "interfaces" / "my_msgs" / "msg" / "Speed.msg"
    message.parent.mkdir(parents=True)
    message.write_text("uint8 data\n")
    clock.write(tmp_path / "models" / "a", clock=clock.CLOCK.replace("std_msgs/UInt8", "my_msgs/Speed"))
    clock.write(tmp_path / "models" / "attic", clock=BOTH)
    configure('ros-path = ["interfaces"]\nexclude = ["models/attic"]')
    monkeypatch.chdir(tmp_path / "models")
    for named in (".", "a", "a/main.xml", "a/clock.ascxml", "..", tmp_path / "models"):
        assert check(named).rows == [], named
    assert len(check("attic/clock.ascxml").rows) == 1, "what is named is checked, but its systems do not count"
    assert len(check("attic/main.xml").rows) == 2


@pytest.mark.parametrize(
    ("patterns", "left"),
    [
        (["attic/*"], ["b", "c/attic"]),
        (["/attic"], ["b", "c/attic"]),
        (["attic/**"], ["b", "c/attic"]),
        (["attic"], ["b"]),
        (["attic/"], ["b"]),
        (["**/attic"], ["b"]),
        (["**/attic/**"], ["b"]),
        (["c/attic"], ["attic", "b"]),
        (["*.ascxml"], []),
        (["clock.ascxml"], []),
        (["c*.ascxml/"], ["attic", "b", "c/attic"]),
        (["*/attic/*"], ["attic", "b"]),
        (["*/clock.ascxml"], ["c/attic"]),
        (["at?ic/cl*.ascxml"], ["b", "c/attic"]),
        (["nothing", "# attic", ""], ["attic", "b", "c/attic"]),
        (["[b]/*"], ["attic", "c/attic"]),
        (["*", "!c/", "!attic/", "!clock.ascxml"], ["attic", "c/attic"]),
        (["attic", "!attic/clock.ascxml"], ["b"]),
        (["attic/**", "!attic/clock.ascxml"], ["attic", "b", "c/attic"]),
    ],
)
def test_exclude(check: Command, tmp_path: Path, configure, patterns: list[str], left: list[str]) -> None:  # type: ignore[no-untyped-def]
    """Patterns have the same meaning as in Git."""
    top = tmp_path / "[x]*"  # characters that patterns give a meaning to
    for folder in ("attic", "b", "c/attic"):
        (top / folder).mkdir(parents=True)
        (top / folder / "clock.ascxml").write_text(clock.WRONG_CLOCK)
    configure(f"exclude = {json.dumps(patterns)}", top)
    assert [row["file"] for row in check(top).rows] == [f"[x]*/{folder}/clock.ascxml" for folder in left]
    subprocess.run(["git", "init", "-q", top], check=True)
    (top / ".gitignore").write_text("\n".join(patterns))
    listed = subprocess.run(
        ["git", "-C", top, "ls-files", "--others", "--exclude-standard", "*.ascxml"], capture_output=True, check=True
    )
    assert listed.stdout.decode().splitlines() == [f"{folder}/clock.ascxml" for folder in left]


def test_exclude_in_roots_elsewhere(check: Command, tmp_path: Path, configure) -> None:  # type: ignore[no-untyped-def]
    """Patterns apply in each root, also in those that are not below the configuration."""
    for folder in ("shared/models", "shared/attic", "here"):
        clock.write(tmp_path / folder)
    (tmp_path / "shared/attic/clock.ascxml").write_text(clock.WRONG_CLOCK)
    configure('roots = [".", "../shared"]\nexclude = ["/attic"]', tmp_path / "here")
    assert [row["file"] for row in check("here", "shared/models").rows] == []
    assert is_candidate(str(tmp_path / "shared/models/clock.ascxml"), [str(tmp_path / "shared")], Exclude(("/attic",)))
    assert not is_candidate(
        str(tmp_path / "shared/attic/clock.ascxml"),
        [str(tmp_path / "shared")],
        Exclude(("/attic",), str(tmp_path / "here")),
    )


def test_excluded_folders_are_not_entered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    clock.write(tmp_path / "models")
    clock.write(tmp_path / "data" / "deep")
    entered = []
    scandir = os.scandir
    monkeypatch.setattr(os, "scandir", lambda path: entered.append(os.path.basename(path)) or scandir(path))
    exclude = Exclude(("deep/", "data/*"), str(tmp_path))
    paths = list(candidates([str(tmp_path)], exclude))
    assert {os.path.basename(os.path.dirname(path)) for path in paths} == {"models"}
    assert set(candidates([str(tmp_path)], Exclude(("data/",), str(tmp_path)))) == set(paths)
    assert is_candidate(paths[0], [str(tmp_path)], exclude)
    assert not is_candidate(str(tmp_path / "data" / "deep" / "main.xml"), [str(tmp_path)], exclude)


def test_patterns_are_read_in_time(tmp_path: Path) -> None:
    """Patterns are matched in a short time, however long the paths are. If not, this test would take very long."""
    exclude = Exclude(("*a*a*b", "**/a/**/a/**/b"), str(tmp_path))
    assert not exclude.covers(str(tmp_path / ("a" * 250) / "/".join("a" * 1900)), str(tmp_path))
    assert exclude.covers(str(tmp_path / "/".join("aab") / "/".join("c" * 1900)), str(tmp_path))


def test_roots_are_where_the_systems_of_a_single_file_are_looked_for(  # type: ignore[no-untyped-def]
    check: Command, tmp_path: Path, configure
) -> None:
    (tmp_path / ".git").mkdir()
    clock.write(tmp_path / "models", clock=clock.UNHEARD_CLOCK)
    assert check("models/clock.ascxml").codes == ["topic-without-subscriber"]
    (tmp_path / "elsewhere").mkdir()
    configure('roots = ["elsewhere"]')
    assert check("models/clock.ascxml").codes == []
    configure('roots = ["elsewhere", "models"]')
    assert check("models/clock.ascxml").codes == ["topic-without-subscriber"]
    assert check("models").codes == ["topic-without-subscriber"]


def test_the_nearest_configuration_holds(check: Command, tmp_path: Path) -> None:
    clock.write(tmp_path / "a" / "b", clock=BOTH)
    (tmp_path / "as2fm.toml").write_text('ignore = ["undeclared-variable"]')
    (tmp_path / "a" / "pyproject.toml").write_text('[project]\nname = "a"\n')
    assert check("a/b").codes == ["topic-without-subscriber"], "a pyproject.toml that says nothing is passed over"
    (tmp_path / "a" / "pyproject.toml").write_text('[tool.as2fm]\nignore = ["topic-without-subscriber"]\n')
    assert check("a/b").codes == ["undeclared-variable"]
    (tmp_path / "a" / "as2fm.toml").write_text('ignore = ["undeclared-variable"]')
    assert check("a/b").codes == ["topic-without-subscriber"], "as2fm.toml goes first"


@pytest.mark.parametrize(
    ("text", "at", "complaint"),
    [
        ("ingore = []", "ingore", "there is no setting `ingore`; did you mean `ignore`?"),
        ("[x]\na = 1", "x", "there is no setting `x`; valid settings are behaviortree-cpp, exclude, "),
        ("ignore = 1", "1", "`ignore` must be a list of strings"),
        ('ignore = ["undeclared-variable", 1]', '["undeclared-variable", 1]', "`ignore` must be a list of strings"),
        ('ignore = ["no-such-rule"]', '"no-such-rule"', "there is no rule `no-such-rule`"),
        ("select = 'late-event-date'", "'late-event-date'", "there is no rule `late-event-date`; did you mean `late-"),
        ('severity = { no-such-rule = "hint" }', "no-such-rule", "there is no rule `no-such-rule`"),
        (
            'severity = { undeclared-variable = "fatal" }',
            '"fatal"',
            "the severity of `undeclared-variable` must be one",
        ),
        ('severity = { undeclared-variable = ["hint"] }', '["hint"]', "the severity of `undeclared-variable` must be"),
        (
            "severity = { undeclared-variable = {} }",
            "{}",
            "the severity of `undeclared-variable` must be one of `hint`",
        ),
        ('severity.undeclared-variable = "eror"', '"eror"', "the severity of `undeclared-variable` must be one of "),
        ('severity = "hint"', '"hint"', "`severity` must be a table of rule codes and severities"),
        ('warnings-as-errors = "yes"', '"yes"', "`warnings-as-errors` must be true or false"),
        ("roots = { a = 1 }", "{ a = 1 }", "`roots` must be a list of strings"),
        ("ros-path = [[]]", "[[]]", "`ros-path` must be a list of strings"),
        ("exclude = 2026-01-01 07:32:00 # day", "2026-01-01 07:32:00", "`exclude` must be a list of strings"),
        ('exclude = ["a", "!"]', '"!"', "`!` is not a valid pattern; use the syntax of `.gitignore` files"),
        ('exclude = "a*b*c*d*.xml"', '"a*b*c*d*.xml"', "`a*b*c*d*.xml` contains more than 3 `*` without a `/` between"),
        ('exclude = ["**/a/**/b/**/c/**/d"]', '"**/a/**/b/**/c/**/d"', "`**/a/**/b/**/c/**/d` contains more than 3"),
    ],
)
def test_mistakes_in_it_are_diagnostics(  # type: ignore[no-untyped-def]
    check: Command, tmp_path: Path, configure, text: str, at: str, complaint: str
) -> None:
    clock.write(tmp_path)
    path = configure(text)
    whole = path.read_text()
    if path.name == "pyproject.toml":
        whole = whole.replace("[x]", "[tool.as2fm.x]")
        path.write_text(whole)
    done = check(".")
    (row,) = done.rows
    assert done.status == 1
    assert (row["file"], row["severity"], row["code"]) == (path.name, "error", "invalid-setting")
    assert row["message"].startswith(complaint)
    line = whole.splitlines()[row["line"] - 1]
    assert line[row["column"] - 1 : row["end_column"] - 1] == at


@pytest.mark.parametrize("arguments", [("translate",), ("verify",), ("format", "--check")])
def test_other_commands_refuse_it_with_the_place(command: Command, tmp_path: Path, arguments: tuple[str, ...]) -> None:
    clock.write(tmp_path)
    (tmp_path / "as2fm.toml").write_text("\ningore = []\n")
    done = command(*arguments, "main.xml")
    assert (done.status, done.out) == (2, "")
    assert f"{tmp_path / 'as2fm.toml'}:2:1: there is no setting `ingore`" in done.err


def test_all_errors_are_reported_at_once(check: Command, tmp_path: Path) -> None:
    clock.write(tmp_path)
    (tmp_path / "as2fm.toml").write_text("a = 1\nb = 2\nignore = 3\n")
    assert [row["line"] for row in check(".").rows] == [1, 2, 3]


def test_valid_settings_are_used_in_spite_of_errors(check: Command, tmp_path: Path) -> None:
    clock.write(tmp_path, clock=BOTH)
    (tmp_path / "as2fm.toml").write_text('ignore = ["undeclared-variable", "no-such-rule"]\n')
    assert check(".").codes == ["invalid-setting", "topic-without-subscriber"]


def test_a_choice_of_rules_that_do_not_exist_hides_nothing(check: Command, tmp_path: Path) -> None:
    clock.write(tmp_path, clock=BOTH)
    (tmp_path / "as2fm.toml").write_text('select = ["no-such-rule"]\n')
    assert check(".").codes == ["invalid-setting", "topic-without-subscriber", "undeclared-variable"]
    (tmp_path / "as2fm.toml").write_text('select = ["topic-without-subscriber", "no-such-rule"]\n')
    assert check(".").codes == ["invalid-setting", "topic-without-subscriber"]


def test_the_configuration_around_what_is_checked(check: Command, tmp_path: Path) -> None:
    """The configuration may be above all named files. A configuration in a folder below is not in force, but it is
    checked."""
    clock.write(tmp_path / "models")
    (tmp_path / "as2fm.toml").write_text("ingore = []\n")
    (tmp_path / "models" / "inner").mkdir()
    (tmp_path / "models" / "inner" / "as2fm.toml").write_text("ignore = 1\n")
    for named in ("models", "models/main.xml", "models/clock.ascxml", "as2fm.toml"):
        files = [row["file"] for row in check(named).rows]
        assert files == ["as2fm.toml", *(["models/inner/as2fm.toml"] if named == "models" else [])], named


@pytest.mark.parametrize("key", ["ros-path", "roots"])
def test_a_folder_that_is_not_there(check: Command, tmp_path: Path, configure, key: str) -> None:  # type: ignore[no-untyped-def]
    clock.write(tmp_path)
    path = configure(f'{key} = [".", "msgs"]')
    done = check(".")
    (row,) = done.rows
    assert (row["file"], row["severity"], row["code"]) == (path.name, "warning", "missing-folder")
    assert path.read_text().splitlines()[row["line"] - 1][row["column"] - 1 : row["end_column"] - 1] == '"msgs"'
    assert done.status == 0
    assert check("main.xml", "--warnings-as-errors").status == 1
    (tmp_path / "msgs").mkdir()
    assert check(".").rows == []


@pytest.mark.parametrize(
    ("content", "line"),
    [
        (b"ignore = [", 1),
        (b"\xff\xfe", 1),
        (b"\0", 1),
        (b"roots = ['.']\r\na = 1\r\na = 2", 3),
        (b"x = " + b"[" * 5000 + b"]" * 5000, 1),
        (b"x = " + b"{a=" * 5000 + b"0" + b"}" * 5000, 1),
    ],
    ids=["open", "utf-16", "nul", "twice", "deep-list", "deep-table"],
)
def test_a_file_that_is_no_toml(check: Command, tmp_path: Path, content: bytes, line: int) -> None:
    clock.write(tmp_path)
    (tmp_path / "pyproject.toml").write_bytes(content)
    assert check(".").status == 0, "a pyproject.toml may be broken for reasons that are not ours"
    (tmp_path / "as2fm.toml").write_bytes(content)
    done = check(".")
    assert done.status == 1
    assert [(row["file"], row["line"], row["code"]) for row in done.rows] == [("as2fm.toml", line, "toml-syntax")]


def test_a_folder_in_its_place(check: Command, tmp_path: Path) -> None:
    clock.write(tmp_path)
    (tmp_path / "as2fm.toml").mkdir()
    done = check(".")
    assert (done.status, done.err) == (2, f"as2fm-lsp: {tmp_path / 'as2fm.toml'}: it is a folder\n")


def test_a_pipe_in_its_place_is_not_waited_for(check: Command, tmp_path: Path) -> None:
    clock.write(tmp_path)
    os.mkfifo(tmp_path / "as2fm.toml")
    done = check(".")
    assert (done.status, done.err) == (2, f"as2fm-lsp: {tmp_path / 'as2fm.toml'}: it is not a regular file\n")
