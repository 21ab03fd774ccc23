# SPDX-License-Identifier: Apache-2.0
"""Configurations: settings of every kind in every place, brackets, bytes, pipes and links instead of files.

Each case is a folder on the disk, because configurations are read from there.
"""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from random import Random

from fuzz.checked import LIMITS, problems_of_check
from fuzz.damage import ANY, PIECES
from fuzz.strategy import Failure, Strategy
from roaml.project.configuration import find_settings
from roaml.project.exclude import NOTHING
from roaml.record import replace

NAMES = ("as2fm.toml", "pyproject.toml", "package.xml", "msg/Level.msg")
_KEYS = (
    "roots",
    "ros-path",
    "exclude",
    "select",
    "ignore",
    "severity",
    "warnings-as-errors",
    "max-cells",
    "max-parts",
    "reaction-time",
)
_SIMPLE = ("true", "1", "-1", "0", "1e400", "inf", "'.'", "'../..'", "['.']", "['/']", "[]", "{}", "1979-01-01")
_VALUES = (
    *_SIMPLE,
    '["interfaces", "msg"]',
    '"*"',
    '["**"]',
    '{ late-event-data = "error" }',
    '{ "" = 1 }',
    "9" * 5000,
)
_SPECIAL = ("pipe", "device", "folder", "loop", "dangling", "unreadable")

MAIN = """<roaml>
    <parameters><max_time value="3" unit="s" /></parameters>
    <node_models><input type="node-ascxml" src="machine.ascxml" /></node_models>
    <properties><input type="jani" src="properties.jani" /></properties>
</roaml>
"""
MACHINE = """<ascxml name="Machine" version="1.0" initial="on">
    <ros_topic_publisher name="level" topic="/level" type="robot/Level" />
    <ros_time_rate name="second" rate_hz="1" />
    <state id="on">
        <ros_rate_callback name="second" target="on">
            <ros_topic_publish name="level"><field name="data" expr="1" /></ros_topic_publish>
        </ros_rate_callback>
    </state>
</ascxml>
"""
FILES: dict[str, bytes] = {
    "main.xml": MAIN.encode(),
    "machine.ascxml": MACHINE.encode(),
    "properties.jani": b'{"properties": []}',
    "package.xml": b"<package><name>robot</name></package>",
    "msg/Level.msg": b"int32 data\n",
    "as2fm.toml": b'ros-path = ["."]\n',
}


@dataclass(frozen=True)
class Configured:
    """A configuration. `special` are paths that are not regular files, with their kinds."""

    seed: int
    contents: dict[str, bytes]
    special: dict[str, str]

    def description(self) -> Iterator[str]:
        yield f"{', '.join(path for path in self.contents if self.contents[path] != FILES.get(path))} {self.special}"

    def files(self) -> dict[str, str | bytes]:
        return dict(self.contents)

    def run(self) -> Iterator[Failure]:
        folder = Path(tempfile.mkdtemp(prefix="as2fm-fuzz-"))
        try:
            for name, content in self.contents.items():
                path = folder / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(content)
            for name, kind in self.special.items():
                _make(folder / name, kind)
            settings, _ = find_settings(str(folder / "main.xml"))
            random = Random(self.seed)
            main = str(random.choice([folder, folder / "main.xml"]))
            if os.path.isdir(main) or os.path.isfile(main):
                yield from problems_of_check(
                    main, {}, settings=replace(settings, limits=LIMITS, roots=(), exclude=NOTHING)
                )
                if all(root.startswith(str(folder)) for root in (*settings.roots, *settings.ros_paths)):
                    yield from problems_of_check(main, {}, settings=replace(settings, limits=LIMITS))
        finally:
            shutil.rmtree(folder, ignore_errors=True)


def _make(path: Path, kind: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    with contextlib.suppress(FileNotFoundError):
        path.unlink()
    match kind:
        case "pipe":
            os.mkfifo(path)
        case "device":
            path.symlink_to("/dev/zero")
        case "folder":
            path.mkdir()
        case "loop":
            path.symlink_to(path.name)
        case "dangling":
            path.symlink_to("nowhere")
        case "unreadable":
            path.touch(mode=0)


def make(seed: int) -> Configured:
    random = Random(seed)
    contents, special = dict(FILES), {}
    name = random.choice([*NAMES[:2], *NAMES])
    match random.randrange(6):
        case 0:
            special[random.choice([*NAMES, *FILES])] = random.choice(_SPECIAL)
        case 1:
            way = random.choice(ANY)
            text = contents.get(name, b"").decode()
            contents[name] = way(random, text, [_settings(random)]).encode("utf-8", "surrogatepass")
        case 2:
            depth = random.choice([50, 500, 5000, 100_000])
            opening, closing = random.choice([("[", "]"), ("{a=", "}"), ("[[", "]]"), ("a.", ""), ("(", ")")])
            contents[name] = f"roots = {opening * depth}{closing * depth}".encode()
        case _:
            table = "[tool.as2fm]\n" if name == "pyproject.toml" else ""
            contents[name] = (table + _settings(random)).encode("utf-8", "surrogatepass")
    return Configured(seed, contents, special)


def _settings(random: Random) -> str:
    lines = []
    for key in random.sample(_KEYS, random.randint(1, 4)):
        value = random.choice([*_VALUES, json.dumps(random.choice(PIECES)), random.choice(PIECES)])
        lines.append(f"{key} = {value}")
    return "\n".join(lines) + "\n"


STRATEGY = Strategy("configuration", "writes configurations, definitions and things that are no files", make)
