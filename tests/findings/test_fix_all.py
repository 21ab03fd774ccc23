# SPDX-License-Identifier: Apache-2.0
"""Several fixes that are applied at once (`roaml.project.fixing`)."""

from __future__ import annotations

from pathlib import Path

from fixture import write_files
from mending import workspace_of
from roaml.diagnostics import Diagnostic, Fix
from roaml.project.fixing import fix_all
from roaml.text import Span, TextEdit


def test_no_fix_brings_an_error_to_another_file(tmp_path: Path) -> None:
    """The fix removes what is reported in one file and breaks another file of the same system."""
    talker = (
        '<ascxml name="Talker" version="1.0" initial="a"><datamodel><data id="n" type="int32" expr="0"/></datamodel>'
        '<ros_topic_publisher name="out" topic="/told" type="std_msgs/Int32"/>'
        '<state id="a"><transition event="go" target="a"><ros_topic_publish name="out">'
        '<field name="data" expr="1"/></ros_topic_publish></transition></state></ascxml>'
    )
    hearer = (
        '<ascxml name="Hearer" version="1.0" initial="a">'
        '<ros_topic_subscriber name="told" topic="/told" type="std_msgs/Int32"/>'
        '<state id="a"><ros_topic_callback name="told" target="a"><send event="go"/></ros_topic_callback></state>'
        "</ascxml>"
    )
    inputs = "".join(f'<input type="node-ascxml" src="{name}.ascxml"/>' for name in ("talker", "hearer"))
    main = (
        f'<roaml><parameters><max_time value="1" unit="s"/></parameters><node_models>{inputs}</node_models>'
        '<properties><input type="jani" src="p.jani"/></properties></roaml>'
    )
    texts = {"talker.ascxml": talker, "hearer.ascxml": hearer, "main.xml": main, "p.jani": '{"properties": []}'}
    write_files(tmp_path, "".join(f"-- {name} --\n{text}\n" for name, text in texts.items()))
    snapshot = workspace_of(tmp_path).snapshot()
    path = str(tmp_path / "talker.ascxml")
    source = snapshot.analysis.source(path)
    assert source is not None
    at = source.text.index("/told")
    harmful = Fix("Break the other file", (TextEdit(Span(at, at + 5), "/untold"),), safe=True)

    def chosen(diagnostic: Diagnostic) -> Fix | None:
        return harmful if diagnostic.code == "unused-variable" else None

    assert fix_all(snapshot, [path], chosen, careful=True) == {}
    [(_, text)] = fix_all(snapshot, [path], chosen, careful=False).items()
    assert "/untold" in text
