# SPDX-License-Identifier: Apache-2.0
"""Benchmarks of the translation: the largest conformance model, whole calls of the command line, and the growth of time
and memory."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import NamedTuple

import conformance
from bench.check import EXAMPLES, GROWTH, system
from bench.plot import growth_svg
from bench.report import Benchmark, Row, listed, median, megabytes, seconds
from roaml import api
from roaml.jani.writer import write

TOPICS = (100, 500, 2000)
CAPACITIES = (10, 100, 1000, 10_000)
"""`max_array_size`"""


def largest() -> Path:
    """The conformance model with the most edges; an example if there are no conformance models."""
    models = conformance.systems() or (EXAMPLES / "delivery_robot" / "main.xml",)
    return max(models, key=lambda path: sum(len(a.edges) for a in api.to_jani(_load(path)).automata))


def _load(path: Path) -> api.LoadedSystem:
    return api.load(str(path), [str(conformance.INTERFACES)] if conformance.PRESENT else [])


def one_model() -> list[Row]:
    """The translation of one model, without reading and without the start of a process."""
    path = largest()
    loaded = _load(path)
    translating, writing = [], []
    for _ in range(9):
        before = time.perf_counter()
        model = api.to_jani(loaded)
        between = time.perf_counter()
        for _ in write(model):
            pass
        translating.append(between - before)
        writing.append(time.perf_counter() - between)
    edges = sum(len(automaton.edges) for automaton in model.automata)
    size = f"{len(model.automata)} automata, {edges} edges; median of {len(writing)}"
    name = "/".join(path.parts[-3:-1])
    return [
        Row("translation", seconds(median(translating)), "< 150 ms", f"`api.to_jani` of {name}: {size}"),
        Row("JANI text", seconds(median(writing)), "< 100 ms", "`roaml.jani.writer.write` of the same"),
    ]


def command_line() -> list[Row]:
    """A whole call: start, read, check, translate, write."""
    path, took = largest(), []
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "as2fm_lsp", "translate", str(path), "-o", f"{folder}/out.jani"]
        command += ["--ros-path", str(conformance.INTERFACES)] if conformance.PRESENT else []
        for _ in range(9):
            before = time.perf_counter()
            subprocess.run(command, capture_output=True, check=True)
            took.append(time.perf_counter() - before)
    how = f"`as2fm-lsp translate` of the same, the whole process; median of {len(took)}"
    return [Row("translate, command line", seconds(median(took)), "< 0.8 s", how)]


class Run(NamedTuple):
    """One translation in a separate process: times in s, sizes in bytes."""

    translate: float
    write: float
    size: int
    memory: int


@cache
def growing_machines() -> list[Run]:
    """The translation of generated systems with increasing numbers of machines."""
    runs = []
    for machines in GROWTH:
        with system(machines + 3) as folder:
            runs.append(_median(folder / "main.xml"))
    return runs


@cache
def growing_topics() -> list[Run]:
    """The translation of one hundred machines with increasing numbers of topics."""
    runs = []
    for count in TOPICS:
        with tempfile.TemporaryDirectory() as folder:
            runs.append(_median(write_topics(Path(folder), 100, count)))
    return runs


@cache
def growing_arrays() -> list[Run]:
    """The translation of arrays with increasing capacities."""
    with tempfile.TemporaryDirectory() as folder:
        main = write_arrays(Path(folder))
        return [_median(main, capacity) for capacity in CAPACITIES]


def diagram() -> str:
    """All three measurements in one diagram, as SVG."""
    series = {"machines": growing_machines(), "topics": growing_topics(), "max_array_size": growing_arrays()}
    points = {name: [(run.size / 1e6, run.translate + run.write) for run in runs] for name, runs in series.items()}
    return growth_svg(
        "Translation by the size of the output", points, "size of the JANI file (MB)", "translating and writing (s)"
    )


def growth() -> list[Row]:
    runs = growing_machines()
    return [
        _grows("translation, growth", runs, f"the generated systems of {listed(GROWTH)} machines"),
        _peak(runs),
    ]


def topics() -> list[Row]:
    runs = growing_topics()
    return [_grows("translation, topics", runs, f"100 machines with {listed(TOPICS)} topics"), _peak(runs)]


def capacities() -> list[Row]:
    runs = growing_arrays()
    return [_grows("translation, arrays", runs, f"two machines and a `max_array_size` of {listed(CAPACITIES)}")]


def _grows(measure: str, runs: list[Run], what: str) -> Row:
    took = [run.translate + run.write for run in runs]
    rates = [f"{duration / run.size * 1e9:.0f}" for duration, run in zip(took, runs, strict=True)]
    sizes = listed(f"{run.size / 1e6:.1f}" for run in runs)
    how = f"{what}, translated and written: {sizes} MB of JANI; {listed(rates)} ms for each MB"
    return Row(measure, listed(map(seconds, took)), "linear in the output", how)


def _peak(runs: list[Run]) -> Row:
    return Row("memory", megabytes(max(run.memory for run in runs)), "< 300 MB", "the most of these processes")


_TRANSLATE = """
import json, resource, sys, time
from as2fm_lsp.collector import spare_the_collector
from roaml import api
from roaml.jani.writer import write
from roaml.model.parameters import Overrides
spare_the_collector()
capacity = int(sys.argv[2])
system = api.load(sys.argv[1], overrides=Overrides(max_array_size=capacity) if capacity else Overrides())
before = time.perf_counter()
model = api.to_jani(system)
between = time.perf_counter()
size = sum(len(chunk) for chunk in write(model))
after = time.perf_counter()
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
print(json.dumps([between - before, after - between, size, peak]))
"""


def _median(main: Path, capacity: int = 0) -> Run:
    """The medians of three processes. `capacity` is the `max_array_size`; 0 means that of the system file."""
    command = [sys.executable, "-c", _TRANSLATE, str(main), str(capacity)]
    outputs = [subprocess.run(command, capture_output=True, text=True, check=True).stdout for _ in range(3)]
    return Run(*(median(values) for values in zip(*map(json.loads, outputs), strict=True)))


def write_arrays(folder: Path) -> Path:
    """A machine that fills an array without a bound and sends it, and one that compares it with its own."""
    machines = [
        """<ascxml name="filling" version="1.0" initial="run">
<datamodel><data id="found" type="int32[]" expr="[]" /></datamodel>
<state id="run"><transition cond="found.length &lt; 3" target="run">
<assign location="found[found.length]" expr="1" /><send event="told"><param name="all" expr="found" /></send>
</transition></state>
</ascxml>""",
        """<ascxml name="hearing" version="1.0" initial="run">
<datamodel><data id="known" type="int32[]" expr="[]" /><data id="news" type="bool" expr="false" /></datamodel>
<state id="run"><transition event="told" target="run">
<assign location="news" expr="_event.data.all != known" /><assign location="known" expr="_event.data.all" />
</transition></state>
</ascxml>""",
    ]
    return _write(folder, machines)


def write_topics(folder: Path, machines: int, count: int) -> Path:
    """Write a ring of machines that publish and receive a given number of topics together; return the system file."""
    written = []
    for number in range(machines):
        mine = range(number, count, machines)
        heard = range((number + 1) % machines, count, machines)
        lines = [f'<ascxml name="Machine{number}" version="1.0" initial="run">']
        lines += [f'<ros_topic_publisher name="out_{n}" topic="topic_{n}" type="std_msgs/Int32" />' for n in mine]
        lines += [f'<ros_topic_subscriber name="in_{n}" topic="topic_{n}" type="std_msgs/Int32" />' for n in heard]
        lines += ['<state id="run">']
        for n, m in zip(heard, mine, strict=False):
            lines += [f'<ros_topic_callback name="in_{n}" target="run"><ros_topic_publish name="out_{m}">']
            lines += ['<field name="data" expr="_msg.data + 1" /></ros_topic_publish></ros_topic_callback>']
        lines += ["</state>", "</ascxml>"]
        written.append("\n".join(lines))
    return _write(folder, written)


def _write(folder: Path, machines: Sequence[str]) -> Path:
    for number, text in enumerate(machines):
        (folder / f"machine_{number}.ascxml").write_text(text, encoding="utf-8")
    inputs = "\n".join(f'<input type="node-ascxml" src="machine_{n}.ascxml" />' for n in range(len(machines)))
    (folder / "properties.jani").write_text('{"properties": []}', encoding="utf-8")
    main = folder / "main.xml"
    main.write_text(
        f"""<roaml>
<parameters><max_time value="10" unit="s" /></parameters>
<node_models>
{inputs}
</node_models>
<properties><input type="jani" src="properties.jani" /></properties>
</roaml>
""",
        encoding="utf-8",
    )
    return main


BENCHMARKS: dict[str, Benchmark] = {
    "translate": one_model,
    "translate-command-line": command_line,
    "translate-growth": growth,
    "translate-topics": topics,
    "translate-arrays": capacities,
}
