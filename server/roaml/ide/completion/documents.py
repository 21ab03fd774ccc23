# SPDX-License-Identifier: Apache-2.0
"""Completion in empty files: the initial content of a file of each kind."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.ide.completion.item import CompletionItem, ItemKind, Rank
from roaml.model.kinds import MACHINE_EXTENSIONS

_DECLARATION = '<?xml version="1.0" encoding="UTF-8"?>\n'

_MACHINE = """\
<ascxml name="{name}" version="1.0" initial="${{1:start}}">
\t<datamodel>
\t\t$2
\t</datamodel>

\t<state id="${{1:start}}">
\t\t$0
\t</state>
</ascxml>
"""

_PLUGIN = """\
<ascxml name="{name}" version="1.0" initial="idle">
\t<bt_declare_port_in key="${{1:goal}}" type="${{2:string}}"/>

\t<state id="idle">
\t\t<bt_tick target="idle">
\t\t\t$0<bt_return_status status="SUCCESS"/>
\t\t</bt_tick>
\t\t<bt_halt target="idle">
\t\t\t<bt_return_halted/>
\t\t</bt_halt>
\t</state>
</ascxml>
"""

_TREE = """\
<root BTCPP_format="4" main_tree_to_execute="${1:Main}">
\t<BehaviorTree ID="${1:Main}">
\t\t<Sequence>
\t\t\t$0
\t\t</Sequence>
\t</BehaviorTree>
</root>
"""

_SYSTEM = """\
<roaml>
\t<parameters>
\t\t<max_time value="${1:100}" unit="${2|s,ms,us,ns|}"/>
\t</parameters>
\t<node_models>
\t\t<input type="node-ascxml" src="$3"/>
\t</node_models>
\t<properties>
\t\t<input type="jani" src="$4"/>
\t</properties>
</roaml>
"""

_STRUCTS = """\
<types>
\t<struct id="${1:Pose}">
\t\t<member id="${2:x}" type="${3:float64}"/>$0
\t</struct>
</types>
"""

_PROPERTIES = """\
<properties>
\t<ports>
\t\t<ros_topic topic_name="${1:/level}" type="${2:std_msgs/Int32}" event="publish">
\t\t\t<event_var id="${3:level_published}"/>
\t\t</ros_topic>
\t</ports>
\t<guarantees>
\t\t<property id="${4:published}" pattern="${5:existence}">
\t\t\t<event>$3</event>
\t\t\t<scope type="globally"/>
\t\t</property>$0
\t</guarantees>
</properties>
"""


def documents(path: str) -> Iterator[CompletionItem]:
    """Items that insert the initial content of a file of the kinds that the name of the file allows."""
    name = path.replace("\\", "/").rpartition("/")[2].partition(".")[0]
    if path.lower().endswith(MACHINE_EXTENSIONS):
        yield _item("state machine", _MACHINE.format(name=name), Rank.BEST)
        yield _item("behavior tree plugin", _PLUGIN.format(name=name), Rank.LIKELY)
    elif path.lower().endswith(".xml"):
        yield _item("system", _SYSTEM, Rank.BEST)
        yield _item("behavior tree", _TREE, Rank.LIKELY)
        yield _item("struct declarations", _STRUCTS, Rank.USUAL)
        yield _item("properties", _PROPERTIES, Rank.USUAL)


def _item(label: str, snippet: str, rank: Rank) -> CompletionItem:
    return CompletionItem(label, ItemKind.SKELETON, _DECLARATION + snippet, "a new file", rank=rank, filter=f"<{label}")
