# SPDX-License-Identifier: Apache-2.0
"""Expressions of watches and conditions have the semantics and the limits of the model, and programs that cannot be
read are refused."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from dap_client import Client

from roaml.debugging.evaluate import MAX_STEPS, Scope, WatchError, evaluate, parsed
from roaml.debugging.values import Value

ROBOT = Path(__file__).resolve().parents[2] / "examples" / "assembly_robot"
MAX_INT = 2**63 - 1


def value(text: str, **variables: Value) -> Value:
    return evaluate(parsed(text), variables.get)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("Math.pow(2, 10)", 1024.0),
        ("Math.pow(2, 0.5)", 2**0.5),
        ("7 / 2", 3.5),
        ("-7 % 3", 2),
        ("-7 % -3.0", 2.0),
        ("Math.floor(-0.5)", -1),
        ("Math.max(1, 2.5)", 2.5),
        ("Math.min(1, 2.5)", 1.0),
        ("Math.max(1, 3, 2)", 3),
        ("n + 0", MAX_INT),
        ("n == n + 0.5", True),  # a comparison with a real is one of reals
        ("n >= 9223372036854775807.5", True),
        ("[1, 2] == [1, 2]", True),
    ],
)
def test_values(text: str, expected: Value) -> None:
    result = value(text, n=MAX_INT)
    assert (result, type(result)) == (expected, type(expected))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("Math.pow(9, 30000000)", "too large"),
        ("Math.pow(9, 1e308)", "too large"),
        ("Math.pow(-1, 0.5)", "has no value"),
        ("Math.pow(0, -1)", "has no value"),
        ("n + 1", "64 bits"),
        ("-n - 2", "64 bits"),
        ("n * n", "64 bits"),
        ("n * n * n / n", "64 bits"),
        ("Math.abs(-n - 1)", "64 bits"),
        ("Math.floor(1e300 * 1.0)", "64 bits"),
        ("Math.floor(1e308 * 10.0)", "too large"),
        ("Math.log(0)", "has no value"),
        ("1 % 0", "division by zero"),
        ("1 / 0.0", "division by zero"),
    ],
)
def test_expressions_without_a_value(text: str, message: str) -> None:
    with pytest.raises(WatchError, match=message):
        value(text, n=MAX_INT)


def test_a_long_computation_ends() -> None:
    elements: list[Value] = [{"x": 1}] * (MAX_STEPS // 10)
    text = "[" + ", ".join(["a.x == a.x"] * 10) + "]"
    with pytest.raises(WatchError, match="steps"):
        value(text, a=elements)
    scope: Scope = {"a": elements}.get
    assert evaluate(parsed("a.x == a.x"), scope) is True


def test_a_run_with_a_costly_condition_can_be_paused() -> None:
    with Client() as client:
        client.launch(ROBOT / "main.xml", seed=3)
        lines = range(1, 200)
        for file in ("arm.ascxml", "tree.xml"):
            breakpoints = [{"line": line, "condition": "Math.pow(9, 30000000) == 1"} for line in lines]
            client.ask("setBreakpoints", source={"path": str(ROBOT / file)}, breakpoints=breakpoints)
        client.ask("configurationDone")
        client.event("stopped")
        client.ask("continue", threadId=1)
        client.ask("pause", threadId=1)
        assert client.event("stopped")["reason"] in ("pause", "end of the run")
        assert "too large" in client.refusal("evaluate", expression="Math.pow(9, 30000000)", context="watch")


@pytest.mark.parametrize(
    "program", ["", ".", "none.xml", "pipe.xml", "device.xml", "folder", "a\0b", "\ud800", "x" * 5000]
)
def test_programs_that_cannot_be_read(tmp_path: Path, program: str) -> None:
    os.mkfifo(tmp_path / "pipe.xml")
    (tmp_path / "device.xml").symlink_to("/dev/zero")
    (tmp_path / "folder").mkdir()
    with Client() as client:
        client.ask("initialize", adapterID="as2fm")
        message = client.refusal("launch", program=f"{tmp_path}/{program}" if program else "")
        assert any(
            reason in message for reason in ("not the path of a file", "folder", "no such", "regular", "be read")
        )
        client.launch(ROBOT / "main.xml")
