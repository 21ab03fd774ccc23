# SPDX-License-Identifier: Apache-2.0
"""What an editor asks before an experiment: lenses, parameters, and a number that becomes a parameter."""

from __future__ import annotations

import shutil
from pathlib import Path

from client import connect
from test_lsp_expectations import changed
from test_lsp_verify import ask, lenses

from as2fm_lsp.handlers.experiment import EXPERIMENT, NEW_PARAMETER

EXAMPLES = Path(__file__).parents[2] / "examples"


async def test_a_number_of_a_system_becomes_a_parameter(tmp_path: Path) -> None:
    """The lens of the system is there at once, that of the parameter after the edit."""
    folder = tmp_path / "robot"
    shutil.copytree(EXAMPLES / "delivery_robot", folder)
    main = folder / "main.xml"
    document = {"textDocument": {"uri": main.as_uri()}}
    async with connect(folder, options={"experiment": "editor.experiment"}) as client:
        text = main.read_text(encoding="utf-8")
        client.open(main, text, language="xml")
        assert "Experiment" in await lenses(client, main)
        form = await ask(client, EXPERIMENT, document)
        assert form["parameters"] == []
        assert {"all_delivered", "never_empty"} <= {property_["name"] for property_ in form["properties"]}
        number = next(n for n in form["numbers"] if n["place"].startswith("battery.ascxml: <data"))
        asked = {"textDocument": {"uri": number["uri"]}, "offset": number["offset"]}
        edit = await ask(client, NEW_PARAMETER, asked)
        assert await ask(client, NEW_PARAMETER, {**asked, "offset": 0}) is None
        in_machine, in_system = edit["changes"].values()
        machine = folder / "nodes/battery.ascxml"
        assert number["uri"] == machine.as_uri()
        declared = changed(text, in_system)
        client.open(machine, changed(machine.read_text(encoding="utf-8"), in_machine))
        client.replace(main, declared)
        (parameter,) = (await ask(client, EXPERIMENT, document))["parameters"]
        assert (parameter["value"], parameter["limits"]) == (number["text"], "")
        assert f"Try other values of {parameter['name']}" in await lenses(client, main)


async def test_a_file_with_arguments_is_checked_and_run(tmp_path: Path) -> None:
    for name in ("battery", "delivery_robot"):
        shutil.copytree(EXAMPLES / name, tmp_path / name)
    file = tmp_path / "battery/battery.experiment.toml"
    text = file.read_text(encoding="utf-8")
    async with connect(tmp_path, options={"experiment": "editor.experiment"}) as client:
        client.open(file, text.replace("capacity", "capacty"), language="toml")
        (found,) = await client.until_codes(file, "invalid-setting")
        assert "did you mean `capacity`?" in found.message
        client.replace(file, text)
        await client.until_codes(file)
        assert await lenses(client, file) == ["Run the experiment"]
