# SPDX-License-Identifier: Apache-2.0
"""The statistical model checker SCAN on the folders that `translate --scxml-dir` writes.

`cargo install smc_scan --locked` installs it; `SCAN` in the environment names the program if it is not on the path.
`SCAN_EXAMPLES` names the folder of SCAN's own examples in JANI: `tests` of the package `smc_scan_jani`, which Cargo
stores below `registry/src` of its folder. Its examples in SCXML are written in SCAN's own dialect of the system file.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

import conformance
from bench.qvbs import called, verify
from bench.report import Benchmark, Row, seconds
from roaml import api
from roaml.scxml.lowered_properties import FILE_NAME, NOBODY_TEXT, lowered_properties
from roaml.scxml.writer import NOBODY, write
from roaml.smc.run import Options

PRECISION = 0.02
SECONDS = 60
"""The longest time for a call of SCAN."""
REPETITIONS = 5
"""The fastest of these calls is shown."""


def program() -> str:
    return os.environ.get("SCAN") or shutil.which("scan") or ""


def write_folder(source: api.LoadedSystem, folder: Path) -> None:
    network = api.to_scxml(source)
    for name, text in write(network):
        (folder / f"{name}.scxml").write_text(text, encoding="utf-8")
    lowered = lowered_properties(network, source.observed)
    if lowered.text:
        (folder / FILE_NAME).write_text(lowered.text, encoding="utf-8")
    if lowered.names_nobody:
        (folder / f"{NOBODY}.scxml").write_text(NOBODY_TEXT, encoding="utf-8")


def call(*arguments: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "RUST_BACKTRACE": "0"}
    return subprocess.run(
        [program(), "-q", *arguments], capture_output=True, text=True, timeout=SECONDS, env=environment, check=False
    )


def folders_that_scan_reads() -> list[Row]:
    """The conformance systems whose machines SCAN reads."""
    rows = []
    for path in sorted((conformance.ROOT / "models").glob("*/main.xml")):
        with tempfile.TemporaryDirectory() as folder:
            write_folder(api.load(str(path), [str(conformance.INTERFACES)]), Path(folder))
            done = call(folder, "validate")
        words = " ".join((done.stdout + done.stderr).split())
        reason = "read" if done.returncode == 0 else words.removeprefix("Error: ")[:100]
        rows.append(Row(f"SCAN reads {path.parent.name}", reason, "", "`scan FOLDER validate`"))
    return rows


def properties_in_scan() -> list[Row]:
    """The values and times of lowered properties in SCAN and in `verify`."""
    rows = []
    for path in sorted((conformance.ROOT / "xml-properties").glob("*/main.xml")):
        source = api.load(str(path), [str(conformance.INTERFACES)])
        with tempfile.TemporaryDirectory() as folder:
            write_folder(source, Path(folder))
            for observed in source.observed:
                began = time.perf_counter()
                arguments = ("verify", observed.name, "--json", "--precision", str(PRECISION), "--single-thread")
                done = call(folder, *arguments)
                by_scan = time.perf_counter() - began
                rate = json.loads(done.stdout)["rate"] if done.returncode == 0 else "refused"
                options = Options(epsilon=PRECISION)
                began = time.perf_counter()
                (ours,) = api.verify(source, [observed.name], options, only_uniform=True)
                by_us = time.perf_counter() - began
                value = "refused" if ours.answer is None else f"{ours.answer.value:.3f}"
                measure = f"{path.parent.name}, {observed.name}"
                figure = f"{value} in {seconds(by_us)}; SCAN: {rate} in {seconds(by_scan)}"
                rows.append(
                    Row(measure, figure, "", f"± {PRECISION}; ours without, SCAN's with the start of a process")
                )
    return rows


def examples_of_scan() -> list[Row]:
    """The values and CPU times of SCAN's own examples in JANI that have properties, in SCAN and in `verify`."""
    rows = []
    for path in sorted(Path(os.environ["SCAN_EXAMPLES"]).glob("*.jani")):
        if not json.loads(path.read_text(encoding="utf-8")).get("properties"):
            continue
        arguments = ["-q", str(path), "verify", "--all", "--json", "--precision", str(PRECISION), "--single-thread"]
        theirs = min(called([program(), *arguments], SECONDS) for _ in range(REPETITIONS))
        sampled = ["--scheduler", "uniform", "--method", "adaptive", "--epsilon", str(PRECISION), "--jobs", "1"]
        ours = min(verify(str(path), *sampled, timeout_s=SECONDS) for _ in range(REPETITIONS))
        rate = f"{json.loads(theirs.output)['rate']:.3f}" if theirs.status == 0 else "refused"
        results = json.loads(ours.output)["results"] if ours.output else []
        values = ", ".join(f"{result['probability']:.3f}" for result in results) or "refused"
        figure = f"{values} in {seconds(ours.processor)}; SCAN: {rate} in {seconds(theirs.processor)}"
        rows.append(Row(f"SCAN's example {path.name}", figure, "", f"± {PRECISION}; CPU time of the whole process"))
    return rows


BENCHMARKS: dict[str, Benchmark] = {
    "scan-reads": folders_that_scan_reads,
    "scan-verify": properties_in_scan,
    "scan-examples": examples_of_scan,
}
