# SPDX-License-Identifier: Apache-2.0
"""The initial content of new files, and their paths."""

from __future__ import annotations

from collections.abc import Iterable

from roaml.expr.types import BASE_TYPES, UNKNOWN
from roaml.expr.zero import zero_text
from roaml.model.name_forms import variable_problem
from roaml.project.analysis import Analysis
from roaml.project.paths import full, seen_from, split_name
from roaml.regex import regex
from roaml.roles import Direction
from roaml.scxml.names import safe_name
from roaml.text import SourceFile

_DECLARATION = '<?xml version="1.0" encoding="UTF-8"?>\n'
_CAMEL = regex(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")


def stem_of(path: str) -> str:
    return safe_name(split_name(path)[0])


def camel_case(stem: str) -> str:
    """The name of the machine in a file whose name without extension is `stem`: `BatteryAbove` for `battery_above`."""
    return "".join(part[:1].upper() + part[1:] for part in stem.split("_"))


def file_name(machine: str) -> str:
    """The name of the file for a machine: `battery_above.ascxml` for `BatteryAbove`."""
    return _CAMEL.sub("_", machine).lower() + ".ascxml"


def free_path(analysis: Analysis, folder: str, name: str) -> str:
    """A path of a new file in a folder: `name`, with a number if there is a file with this name."""
    stem, extension = split_name(name)
    path, number = full(folder, name), 2
    while isinstance(analysis.files.read(path), SourceFile):
        path, number = full(folder, f"{stem}_{number}{extension}"), number + 1
    return path


def relative(path: str, system: str, written: Iterable[str] = ()) -> str:
    """A path for the attribute `src` in a system file. It begins with `./` if the paths `written` in the file do."""
    src = seen_from(path, system)
    others = [other for other in written if not other.startswith("..")]
    dotted = bool(others) and all(other.startswith("./") for other in others)
    return f"./{src}" if dotted and not src.startswith("..") else src


def node(name: str) -> str:
    """The text of a machine with one state and without behavior."""
    return f"""{_DECLARATION}<ascxml name="{name}" version="1.0" initial="run">
    <state id="run" />
</ascxml>
"""


def plugin(name: str, ports: Iterable[tuple[Direction, str, str]] = (), *, child: bool = False) -> str:
    """The text of a plugin that reads its input ports, sets its output ports and returns SUCCESS, or, if it has a
    child, the status of the child.

    Args:
        name: the name of the plugin.
        ports: the direction, key and type of each port.
        child: whether the node has a child.
    """
    ports = tuple(ports)
    inputs = [
        (key, f"{key}_input" if variable_problem(key) else key, type_)
        for way, key, type_ in ports
        if way is Direction.IN
    ]
    outputs = [(key, type_) for direction, key, type_ in ports if direction is Direction.OUT]
    parts = []
    if ports:
        parts.append(
            "".join(
                f'    <bt_declare_port_{direction} key="{key}" type="{type_}" />\n' for direction, key, type_ in ports
            )
        )
    if inputs:
        data = (f'        <data id="{id_}" type="{type_}" expr="{_zero(type_)}" />\n' for _, id_, type_ in inputs)
        parts.append(f"    <datamodel>\n{''.join(data)}    </datamodel>\n")
    work = "".join(
        f"""\
            <assign location="{id_}">
                <expr><bt_get_input key="{key}" /></expr>
            </assign>
"""
        for key, id_, _ in inputs
    )
    work += "".join(f'            <bt_set_output key="{key}" expr="{_zero(type_)}" />\n' for key, type_ in outputs)
    parts.append((_WITH_CHILD if child else _LEAF).format(work=work))
    body = "\n".join(parts)
    return f'{_DECLARATION}<ascxml name="{name}" version="1.0" initial="ready">\n{body}</ascxml>\n'


def _zero(type_: str) -> str:
    return zero_text(BASE_TYPES.get(type_, UNKNOWN))


_LEAF = """\
    <state id="ready">
        <bt_tick target="ready">
{work}            <bt_return_status status="SUCCESS" />
        </bt_tick>
        <bt_halt target="ready">
            <bt_return_halted />
        </bt_halt>
    </state>
"""

_ANSWERS = "".join(
    f"""\
        <bt_child_status id="0" cond="_bt.status == {status}" target="ready">
            <bt_return_status status="{status}" />
        </bt_child_status>
"""
    for status in ("SUCCESS", "FAILURE", "RUNNING")
)

_WITH_CHILD = f"""\
    <state id="ready">
        <bt_tick target="ticking">
{{work}}            <bt_tick_child id="0" />
        </bt_tick>
        <bt_halt target="halting">
            <bt_halt_child id="0" />
        </bt_halt>
    </state>

    <state id="ticking">
{_ANSWERS}    </state>

    <state id="halting">
        <bt_child_halted id="0" target="ready">
            <bt_return_halted />
        </bt_child_halted>
    </state>
"""


def tree() -> str:
    """The text of a file with a tree of one node, which succeeds."""
    return f"""{_DECLARATION}<root BTCPP_format="4" main_tree_to_execute="MainTree">
    <BehaviorTree ID="MainTree">
        <AlwaysSuccess />
    </BehaviorTree>
</root>
"""


def properties() -> str:
    return '{\n    "properties": []\n}\n'
