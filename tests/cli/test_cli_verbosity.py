# SPDX-License-Identifier: Apache-2.0
"""`--quiet` and `--verbose`, and lists that are complete where they are needed."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from command import Command

import clock
from as2fm_lsp.cli.main import COMMANDS, parser
from fixture import write_files
from roaml.project import explored_findings
from roaml.rules import RULES
from rule_files import examples

FEW_TRACES = ("--max-traces", "5", "--method", "fixed", "--scheduler", "uniform")


def test_a_quiet_check_writes_only_findings(command: Command, tmp_path: Path) -> None:
    main = clock.write(tmp_path)
    assert command("check", main, "--quiet") == (0, "", "")
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    loud, quiet = command("check", main), command("check", main, "-q")
    assert quiet.status == loud.status == 1
    assert loud.out.startswith(quiet.out)
    assert "checked" in loud.out
    assert "checked" not in quiet.out


def test_options_before_the_command(command: Command, tmp_path: Path) -> None:
    main = clock.write(tmp_path)
    assert command("-q", "check", main) == (0, "", "")
    assert command("--quiet", "--check", main) == (0, "", "")
    assert "settings: the defaults" in command("-v", "--tree-semantics", "as2fm", "check", main).err


def test_a_verbose_check_names_what_it_read(command: Command, tmp_path: Path) -> None:
    main = clock.write(tmp_path)
    (tmp_path / "as2fm.toml").write_text("")
    done = command("check", main, "--verbose")
    assert done.out == command("check", main).out
    lines = [line.removeprefix("as2fm-lsp: ") for line in done.err.splitlines()]
    assert lines[0] == "settings: as2fm.toml"
    assert "checked clock.ascxml" in lines
    assert re.fullmatch(r"\d+ files in \d+\.\d\d s", lines[-1])


def test_a_verbose_check_names_systems_that_are_too_large_to_be_explored(
    command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_files(tmp_path, examples("never-ticked", "Bad")[0].text)
    main = str(tmp_path / "main.xml")
    assert "too large" not in command("check", main, "--verbose").err
    monkeypatch.setattr(explored_findings, "MAX_PARTS", 1)
    assert "main.xml is too large to be explored, so these" in command("check", main, "--verbose").err
    assert "too large" not in command("check", main, "--verbose", "--ignore", ",".join(explored_findings.CODES)).err


def test_a_quiet_verification_writes_values_verdicts_and_warnings(command: Command, tmp_path: Path) -> None:
    main = clock.write(tmp_path)
    expect = ("--property", "ticks", "--expect", "ticks >= 0.5")
    done = command("verify", main, *FEW_TRACES, *expect, "--quiet")
    value, verdict = done.out.splitlines()
    assert value.startswith("ticks: ")
    assert verdict.startswith("  expected ≥ 0.5: ")
    assert done.err == ""


def test_a_verbose_verification_names_its_stages(command: Command, tmp_path: Path) -> None:
    done = command("verify", clock.write(tmp_path), *FEW_TRACES, "-v")
    stages = [re.sub(r": \d+\.\d\d s$", "", line) for line in done.err.splitlines()]
    assert stages == ["as2fm-lsp: reading and translating", "as2fm-lsp: compiling"]


def test_both_are_refused(command: Command, tmp_path: Path) -> None:
    done = command("check", ".", "--quiet", "--verbose")
    assert done.status == 2
    assert "not allowed with" in done.err


def test_the_usage_names_the_commands() -> None:
    usage = parser().format_usage()
    assert f"{{{','.join(COMMANDS)}}}" in usage


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_both_options(command: Command, name: str) -> None:
    said = command(name, "--help").out
    assert "--quiet" in said
    assert "--verbose" in said


def test_all_rules_are_listed(command: Command) -> None:
    listed = command("explain").out
    assert [line.split()[0] for line in listed.splitlines()] == sorted(rule.code for rule in RULES)
    assert "`as2fm-lsp explain` lists all rules" in command("explain", "qqqqq").err


def test_all_leaves_without_a_mock_are_listed(command: Command, tmp_path: Path) -> None:
    names = [f"Leaf{number}" for number in range(12)]
    leaves = "".join(f"<{name} />" for name in names)
    tree = f'<root BTCPP_format="4"><BehaviorTree ID="T"><Sequence>{leaves}</Sequence></BehaviorTree></root>'
    (tmp_path / "tree.xml").write_text(tree)
    said = command("verify", "tree.xml", "--mock", "Another: 1").err
    assert f"these leaves need mocks: {', '.join(names)};" in said


def test_all_properties_are_listed(command: Command, tmp_path: Path) -> None:
    said = command("verify", clock.write(tmp_path), "--expect", "qqqqq >= 0.5").err
    assert "`ticks`" in said
