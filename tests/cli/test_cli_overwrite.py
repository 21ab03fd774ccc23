# SPDX-License-Identifier: Apache-2.0
"""No command writes over a file that it has read, or over a model."""

from __future__ import annotations

import argparse
import importlib
import os
from collections.abc import Iterable, Iterator
from pathlib import Path

import pytest
from command import Command

from as2fm_lsp.cli import main
from as2fm_lsp.outputs import InputPath, OutputFolder, OutputPath

FILES = {
    "check": "--output",
    "draw": "--output",
    "simulate": "--save --csv --json --mermaid --svg --html",
    "translate": "--output --map",
    "verify": "--explain --plot",
    "experiment": "--output --plot",
    "compare": "--output",
}
"""The options that name a file to write."""

FOLDERS = {
    "translate": "--scxml-dir --expand --dot --mermaid --plantuml",
    "verify": "--traces",
    "compare": "--pictures",
}
"""The options that name a folder into which files are written."""

IN_PLACE = {
    "check": "--fix --baseline",
    "format": "paths",
    "migrate": "paths",
    "verify": "--resume",
    "experiment": "--resume",
    "init": "folder --mocks",
    "serve": "--socket",
}
"""The options that change files on purpose, each with a check of its own: `--baseline` and `init` only create files,
`--resume` only replaces the state of a verification, `--socket` only a socket."""

MODEL = "--tree-semantics --max-time --reaction-time --constant --ros-path --mock --mocks --entry --tick-rate"
MODEL += " --set --params-file"
NOTHING = {
    "check": "paths --tree-semantics --format --ros-path --select --ignore --severity "
    "--warnings-as-errors --statistics "
    "--stdin-filename --set --params-file",
    "debug": "",
    "experiment": "main --live --set --find --meets --assume-monotone --property --scheduler "
    "--exhaustive --slopes --max-states --max-transitions --beside "
    "--confidence --epsilon --method --max-traces --max-steps --seed --jobs --dask --format --theme --unit "
    "--max-time --reaction-time --ros-path --tree-semantics --params-file --mock --mocks --entry --tick-rate",
    "draw": "file --machine --around --matching --tree --outline --graph --interfaces --machines --theme --direction "
    "--mock --mocks --stdin-filename",
    "explain": "code",
    "format": "--check --diff",
    "init": "",
    "migrate": "--check --diff --with-related --ros-path",
    "serve": "--stdio --tcp --allow-remote",
    "simulate": "main --property --seed --trace --for --until --max-steps --script --interactive --theme "
    f"--stdin-filename {MODEL}",
    "translate": "main --tree-semantics --indent --property --max-array-size --max-time "
    "--reaction-time --ros-path --format --stdin-filename --set --params-file",
    "verify": "main --max-transitions --property --expect --confidence --epsilon --method "
    "--max-traces --max-steps --seed --jobs --uniform "
    "--scheduler --exhaustive --max-states --max-memory --no-reductions --stuck --separate --traces-limit --dask "
    "--uniform "
    "--over-time --band --quantiles "
    f"--format {MODEL} --stdin-filename",
    "compare": "old new --property --structure --scheduler --exhaustive --max-states --max-transitions --confidence "
    f"--epsilon --method --max-traces --max-steps --seed --fail-on --format {MODEL}",
}
"""The options that write no file."""


def actions() -> Iterator[tuple[str, str, argparse.Action]]:
    """Command, option and action, from the parsers of all commands."""
    for command in main.COMMANDS:
        parser = importlib.import_module(f"as2fm_lsp.cli.{command}").parser()
        for action in parser._actions:
            if action.dest not in ("help", "verbosity"):
                yield command, next((o for o in action.option_strings if o.startswith("--")), action.dest), action


def pairs(table: dict[str, str]) -> set[tuple[str, str]]:
    return {(command, option) for command, options in table.items() for option in options.split()}


def test_every_option_is_classified() -> None:
    """A new option fails here until it is listed in one of the tables above."""
    options = [(command, option) for command, option, _ in actions()]
    tables = [pairs(table) for table in (FILES, FOLDERS, IN_PLACE, NOTHING)]
    assert set(options) == set.union(*tables)
    assert sum(map(len, tables)) == len(options)


def test_the_options_of_the_main_program_are_those_of_check_and_serve() -> None:
    known = {option for command, option, _ in actions() if command in ("check", "serve")}
    own = {action.dest for action in main.parser()._actions} - {"help", "version", "explain", "check", "verbosity"}
    assert own == {option.removeprefix("--").replace("-", "_") for option in known}


def test_the_parsers_know_which_options_write() -> None:
    """`outputs_of` finds outputs and inputs by the types of their values."""
    for command, option, action in actions():
        value = action.type("run.html") if callable(action.type) and action.metavar in ("FILE", "DIR") else None
        assert isinstance(value, OutputPath) == ((command, option) in pairs(FILES)), (command, option)
        assert isinstance(value, OutputFolder) == ((command, option) in pairs(FOLDERS)), (command, option)
        is_input = action.metavar == "FILE" and (command, option) in pairs(NOTHING) | pairs(IN_PLACE)
        if is_input and option not in ("--socket",):
            assert isinstance(value, InputPath), (command, option)


def arguments(command: str, option: str, output: str) -> list[str]:
    call = {
        "check": ["."],
        "verify": ["--max-traces=10", "--traces-limit=1", "--property=all_delivered"],
        "experiment": ["--max-traces=10", "--property=all_delivered"],
        "compare": ["other/main.xml", "--structure"],
    }.get(command, [])
    return [command, *(["main.xml"] if command != "check" else []), *call, f"{option}={output}"]


@pytest.fixture
def robot(command: Command, tmp_path: Path) -> Path:
    """The robot of `init`, with other models in its folder that no system lists."""
    assert command("init", ".").status == 0
    other = tmp_path / "other"
    other.mkdir()
    for name in ("main.xml", "tree.xml", "nodes/battery.ascxml", "properties.jani"):
        (other / Path(name).name).write_bytes((tmp_path / name).read_bytes())
    (other / "model.jani").write_text('{"jani-version": 1, "name": "by hand", "type": "dtmc", "automata": []}')
    (other / "tree.mocks").write_text("*: 0.9\n")
    (other / "Level.msg").write_text("int32 level\n")
    (tmp_path / "as2fm.toml").write_text('ignore = ["unused-variable"]\n')
    (other / "link.svg").symlink_to(tmp_path / "main.xml")
    return tmp_path


def contents(folder: Path) -> dict[Path, bytes]:
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def one_of_each_kind(paths: Iterable[Path]) -> Iterable[Path]:
    """One file of each folder and suffix; in `other` are the models that no system lists."""
    return {(path.parent, path.suffix): path for path in sorted(paths)}.values()


@pytest.mark.parametrize(("command_name", "option"), sorted(pairs(FILES)))
def test_files_that_are_kept(command: Command, robot: Path, command_name: str, option: str) -> None:
    """All files for an option that writes translations, which has a rule of its own, and for another option; files of
    each kind for the others, which call the same function."""
    if option in ("--explain", "--plot"):  # their files have other names
        for path in [path for path in robot.rglob("*") if path.suffix in (".xml", ".ascxml", ".svg")]:
            path.with_suffix(f"{path.suffix}.html").symlink_to(path)
    kept = contents(robot)
    is_whole = (command_name, option) in (("translate", "--output"), ("simulate", "--svg"))
    for path in sorted(kept) if is_whole else one_of_each_kind(kept):
        if option in ("--explain", "--plot") and path.suffix != ".html":
            continue
        done = command(*arguments(command_name, option, os.path.relpath(path, robot)))
        assert done.status == 2, (path, done.err)
        assert "write the output to another file" in done.err
        assert "Traceback" not in done.err
        assert contents(robot) == kept


@pytest.mark.parametrize(("command_name", "option"), sorted(pairs(FILES)))
def test_an_output_replaces_an_older_output(command: Command, robot: Path, command_name: str, option: str) -> None:
    name = "out.html"
    if (command_name, option) == ("translate", "--output"):
        name = "out.jani"
    status = {command(*arguments(command_name, option, name)).status for _ in range(2)}
    assert len(status) == 1
    assert status < {0, 1}
    new = (robot / name).read_bytes()
    (robot / name).write_bytes(b" \n")  # a file without content, such as that of `mktemp`
    assert {command(*arguments(command_name, option, name)).status} == status
    assert len((robot / name).read_bytes()) == len(new)


@pytest.mark.parametrize(("command_name", "option"), sorted(pairs(FOLDERS)))
def test_folders_with_files_that_are_kept(command: Command, robot: Path, command_name: str, option: str) -> None:
    """Names that would be written are taken by models: nothing is written. Older outputs are replaced."""
    call = arguments(command_name, option, "out")
    assert command(*call).status in (0, 1)
    assert command(*call).status in (0, 1)
    written = sorted(path for path in (robot / "out").iterdir())
    assert written
    for path in (written[0], written[-1]):
        model = (robot / ("other/model.jani" if path.suffix == ".json" else "nodes/battery.ascxml")).read_bytes()
        old = path.read_bytes()
        path.write_bytes(model)
        kept = contents(robot)
        done = command(*call)
        assert done.status == 2
        assert path.name in done.err
        assert contents(robot)[path] == model
        if command_name == "translate":
            assert contents(robot) == kept
        path.write_bytes(old)


@pytest.mark.parametrize(
    ("call", "kept"),
    [
        ("simulate main.xml --script run.json --csv run.json", "run.json"),
        ("simulate main.xml --script run.json --save run.json", "run.json"),
        ("simulate main.xml --svg out --html ./out", "out"),
        ("simulate main.xml --svg - --html -", ""),
        ("check . --baseline known --output known", "known"),
        ("check main.xml --stdin-filename text.txt --output text.txt", "text.txt"),
        ("check main.xml --output ./nodes/../main.xml", ""),
        ("draw other/tree.xml --mocks names --output names", "names"),
        ("simulate other/tree.xml --mocks names --svg names", "names"),
        ("translate main.xml --map out.jani -o out.jani", ""),
        ("translate main.xml --map model.jani", "model.jani"),
        ("verify main.xml --resume state.html --explain=state.html", ""),
        ("verify main.xml --resume main.xml", ""),
        ("check main.xml --baseline main.xml", ""),
        ("serve --socket main.xml", ""),
        ("init .", ""),
    ],
)
def test_inputs_of_options_are_kept(command: Command, robot: Path, call: str, kept: str) -> None:
    (robot / "names").write_text("*: 0.9\n")
    (robot / "out").write_text("older output")
    (robot / "text.txt").write_text("text")
    for name, *written in (
        ("run.json", "simulate", "main.xml", "--save"),
        ("model.jani", "translate", "main.xml", "-o"),
        ("known", "check", ".", "--baseline"),
    ):
        if name in call:
            command(*written, name)
    before = contents(robot)
    assert kept == "" or robot / kept in before
    done = command(*call.split())
    assert done.status == 2
    assert done.err.startswith("as2fm-lsp: ")
    assert contents(robot) == before


def test_the_terminal_keeps_models(command: Command, robot: Path) -> None:
    before = contents(robot)
    done = command("simulate", "main.xml", "-i", stdin=b"w main.xml\nw other/model.jani\nw run.json\nw run.json\nq\n")
    assert done.out.count("write the output to another file") == 2
    assert done.out.count("written to run.json") == 2
    after = contents(robot)
    assert {path for path in after if after[path] != before.get(path)} == {robot / "run.json"}


def test_only_these_modules_write_without_the_check() -> None:
    """Those that change files on purpose, or that only create files, and the server, which calls the check itself."""
    server = Path(main.__file__).parents[2]
    writers = {
        path.relative_to(server / "as2fm_lsp").as_posix()
        for path in server.rglob("*.py")
        if "import write_file" in path.read_text(encoding="utf-8")
    }
    own = {f"cli/{name}.py" for name in ("check", "format", "migrate", "init", "baseline", "build_kernel")}
    others = (
        "handlers/translate.py",
        "kept_points.py",
        "mocked_models.py",
        "outputs.py",
        "verification/saved_state.py",
    )
    assert writers == {*own, *others}
