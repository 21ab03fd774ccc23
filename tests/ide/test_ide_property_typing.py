# SPDX-License-Identifier: Apache-2.0
"""A property file typed character by character: every feature answers at every prefix."""

from __future__ import annotations

from pathlib import Path

from ide_models import load

from fixture import split_files
from property_robot import ROBOT
from roaml.ide.code_lens import lenses
from roaml.ide.completion import complete
from roaml.ide.hover import hover
from roaml.ide.inlay_hints import inlay_hints
from roaml.ide.navigation import references
from roaml.ide.navigation.document_symbols import document_symbols
from roaml.ide.rename import prepare
from roaml.ide.semantic_tokens import semantic_tokens
from roaml.project.settings import Settings
from roaml.project.workspace import Workspace
from roaml.text import Span

TYPED = """\
<properties>
  <ports>
    <ros_topic topic_name="/pose" type="std_msgs/Header" event="publish">
      <state_var id="x" type="int32" field="stamp.sec" expr="0"/><event_var id="moved"/>
    </ros_topic>
    <bt_node node="Left/pick" event="response"><state_var id="s" type="int32" field="status" expr="0"/></bt_node>
    <scxml_event_send event="full"><state_var id="n" type="int32" param="amount" expr="0"/></scxml_event_send>
  </ports>
  <guarantees>
    <property id="p" pattern="response">
      <events><event>x &lt; 3 &amp;&amp; moved</event><event>s == 1</event></events>
      <scope type="between" event="moved" until="n &gt; 1"/>
      <time_interval after="1" within="2.5" time_unit="s"/>
    </property>
    <property id="q" logic="pmtl" expr="{ moved } -&gt; O[:3] { s == 1 }"/>
  </guarantees>
</properties>
"""


def test_typing(tmp_path: Path) -> None:
    load(tmp_path, split_files(ROBOT))
    path, main = str(tmp_path / "properties.xml"), str(tmp_path / "main.xml")
    workspace = Workspace((str(tmp_path),), Settings())
    workspace.open(main, (tmp_path / "main.xml").read_text(encoding="utf-8"))
    for end in range(len(TYPED) + 1):
        text = TYPED[:end]
        workspace.open(path, text)
        snapshot = workspace.snapshot()
        analysis = snapshot.analysis
        codes = {diagnostic.code for diagnostic in snapshot.checker.diagnostics(path)}
        assert "internal-error" not in codes, text
        complete(snapshot, path, end)
        for offset in {end, max(0, end - 1)}:
            hover(analysis, path, offset)
            references(analysis, path, offset)
            prepare(analysis, path, offset)
        whole = Span(0, end)
        inlay_hints(analysis, path, whole)
        lenses(analysis, path)
        document_symbols(analysis, path)
        semantic_tokens(analysis, path)
    assert codes <= {"port-of-several-clients"}
    assert main in analysis.systems_of(path)
