# SPDX-License-Identifier: Apache-2.0
"""Property files in XML and JANI, typed character by character: every feature answers at every prefix.

Without `AS2FM_EXAMPLES`, a sample of the prefixes is tried.
"""

from __future__ import annotations

from pathlib import Path

from ide_models import load

from examples import TIMES
from fixture import split_files
from property_robot import ROBOT
from roaml.ide.code_actions import actions
from roaml.ide.code_lens import counted, lenses
from roaml.ide.completion import complete
from roaml.ide.expectation import in_property_file
from roaml.ide.folding_range import folds
from roaml.ide.formatting import can_format, format_edits
from roaml.ide.formatting.layout import FileLayout
from roaml.ide.hover import hover
from roaml.ide.inlay_hints import inlay_hints
from roaml.ide.linked_editing import linked_names
from roaml.ide.navigation import definition, references
from roaml.ide.navigation.document_symbols import document_symbols
from roaml.ide.on_type import close_tag
from roaml.ide.rename import prepare
from roaml.ide.selection_range import selections
from roaml.ide.semantic_tokens import semantic_tokens
from roaml.ide.signature_help import signature_help
from roaml.ide.verifiable import fingerprint, verifiable
from roaml.project.settings import Settings
from roaml.project.workspace import Snapshot, Workspace
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
    <property id="p" pattern="response" expect="&gt;= 0.9">
      <events><event>x &lt; 3 &amp;&amp; moved</event><event>s == 1</event></events>
      <scope type="between" event="moved" until="n &gt; 1"/>
      <time_interval after="1" within="2.5" time_unit="s"/>
    </property>
    <property id="q" logic="pmtl" expr="{ moved } -&gt; O[:3] { s == 1 }"/>
  </guarantees>
</properties>
"""


TYPED_JANI = """\
{"properties": [
  {"name": "picked", "comment": "It is picked.", "expression": {"op": "filter", "fun": "values", "values":
    {"op": "≥", "left": {"op": "Pmin", "exp": {"op": "U", "left": true, "step-bounds": {"upper": 9}, "right":
      {"op": "∧", "left": {"op": "=", "left": "bt_1004_response__status", "right": 1}, "right":
        "bt_1004_response.valid"}}}, "right": 0.9},
    "states": {"op": "initial"}}},
  {"name": "late", "expression": {"op": "filter", "fun": "values", "states": {"op": "initial"}, "values":
    {"op": "Emax", "exp": 1, "accumulate": ["steps"], "reach": {"op": "¬", "exp": "full.valid"}}}}
]}
"""


def test_typing_xml(tmp_path: Path) -> None:
    load(tmp_path, split_files(ROBOT))
    assert type_file(tmp_path, "properties.xml", TYPED) <= {"port-of-several-clients", "unportable-expectation"}


def test_typing_jani(tmp_path: Path) -> None:
    texts = split_files(ROBOT)
    texts["main.xml"] = texts["main.xml"].replace(
        'type="xml" src="properties.xml"', 'type="jani" src="properties.jani"'
    )
    load(tmp_path, {**texts, "properties.jani": TYPED_JANI})
    assert type_file(tmp_path, "properties.jani", TYPED_JANI) <= {"unportable-expectation", "unsupported-property"}


def type_file(folder: Path, name: str, typed: str) -> set[str]:
    """Type a file of the system and use every feature; return the codes of the findings in the whole file."""
    path, main = str(folder / name), str(folder / "main.xml")
    workspace = Workspace((str(folder),), Settings())
    workspace.open(main, (folder / "main.xml").read_text(encoding="utf-8"))
    codes: set[str] = set()
    for end in (*range(0, len(typed), 1 if TIMES else 9), len(typed)):
        text = typed[:end]
        workspace.open(path, text)
        snapshot = workspace.snapshot()
        codes = {diagnostic.code for diagnostic in snapshot.checker.diagnostics(path)}
        assert "internal-error" not in codes, text
        complete(snapshot, path, end)
        ask(snapshot, main, path, end)
    assert main in workspace.snapshot().analysis.systems_of(path)
    return codes


def ask(snapshot: Snapshot, main: str, path: str, end: int) -> None:
    """Use every feature of the editor at the last typed character."""
    analysis, whole = snapshot.analysis, Span(0, end)
    for offset in {end, max(0, end - 1)}:
        hover(analysis, path, offset)
        definition(analysis, path, offset)
        references(analysis, path, offset)
        prepare(analysis, path, offset)
        selections(analysis, path, offset)
        close_tag(analysis, path, offset)
        linked_names(analysis, path, offset)
        signature_help(analysis, path, offset)
    for action in actions(snapshot, path, Span(end, end), lambda _: True):
        action.make()
    inlay_hints(analysis, path, whole)
    for lens in lenses(analysis, path):
        counted(analysis, lens.symbol, path)
    document_symbols(analysis, path)
    semantic_tokens(analysis, path)
    folds(analysis, path)
    if can_format(analysis, path):
        format_edits(analysis, path, FileLayout())
    fingerprint(analysis, main)
    for property_ in verifiable(analysis, main):
        in_property_file(analysis, property_, ">= 0.5")
