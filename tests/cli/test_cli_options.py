# SPDX-License-Identifier: Apache-2.0
"""The options of the command, and its exit status: 0 clean, 1 errors found, 2 usage error, 3 internal error."""

from __future__ import annotations

import os
import sys
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path

import pytest
from command import Command

import clock
import roaml.project.checking
from as2fm_lsp.cli import kernel_note
from as2fm_lsp.cli.main import COMMANDS
from roaml import __version__, api
from roaml.record import replace
from roaml.rules import RULES
from roaml.smc import kernel


def test_clean(command: Command, tmp_path: Path) -> None:
    clock.write(tmp_path)
    done = command("--check", "main.xml")
    assert done == (0, "3 files checked: no diagnostics\n", "")


def test_errors(command: Command, tmp_path: Path) -> None:
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    done = command("--check", "main.xml")
    assert done.status == 1
    assert done.out == (
        "clock.ascxml:9:31: error: there is no variable `coutn`; did you mean `count`? [undeclared-variable]\n"
        '    9 |             <assign location="coutn" expr="(count + 1) % 10" />\n'
        "      |                               ^^^^^\n"
        "3 files checked: 1 error\n"
    )
    assert not done.err


def test_less_than_errors_is_clean_unless_asked_for(command: Command, tmp_path: Path) -> None:
    clock.write(tmp_path, clock=clock.UNHEARD_CLOCK)
    done = command("--check", ".")
    assert (done.status, done.out.splitlines()[-1]) == (0, "3 files checked: 1 hint")
    (tmp_path / "as2fm.toml").write_text('severity = { topic-without-subscriber = "warning" }\n')
    assert command("--check", ".").status == 0
    assert command("--check", ".", "--warnings-as-errors").status == 1
    assert command("--check", ".", "--warnings-as-errors", "--severity", "error").status == 0
    (tmp_path / "as2fm.toml").write_text(
        'severity = { topic-without-subscriber = "warning" }\nwarnings-as-errors = true\n'
    )
    assert command("--check", ".").status == 1


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["--check"], "--check needs at least one PATH"),
        (["--check", "nowhere.xml"], "there is no such file or folder"),
        (["--check", ".", "--select", "no-such-rule"], "there is no rule `no-such-rule`"),
        (["--check", ".", "--ignore", "xml-syntax,no-such-rule"], "there is no rule `no-such-rule`"),
        (["--check", ".", "--format", "html"], "invalid choice: 'html'"),
        (["--check", ".", "--severity", "fatal"], "invalid choice: 'fatal'"),
        (["--check", ".", "--frobnicate"], "unrecognized arguments: --frobnicate"),
        (["--check", ".", "--output"], "expected one argument"),
        (["--check", ".", "--stdin-filename", "."], "needs the name of a file"),
        (["."], "need --check; see --help"),
        (
            ["main.xml"],
            "there is no command or file `main.xml`; the commands are `check`, `explain`, `serve`, `format`",
        ),
        (["verfy", "main.xml", "--expect", "p > 0.5"], "there is no command `verfy`; did you mean `verify`?"),
        (["Translate", "main.xml"], "there is no command `Translate`; did you mean `translate`?"),
        (["chekc", "main.xml"], "there is no command `chekc`; did you mean `check`?"),
        (["check"], "check needs at least one PATH"),
        (["check", ".", "--frobnicate"], "unrecognized arguments: --frobnicate"),
        (["explain", "unknwon-element"], "there is no rule `unknwon-element`; did you mean `unknown-element`?"),
        (["serve", "main.xml"], "unrecognized arguments: main.xml"),
        (["serve", "--tcp", "nonsense"], "--tcp needs HOST:PORT"),
        (["help"], "there is no command `help`; did you mean `--help`?"),
        (["--chekc", "."], "unrecognized arguments: --chekc; did you mean `--check`?"),
        (["verify", ".", "--epsilom=0.1"], "unrecognized arguments: --epsilom=0.1; did you mean `--epsilon`?"),
        (["verify", ".", "--method", "spr"], "did you mean `sprt`?"),
        (["--check", ".", "--ignore", "unknwn-type"], "there is no rule `unknwn-type`; did you mean `unknown-type`?"),
        (["--check", ".", "--select", "unknwn-type,xml-syntx"], "`xml-syntx`; did you mean `xml-syntax`?"),
        (["--format", "json"], "need --check; see --help"),
        (["--explain", "unknwon-element"], "there is no rule `unknwon-element`; did you mean `unknown-element`?"),
        (["--explain", ""], "there is no rule"),
        (["--tcp", "nonsense"], "--tcp needs HOST:PORT"),
        (["--tcp", "localhost:99999"], "--tcp needs HOST:PORT"),
        (["--tcp", "localhost:²"], "--tcp needs HOST:PORT"),
        (["init"], "one of the arguments DIR --mocks is required"),
        (["migrate"], "the following arguments are required: PATH"),
        (["migrate", "nowhere"], "there is no such file or folder"),
        (["translate", "main.xml", "--indent", "two"], "expected a number of spaces from 0 to 16"),
        (["translate", "main.xml", "--indent", "17"], "expected a number of spaces from 0 to 16"),
        (["translate", "main.xml", "--max-array-size", "many"], "expected a whole number of at least 1"),
    ],
)
def test_wrong_use(command: Command, arguments: list[str], complaint: str) -> None:
    done = command(*arguments)
    assert done.status == 2
    assert complaint in done.err
    assert not done.out


def test_all_commands_count_the_same_files(command: Command, tmp_path: Path) -> None:
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    summary = "3 files checked: 1 error"
    assert command("--check", "main.xml").out.splitlines()[-1] == summary
    for name in ("translate", "verify"):
        assert summary in command(name, "main.xml").err.splitlines(), name
    (tmp_path / "clock.ascxml").write_text(clock.CLOCK)
    command("translate", "main.xml")
    (tmp_path / "main.jani").write_text((tmp_path / "main.jani").read_text().replace('"automata"', '"automaton"'))
    assert any(line.startswith("1 file checked: ") for line in command("verify", "main.jani").err.splitlines())


def test_help_shows_every_option_with_examples(command: Command) -> None:
    done = command("--help")
    assert done.status == 0
    for word in ("--check", "--ros-path", "--baseline", "--explain", "init", "migrate", "examples:", "exit status:"):
        assert word in done.out


@pytest.mark.parametrize("name", COMMANDS)
def test_each_command_is_listed_and_has_help_with_an_example(command: Command, name: str) -> None:
    assert f"\n  {name} " in command("--help").out
    done = command(name, "--help")
    assert (done.status, done.err) == (0, "")
    assert done.out.startswith(f"usage: as2fm-lsp {name}")
    assert f"\n  as2fm-lsp {name}" in done.out
    assert "exit status" in done.out


def test_commands_do_what_the_options_do(command: Command, tmp_path: Path) -> None:
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    for more in (["main.xml"], ["main.xml", "--format", "json"], [".", "--severity", "error", "--statistics"]):
        assert command("check", *more) == command("--check", *more)
    assert command("check", "main.xml").status == 1
    assert command("explain", "unknown-type") == command("--explain", "unknown-type")
    assert command("serve", "--allow-remote") == command("--allow-remote")


def test_a_folder_named_like_a_command_is_checked(command: Command, tmp_path: Path) -> None:
    for name in ("check", "serve"):
        (tmp_path / name).mkdir()
        clock.write(tmp_path / name, clock=clock.WRONG_CLOCK)
        assert command(name, "--check").out.splitlines()[-1] == "3 files checked: 1 error"


def test_version(command: Command) -> None:
    status, out, err = command("--version")
    first, kernel_line = out.splitlines()
    assert (status, first, err) == (0, f"as2fm-lsp {__version__}", "")
    assert kernel_line.startswith("kernel: compiled" if kernel.compiled() else "kernel: plain Python, 12 to 37 times")


def test_a_plain_kernel_is_named_once(command: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kernel_note, "is_compiled", lambda: False)
    examples = Path(__file__).parents[2] / "examples"
    done = command("verify", str(examples / "grid_world/main.xml"), "--method", "fixed", "--max-traces", "2")
    assert done.err.count("plain Python") == 1
    assert f"`{sys.executable} -m as2fm_lsp.cli.build_kernel`" in done.err
    assert "plain Python" in command("--version").out


def test_compiled_modules_older_than_their_sources_are_named(tmp_path: Path) -> None:
    package = tmp_path / "server/roaml"
    (package / "smc").mkdir(parents=True)
    source, compiled = package / "smc/kernel.py", package / f"smc/kernel{EXTENSION_SUFFIXES[0]}"
    source.touch()
    compiled.touch()
    os.utime(source, (100, 100))
    os.utime(compiled, (200, 200))
    os.utime(source, (300, 300))
    assert kernel_note.outdated_modules(package) == []  # an installed wheel
    (tmp_path / "setup.py").touch()
    assert kernel_note.outdated_modules(package) == ["roaml.smc.kernel"]
    os.utime(source, (100, 100))
    assert kernel_note.outdated_modules(package) == []


def test_outdated_modules_are_a_warning(command: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kernel_note, "outdated_modules", lambda: ["roaml.smc.kernel"])
    assert "roaml.smc.kernel must be compiled again" in command("--version").out
    assert kernel_note.kernel_warning().startswith("warning: roaml.smc.kernel must be compiled again")


def test_explain(command: Command) -> None:
    done = command("--explain", "unknown-element")
    assert done.status == 0
    assert done.out.startswith("# unknown-element\n")
    assert "## Why" in done.out


def test_select_and_ignore(command: Command, check: Command, tmp_path: Path) -> None:
    both = clock.UNHEARD_CLOCK.replace('location="count"', 'location="coutn"')
    clock.write(tmp_path, clock=both)
    assert check(".").codes == ["topic-without-subscriber", "undeclared-variable"]
    assert check(".", "--select", "undeclared-variable").codes == ["undeclared-variable"]
    assert check(".", "--select", "undeclared-variable, topic-without-subscriber").status == 1
    assert check(".", "--select", "undeclared-variable", "--select", "topic-without-subscriber").codes == [
        "topic-without-subscriber",
        "undeclared-variable",
    ]
    done = check(".", "--ignore", "undeclared-variable")
    assert (done.status, done.codes) == (0, ["topic-without-subscriber"])
    assert check(".", "--ignore", "undeclared-variable,topic-without-subscriber").codes == []
    assert check(".", "--severity", "error").codes == ["undeclared-variable"]
    assert check(".", "--severity", "warning").codes == ["undeclared-variable"]
    assert check(".", "--severity", "hint").codes == ["topic-without-subscriber", "undeclared-variable"]


def test_what_is_selected_is_not_ignored_by_the_configuration(check: Command, tmp_path: Path) -> None:
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    (tmp_path / "as2fm.toml").write_text('ignore = ["undeclared-variable"]\n')
    assert check(".").codes == []
    assert check(".", "--select", "undeclared-variable").codes == ["undeclared-variable"]


def test_statistics(command: Command, tmp_path: Path) -> None:
    clock.write(tmp_path, clock=clock.UNHEARD_CLOCK.replace("count + 1", "coutn + conut"))
    done = command("--check", ".", "--statistics")
    assert done.status == 1
    assert done.out == "     2 error        undeclared-variable\n     1 hint         topic-without-subscriber\n"


def crash(_: object) -> None:
    raise ZeroDivisionError("a mistake of ours")


def test_a_crashing_rule_is_an_internal_error_whatever_is_shown(
    check: Command, command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The other rules continue, and no option hides the internal error."""
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    rules = [replace(r, machine=crash) if r.code == "undefined-state" else r for r in RULES]
    monkeypatch.setattr(roaml.project.checking, "RULES", rules)
    done = check("clock.ascxml")
    assert done.status == 3
    assert sorted(done.codes) == ["internal-error", "undeclared-variable"]
    assert "`undefined-state` failed (ZeroDivisionError: a mistake of ours)" in done.rows[0]["message"]
    for options in (
        ["--select", "undeclared-variable"],
        ["--ignore", "internal-error"],
        ["--severity", "error"],
        ["--baseline", "known.json"],
        ["--baseline", "known.json"],
    ):
        assert command("--check", "clock.ascxml", *options).status == 3, options


def test_a_crash_outside_of_rules(command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    clock.write(tmp_path)
    monkeypatch.setattr(api, "check", crash)
    done = command("--check", ".")
    assert done.status == 3
    assert "Traceback" in done.err
    assert "internal error; please report it" in done.err


def test_an_interrupt_is_quiet(command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    clock.write(tmp_path)
    monkeypatch.setattr(api, "check", interrupt)
    assert command("--check", ".") == (130, "", "")
