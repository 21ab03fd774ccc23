# SPDX-License-Identifier: Apache-2.0
"""Any bytes, any order of requests, and a client that dies."""

from __future__ import annotations

import io
import json
from pathlib import Path

import pytest
import random_requests
from dap_client import Client
from hypothesis import given
from hypothesis import strategies as st

from as2fm_lsp.debug.framing import messages, write_message

ANY_CHARACTER = st.characters(exclude_categories=())
"""Also half of a surrogate pair, which UTF-8 cannot encode."""
BUG = Path(__file__).resolve().parents[2] / "examples" / "assembly_robot" / "main_with_bug.xml"


@pytest.mark.parametrize("seed", range(3))
def test_every_random_request_is_answered(seed: int) -> None:
    done, refused = random_requests.run(seed, 400, BUG)
    assert done > 100
    assert refused > 50


@given(st.binary(max_size=200))
def test_any_bytes_are_read(data: bytes) -> None:
    assert all(isinstance(message, dict) for message in messages(io.BytesIO(data)))


@given(st.lists(st.dictionaries(st.text(max_size=4), st.integers() | st.text(ANY_CHARACTER, max_size=4)), max_size=4))
def test_what_is_written_is_read(written: list[dict[str, object]]) -> None:
    stream = io.BytesIO()
    for message in written:
        write_message(stream, message)
    read = list(messages(io.BytesIO(stream.getvalue())))
    assert read == json.loads(json.dumps(written).encode("utf-8", "replace"))


@pytest.mark.parametrize(
    "noise",
    [
        b"\r\n\r\n",
        b"GET / HTTP/1.1\r\n\r\n",
        b"Content-Length: x\r\n\r\n",
        b"Content-Length: 2\r\n\r\n[]",
        b"Content-Length: 3\r\n\r\n{{{",
        b"Content-Length: 0\r\n\r\n",
        b"content-type: x\r\nX: y\r\n",
        b"\xff" * 9000,
    ],
)
def test_noise_between_messages_is_skipped(noise: bytes) -> None:
    with Client() as client:
        client.ask("initialize", adapterID="as2fm")
        client.raw(noise + b"\r\n")
        assert client.ask("threads") == {"threads": []}


def test_messages_that_are_not_requests_are_ignored() -> None:
    with Client() as client:
        for body in (b"{}", b'{"type": "event"}', b'{"type": "request", "command": 3}', b'{"type": "response"}'):
            client.write(body)
        assert client.ask("threads") == {"threads": []}


def test_paths_that_no_file_can_have_are_refused() -> None:
    with Client() as client:
        for command in ("setBreakpoints", "breakpointLocations"):
            for path in ("\0", "\ud800", "file:///%00", "file:///\udfff"):
                assert client.refusal(command, source={"path": path}, line=1) == "`path` is not a path"


@pytest.mark.parametrize("closes", ["stdin", "stdout"])
def test_a_client_that_dies_ends_the_adapter(closes: str, tmp_path: Path) -> None:
    model = tmp_path / "endless.jani"
    model.write_text(ENDLESS, encoding="utf-8")
    with Client() as client:
        client.begin(model, stopOnEntry=True)
        client.ask("continue", threadId=2)
        stream = client.process.stdin if closes == "stdin" else client.process.stdout
        assert stream is not None
        stream.close()
        if closes == "stdout":
            client.send("threads")
        assert client.process.wait() == 0
        client.process.stdin = None if closes == "stdin" else client.process.stdin


ENDLESS = """{
    "jani-version": 1, "name": "endless", "type": "mdp", "features": [],
    "variables": [{"name": "x", "type": {"kind": "bounded", "base": "int", "lower-bound": 0, "upper-bound": 1},
        "initial-value": 0}],
    "automata": [{"name": "A", "locations": [{"name": "l"}], "initial-locations": ["l"], "edges": [
        {"location": "l", "destinations": [{"location": "l",
            "assignments": [{"ref": "x", "value": {"op": "-", "left": 1, "right": "x"}}]}]}]}],
    "system": {"elements": [{"automaton": "A"}]},
    "properties": []
}"""
