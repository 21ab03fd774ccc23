# SPDX-License-Identifier: Apache-2.0
"""`as2fm.toml` and `[tool.as2fm]` in `pyproject.toml`."""

from __future__ import annotations

from pathlib import Path

import pytest
from command import Command

import clock

BOTH = clock.UNHEARD_CLOCK.replace('location="count"', 'location="coutn"')
"""`topic-without-subscriber`, a hint, and `undeclared-variable`, an error."""


@pytest.fixture(params=["as2fm.toml", "pyproject.toml"])
def configure(request: pytest.FixtureRequest, tmp_path: Path):  # type: ignore[no-untyped-def]
    """Writes a configuration into a folder, in one of the two places."""

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
    """Wherever the tool is called from, and whatever is named."""
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
    ("pattern", "found"),
    [
        ("attic/*", ["b", "c/attic"]),
        ("attic", ["b", "c/attic"]),
        ("attic/", ["b", "c/attic"]),
        ("attic/**", ["b", "c/attic"]),
        ("**/attic", ["b"]),
        ("**/attic/**", ["b"]),
        ("*.ascxml", []),
        ("*/attic/*", ["attic", "b"]),
        ("at?ic/cl*.ascxml", ["b", "c/attic"]),
        ("nothing", ["attic", "b", "c/attic"]),
        ("[b]/*", ["attic", "c/attic"]),
    ],
)
def test_exclude(check: Command, tmp_path: Path, configure, pattern: str, found: list[str]) -> None:  # type: ignore[no-untyped-def]
    top = tmp_path / "[x]*"  # characters that patterns give a meaning to
    for folder in ("attic", "b", "c/attic"):
        (top / folder).mkdir(parents=True)
        (top / folder / "clock.ascxml").write_text(clock.WRONG_CLOCK)
    configure(f'exclude = ["{pattern}"]', top)
    assert [row["file"] for row in check(top).rows] == [f"[x]*/{folder}/clock.ascxml" for folder in found]


def test_roots_are_where_the_systems_of_a_single_file_are_looked_for(  # type: ignore[no-untyped-def]
    check: Command, tmp_path: Path, configure
) -> None:
    (tmp_path / ".git").mkdir()
    clock.write(tmp_path / "models", clock=clock.UNHEARD_CLOCK)
    assert check("models/clock.ascxml").codes == ["topic-without-subscriber"]
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
    ("text", "complaint"),
    [
        ("ingore = []", "unknown setting `ingore`; did you mean `ignore`?"),
        ("colour = true", "unknown setting `colour`; there are exclude, ignore, "),
        ("ignore = 1", "`ignore` is not a list of texts"),
        ('ignore = ["undeclared-variable", 1]', "`ignore` is not a list of texts"),
        ('ignore = ["no-such-rule"]', "`ignore` names `no-such-rule`, and there is no such rule"),
        (
            'ignore = ["unknwn-type"]',
            "`ignore` names `unknwn-type`, and there is no such rule; did you mean `unknown-type`?",
        ),
        (
            'severity = { unknwn-type = "hint" }',
            "`severity` names `unknwn-type`, and there is no such rule; did you mean",
        ),
        ('select = ["no-such-rule"]', "`select` names `no-such-rule`, and there is no such rule"),
        ('severity = { no-such-rule = "hint" }', "`severity` names `no-such-rule`, and there is no such rule"),
        ('severity = { undeclared-variable = "fatal" }', "`severity` is not a table of codes with hint, information"),
        ('severity = { undeclared-variable = ["hint"] }', "`severity` is not a table of codes"),
        ("severity = { undeclared-variable = {} }", "`severity` is not a table of codes"),
        ('severity = "hint"', "`severity` is not a table of codes"),
        ('warnings-as-errors = "yes"', "`warnings-as-errors` is not true or false"),
        ("roots = { a = 1 }", "`roots` is not a list of texts"),
        ("ros-path = [[]]", "`ros-path` is not a list of texts"),
        ("exclude = 2026-01-01", "`exclude` is not a list of texts"),
    ],
)
def test_mistakes_in_it_are_wrong_use(check: Command, tmp_path: Path, configure, text: str, complaint: str) -> None:  # type: ignore[no-untyped-def]
    clock.write(tmp_path)
    path = configure(text)
    done = check(".")
    assert (done.status, done.out) == (2, "")
    assert done.err.startswith(f"as2fm-lsp: {path}: {complaint}")
    assert len(done.err.splitlines()) == 1


def test_all_mistakes_are_told_at_once(check: Command, tmp_path: Path) -> None:
    clock.write(tmp_path)
    (tmp_path / "as2fm.toml").write_text("a = 1\nb = 2\nignore = 3\n")
    assert len(check(".").err.splitlines()) == 3


@pytest.mark.parametrize("content", [b"ignore = [", b"\xff\xfe", b"\0", b"a = 1\na = 2"])
def test_a_file_that_is_no_toml(check: Command, tmp_path: Path, content: bytes) -> None:
    clock.write(tmp_path)
    (tmp_path / "pyproject.toml").write_bytes(content)
    assert check(".").status == 0, "a pyproject.toml may be broken for reasons that are not ours"
    (tmp_path / "as2fm.toml").write_bytes(content)
    done = check(".")
    assert done.status == 2
    assert done.err.startswith(f"as2fm-lsp: {tmp_path / 'as2fm.toml'}: ")


def test_a_folder_in_its_place(check: Command, tmp_path: Path) -> None:
    clock.write(tmp_path)
    (tmp_path / "as2fm.toml").mkdir()
    assert check(".").status == 2
