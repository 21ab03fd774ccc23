# SPDX-License-Identifier: Apache-2.0
"""`as2fm/parting`: where a counterexample parts from the nearest trace with the opposite verdict."""

from __future__ import annotations

import itertools
import shutil
from pathlib import Path

from client import connect
from test_lsp_verify import EXAMPLE, QUICK, ask, verify, why

from as2fm_lsp.handlers.parting import PARTING


async def test_a_counterexample_parts_from_the_nearest_passing_trace(tmp_path: Path) -> None:
    shutil.copytree(EXAMPLE, tmp_path / "robot")
    main = tmp_path / "robot" / "main_with_bug.xml"
    params = {"textDocument": {"uri": main.as_uri()}, "property": "block_placed"}
    async with connect(tmp_path) as client:
        assert await ask(client, PARTING, params) is None
        await verify(client, main, ["block_placed"], QUICK)
        parting = await ask(client, PARTING, params)
        witness = await ask(client, PARTING, {**params, "witness": True})
        trace = await why(client, main, "block_placed")
    assert parting["heading"].startswith(f"trace {parting['trace']} passed: the first ")
    assert witness["heading"].startswith(f"trace {witness['trace']} failed: the first ")
    assert parting["seed"] == trace["seed"]
    assert parting["trace"] != trace["trace"]
    here, there = parting["here"], parting["there"]
    # The arm loses the block by chance.
    assert here["uri"] == there["uri"] == main.with_name("arm.ascxml").as_uri()
    assert "sends /block/dropped (data: true)" in here["details"]
    assert here["details"] != there["details"]
    # It is a turn of the counterexample, and highlighted like it.
    assert [turn["highlights"] for turn in trace["steps"] if turn["step"] == here["step"]] == [here["highlights"]]
    # The steps of both traces are aligned up to the turns that differ.
    aligned = parting["alignment"]
    assert (aligned["here"]["step"], aligned["there"]["step"]) == (here["step"] - 1, there["step"] - 1)
    assert aligned["here"]["end"] >= trace["steps"][-1]["lastStep"]
    assert all(
        earlier[0] < later[0] and earlier[1] <= later[1]
        for earlier, later in itertools.pairwise([*aligned["pairs"], [here["step"], there["step"]]])
    )
