# SPDX-License-Identifier: Apache-2.0
"""Pictures for readers to judge: what a panel of VS Code with 1200 x 800 pixels shows first, in all four themes.

    (cd vscode-extension && npm run build)
    PYTHONPATH=tests python -m bench.pictures FOLDER [WORD ...]     names that contain one of the words

The 20 graphs of `layouts.py` as state machines, and first views of other pictures: trees, ROS graphs, a timeline, the
plot of an experiment, a comparison of two versions. `pictures.mjs` shows them in Chromium, with the page of the
extension or as files.
"""

from __future__ import annotations

import json
import random
import shutil
import subprocess
import sys
from collections.abc import Iterator, Sequence
from html import escape
from pathlib import Path
from typing import Any

from bench.layouts import Graph, graphs
from bench.server import Server
from roaml.figures.themes import THEMES
from roaml.record import Record

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"
SHARED = ROOT / "../../shared"
TREES = SHARED / "conformance/trees/nav2"
VERBS = ("find", "approach", "align", "grasp", "lift", "carry", "place", "release", "scan", "dock", "wait", "check")
OBJECTS = ("block", "door", "shelf", "table", "person", "charger", "pallet", "tool", "box", "path", "goal", "map")
EVENTS = ("failed", "timeout", "blocked", "found", "lost", "ready", "retry", "low_battery", "arrived")
NAMESPACE = "http://www.w3.org/2005/07/scxml"
VARIABLES = (
    ("battery", "int32", "0"),
    ("distance", "float64", "0.0"),
    ("goal_id", "int32", "0"),
    ("tries", "int32", "0"),
    ("visible", "bool", "false"),
)
CONDITIONS = ("tries < 3", "battery > 20", "distance < 0.5 && visible", "goal_id == 7")


class Shown(Record, frozen=True):
    """A picture: its name, what it shows in a few words, and the message for the page of the extension, or the command
    that writes FILE for a THEME."""

    name: str
    words: str
    kind: str = ""
    file: Path = ROOT
    command: str = ""
    suffix: str = ".svg"


def machine(name: str, graph: Graph) -> str:
    """A state machine with the shape of a graph, with names as in models of robots."""
    count, edges = graph
    chance = random.Random(name)
    states = [f"{verb}_{thing}" for thing in OBJECTS for verb in VERBS]
    states += [f"{state}_again" for state in states]
    lines = [f'<ascxml xmlns="{NAMESPACE}" version="1.0" name="{name}" initial="{states[0]}">', "    <datamodel>"]
    lines += [f'        <data id="{id_}" type="{type_}" expr="{value}"/>' for id_, type_, value in VARIABLES]
    lines.append("    </datamodel>")
    for state in range(count):
        lines.append(f'    <state id="{states[state]}">')
        targets = [target for source, target in edges if source == state]
        start = chance.randrange(len(EVENTS))
        for number, target in enumerate(targets):
            event = EVENTS[(start + number) % len(EVENTS)] if number else "done"
            # The events of a state with many transitions have different names.
            event = f"{event}.{number}" if len(targets) > 3 else event
            condition = escape(chance.choice(CONDITIONS)) if number and chance.random() < 0.4 else ""
            guard = f' cond="{condition}"' if condition else ""
            lines.append(f'        <transition event="{event}" target="{states[target]}"{guard}/>')
        lines.append("    </state>")
    return "\n".join([*lines, "</ascxml>", ""])


def pictures(folder: Path) -> Iterator[Shown]:
    """All pictures; their models are written into a folder."""
    for name, graph in graphs().items():
        title = name.title().replace(" ", "")
        (folder / "models").mkdir(parents=True, exist_ok=True)
        file = folder / "models" / f"{title}.ascxml"
        file.write_text(machine(title, graph), encoding="utf-8")
        yield Shown(name.replace(" ", "-"), f"state machine, {graph[0]} states, {name.split()[0]}", "machine", file)
    yield Shown("arm", "state machine with ROS actions", "machine", EXAMPLES / "assembly_robot/arm.ascxml")
    yield Shown("mover", "state machine with random choice", "machine", EXAMPLES / "case_study/nodes/mover.ascxml")
    yield Shown("machines", "all machines of a system", "system", EXAMPLES / "assembly_robot/main.xml")
    large = TREES / "navigate_through_poses_w_replanning_and_recovery.xml"
    yield Shown("nav2-tree", "large Nav2 tree without system", "tree", large)
    yield Shown("fetch-tree", "tree with blackboard and mocks", "tree", EXAMPLES / "fetch_tree/fetch.xml")
    yield Shown("uc3-graph", "ROS graph of museum guide", "ros", SHARED / "real/uc3_mended/main.xml")
    yield Shown("uc3-tree", "behavior tree of museum guide", "tree", SHARED / "real/uc3_mended/main.xml")
    yield Shown("fleet-graph", "ROS graph with three namespaces", "ros", EXAMPLES / "fleet/main.xml")
    ring = folder / "ring/main.xml"
    write_ring(ring.parent, 30)
    yield Shown("ros-ring", "ROS graph, 30 nodes, ring", "ros", ring)
    robot, battery = EXAMPLES / "delivery_robot/main.xml", EXAMPLES / "battery/main.xml"
    run = f"simulate -q {robot}"
    yield Shown("timeline", "timeline of the delivery robot", command=f"{run} --theme THEME --svg FILE")
    yield Shown("run-page", "page with a run", command=f"{run} --html FILE", suffix=".html")
    plot = f"experiment -q {battery} --property all_delivered --theme THEME --plot FILE"
    ten = f"{plot} --set capacity=20:120:10"
    yield Shown("plot", "plot of an experiment", command=f"{ten} --resume ten.json")
    yield Shown("plot-lines", "plot, three lines", command=f"{ten} --set present=0.3,0.6,0.9 --resume lines.json")
    six = f"{plot} --set capacity=20:120:20 --set present=0.1:0.9:0.1 --resume six.json"
    yield Shown("plot-six", "plot, six lines", command=six)
    write_versions(folder / "versions")
    compared = "compare old/main.xml new/main.xml --format html -o FILE"
    yield Shown("compare", "page comparing two versions", command=compared, suffix=".html")


def write_ring(folder: Path, count: int) -> None:
    """A system of nodes, each of which publishes what the next one receives."""
    folder.mkdir(parents=True, exist_ok=True)
    nodes = []
    for n in range(count):
        text = f"""<ascxml xmlns="{NAMESPACE}" version="1.0" name="Relay{n}" initial="idle">
    <ros_topic_subscriber name="incoming" topic="/token_{n}" type="std_msgs/Int32"/>
    <ros_topic_publisher name="outgoing" topic="/token_{(n + 1) % count}" type="std_msgs/Int32"/>
    <state id="idle">
        <ros_topic_callback name="incoming" target="idle">
            <ros_topic_publish name="outgoing"><field name="data" expr="_msg.data + 1"/></ros_topic_publish>
        </ros_topic_callback>
    </state>
</ascxml>
"""
        (folder / f"relay{n}.ascxml").write_text(text, encoding="utf-8")
        nodes.append(f'        <input type="ros-ascxml" src="relay{n}.ascxml"/>')
    lines = ["<roaml>", '    <parameters><max_time value="10" unit="s"/></parameters>']
    lines += ["    <node_models>", *nodes, "    </node_models>", "</roaml>", ""]
    (folder / "main.xml").write_text("\n".join(lines), encoding="utf-8")


def write_versions(folder: Path) -> None:
    """Two versions of the delivery robot."""
    for name in ("old", "new"):
        shutil.copytree(EXAMPLES / "delivery_robot", folder / name, dirs_exist_ok=True)
    battery = folder / "new/nodes/battery.ascxml"
    text = battery.read_text(encoding="utf-8")
    assert text.count("level - 10") == 1
    battery.write_text(text.replace("level - 10", "level - 20"), encoding="utf-8")
    tree = folder / "new/tree.xml"
    text = tree.read_text(encoding="utf-8")
    assert 'level="30"' in text
    tree.write_text(text.replace('level="30"', 'level="50"'), encoding="utf-8")


def ask(shown: Sequence[Shown]) -> list[Any]:
    """The answers of a language server."""
    server = Server()
    server.initialize(ROOT)
    answers = []
    for number, picture in enumerate(shown, 10):
        params = {"textDocument": {"uri": picture.file.resolve().as_uri()}, "kind": picture.kind}
        server.send("as2fm/picture", params, number)
        answers.append(server.answer(number)[1]["result"])
    server.end()
    return answers


def write_file(picture: Shown, theme: str, folder: Path) -> str:
    """Write the file of a picture, and return its path."""
    file = folder / f"{picture.name}.{theme}{picture.suffix}"
    options = picture.command.replace("THEME", theme).replace("FILE", str(file)).split()
    command = [sys.executable, "-m", "as2fm_lsp", *options]
    done = subprocess.run(command, check=False, capture_output=True, text=True, cwd=folder / "versions")
    if not file.exists():
        raise SystemExit(f"{' '.join(command)}: {done.stderr}")
    return str(file)


def main(folder: Path, words: Sequence[str]) -> None:
    shown = [p for p in pictures(folder) if not words or any(word in p.name for word in words)]
    panels = [p for p in shown if p.kind]
    jobs: list[dict[str, Any]] = [
        {"name": picture.name, "picture": answer} for picture, answer in zip(panels, ask(panels), strict=True)
    ]
    for picture in shown:
        if not picture.kind:
            files = {theme: write_file(picture, theme, folder.resolve()) for theme in THEMES}
            jobs.append({"name": picture.name, "files": files})
    node = shutil.which("node")
    if node is None:
        raise SystemExit("Node.js is needed")
    script = Path(__file__).with_name("pictures.mjs")
    subprocess.run([node, script, folder], input=json.dumps(jobs), text=True, check=True)
    rows = [f"{number}. `{p.name}.THEME.png`: {p.words}" for number, p in enumerate(shown, 1)]
    (folder / "list.md").write_text("\n".join(["# Pictures", "", *rows, ""]), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
