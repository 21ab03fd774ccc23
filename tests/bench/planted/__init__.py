# SPDX-License-Identifier: Apache-2.0
"""Mistakes that are planted in systems without mistakes, one at a time: which of them does a check report, and where?

Each file `*.toml` of this folder lists mistakes of one class. Systems beside the project are read where they are and
are edited in memory; mistakes in systems that are absent are left out.
The systems in the folder `systems` are only for this bench.

    [[planted]]
    system = "examples/case_study/main.xml"     # of a folder in `ROOTS`
    file = "nodes/mover.ascxml"                 # relative to the folder of the system file
    after = '<state id="moving">'               # optional: `old` is searched behind this text
    old = '<ros_action_succeed name="move" goal_id="goal" />'
    new = ''
    place = ['<target id="ready" prob="0.7">']  # a finding in one of these lines locates it; one must exist
    place_after = '<state id="moving">'         # optional: behind which the places are searched; default: `after`
    place_file = "nodes/mover.ascxml"           # optional: the file of the places; default: `file`

A mistake is *found* if an error or warning that the system without it does not have begins in a line of `place`,
found *elsewhere* if there are only other new errors or warnings, otherwise *silent*. The table `[[true]]` (`system`,
`file`, `code`, `line`) lists findings in unchanged systems that are true; all other errors and warnings there are
false.

The first fix of each new finding is applied, and the system is checked again. A fix *restores* if the file is as it was
before the mistake, except for white space, and *mends* if no new error or warning is left. It must not add one.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import conformance
from bench.report import Benchmark, Row, listed
from roaml import api
from roaml.api.checking import CheckResult
from roaml.diagnostics import Diagnostic, Severity
from roaml.ide.code_actions import quick_fixes
from roaml.ide.code_actions.action import CodeAction
from roaml.project.settings import Settings
from roaml.text import apply_edits

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

FOLDER = Path(__file__).parent
PROJECT = FOLDER.parents[2]
ROOTS = {
    "examples": PROJECT / "examples",
    "own": FOLDER / "systems",
    "conformance": conformance.ROOT / "models",
    "real": conformance.ROOT.parent / "real",
    "trees": conformance.ROOT / "trees",
    "xmlprops": conformance.ROOT / "xml-properties",
}


@dataclass(frozen=True)
class Planted:
    """A mistake: `old` is replaced by `new` in `file`, a path; `places` are the lines that a finding should name."""

    group: str
    system: str
    file: Path
    after: str
    old: str
    new: str
    places: tuple[str, ...]
    place_after: str
    place_file: Path

    @property
    def main(self) -> Path:
        return system_file(self.system)

    def edited(self) -> str:
        text = self.file.read_text(encoding="utf-8")
        offset = text.index(self.old, text.index(self.after))
        return text[:offset] + self.new + text[offset + len(self.old) :]

    def place_text(self) -> str:
        return self.edited() if self.place_file == self.file else self.place_file.read_text(encoding="utf-8")

    def lines(self) -> set[int]:
        """The offsets of the beginnings of the lines of `places`."""
        text = self.place_text()
        begin = text.index(self.place_after)
        offsets = [text.find(place, begin) for place in self.places]
        assert max(offsets) >= 0, f"{self}: no place exists"
        return {text.rfind("\n", 0, offset) + 1 for offset in offsets if offset >= 0}

    def __str__(self) -> str:
        return f"{self.system}: {self.file.name}: {' '.join(self.places[0].split())[:60]}"


def system_file(name: str) -> Path:
    root, _, rest = name.partition("/")
    return ROOTS[root] / rest


def mistakes(group: str) -> list[Planted]:
    """The mistakes of a class whose systems are present."""
    entries = tomllib.loads((FOLDER / f"{group}.toml").read_text(encoding="utf-8")).get("planted", [])
    return [_mistake(group, entry) for entry in entries if system_file(entry["system"]).is_file()]


def _mistake(group: str, entry: dict[str, Any]) -> Planted:
    folder = system_file(entry["system"]).parent
    after = entry.get("after", "")
    return Planted(
        group,
        entry["system"],
        folder / entry["file"],
        after,
        entry["old"],
        entry["new"],
        tuple(entry["place"]),
        entry.get("place_after", after),
        folder / entry.get("place_file", entry["file"]),
    )


def groups() -> list[str]:
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def judged(mistake: Planted) -> tuple[str, list[Diagnostic]]:
    """`found`, `elsewhere` or `silent`, and the new errors and warnings."""
    known = Counter(_key(diagnostic) for diagnostic in sound(mistake.main))
    new = []
    for diagnostic in _checked(mistake.main, {str(mistake.file): mistake.edited()}):
        known[_key(diagnostic)] -= 1
        if known[_key(diagnostic)] < 0:
            new.append(diagnostic)
    text, lines = mistake.place_text(), mistake.lines()
    for diagnostic in new:
        begin = text.rfind("\n", 0, diagnostic.span.start) + 1
        if Path(diagnostic.path).resolve() == mistake.place_file.resolve() and begin in lines:
            return "found", new
    return ("elsewhere" if new else "silent"), new


def _key(diagnostic: Diagnostic) -> tuple[str, str, str]:
    return (diagnostic.path, diagnostic.code, diagnostic.message)


@cache
def sound(main: Path) -> tuple[Diagnostic, ...]:
    """The errors and warnings of an unchanged system."""
    return _checked(main, {})


def _checked(main: Path, texts: dict[str, str]) -> tuple[Diagnostic, ...]:
    return tuple(d for d in _result(main, texts).diagnostics if d.severity >= Severity.WARNING)


def _result(main: Path, texts: dict[str, str]) -> CheckResult:
    paths = (str(conformance.INTERFACES),) if conformance.PRESENT else ()
    return api.check([str(main)], paths, Settings(), texts)


def systems() -> Iterator[str]:
    """The systems whose findings are counted as false: all that are present."""
    for path in sorted(ROOTS["examples"].glob("*/main*.xml")):
        yield f"examples/{path.relative_to(ROOTS['examples']).as_posix()}"
    for path in conformance.systems():
        yield f"conformance/{path.relative_to(ROOTS['conformance']).as_posix()}"
    if system_file("real/uc3/main_with_properties.xml").is_file():
        yield "real/uc3/main_with_properties.xml"


def false_findings() -> Row:
    entries = [e for g in groups() for e in tomllib.loads((FOLDER / f"{g}.toml").read_text("utf-8")).get("true", [])]
    true = {((system_file(e["system"]).parent / e["file"]).resolve(), e["code"], e["line"]) for e in entries}
    false: dict[tuple[Path, str, int], str] = {}
    lines: dict[str, int] = {}
    for name in systems():
        main = system_file(name)
        paths = (str(conformance.INTERFACES),) if conformance.PRESENT else ()
        result = api.check([str(main)], paths, Settings())
        lines |= {str(Path(f).resolve()): Path(f).read_text("utf-8").count("\n") for f in result.files}
        for d in result.diagnostics:
            line = Path(d.path).read_text("utf-8").count("\n", 0, d.span.start) + 1
            key = (Path(d.path).resolve(), d.code, line)
            if d.severity >= Severity.WARNING and key not in true:
                false[key] = d.message
    for path, code, line in false:
        print(f"false: {path}:{line}: {code}", file=sys.stderr)
    total = sum(lines.values())
    rate = 1000 * len(false) / total
    how = f"{len(false)} errors and warnings in {total} lines of the systems that are present"
    return Row("false findings per 1,000 lines", f"{rate:.2f}", "≤ 0.3", how)


def first_fix(mistake: Planted, finding: Diagnostic) -> CodeAction | None:
    """The first quick fix that an editor offers for a finding and that creates no file; `None` if there is none."""
    snapshot = _result(mistake.main, {str(mistake.file): mistake.edited()}).snapshot
    actions = quick_fixes(snapshot, finding.path, finding)
    return next((action for action in actions if not action.resources), None)


def fixed(mistake: Planted, finding: Diagnostic, fix: CodeAction, new: Sequence[Diagnostic]) -> str:
    """What the fix of a finding does: `restores`, `mends`, `removes` only this finding, `keeps` it, or `adds` a
    finding."""
    texts = {str(mistake.file): mistake.edited()}
    for changed, edits in fix.make().edits.items():
        path = next((known for known in texts if Path(known).resolve() == Path(changed).resolve()), changed)
        before = texts.get(path) or Path(path).read_text(encoding="utf-8")
        texts[path] = apply_edits(before, tuple(sorted(edits)))
    original = mistake.file.read_text(encoding="utf-8")
    if "".join(texts[str(mistake.file)].split()) == "".join(original.split()):
        return "restores"
    known = Counter(_place(diagnostic) for diagnostic in (*sound(mistake.main), *new))
    left = Counter(_place(diagnostic) for diagnostic in _checked(mistake.main, texts))
    if left - known:
        return "adds"
    if not left - Counter(_place(diagnostic) for diagnostic in sound(mistake.main)):
        return "mends"
    return "removes" if left[_place(finding)] < known[_place(finding)] else "keeps"


def _place(diagnostic: Diagnostic) -> tuple[str, str]:
    return (str(Path(diagnostic.path).resolve()), diagnostic.code)


def first_fixes(found: Iterable[tuple[Planted, Sequence[Diagnostic]]]) -> Row:
    effects: Counter[str] = Counter()
    for mistake, new in found:
        for finding in new:
            fix = first_fix(mistake, finding)
            if fix is not None:
                effect = fixed(mistake, finding, fix, new)
                effects[effect] += 1
                if effect not in ("restores", "mends"):
                    print(f"fix {effect}: {mistake}: {finding.code}: {fix.title}", file=sys.stderr)
    good, count = effects["restores"] + effects["mends"], sum(effects.values())
    figure = f"{good} of {count} restore or mend, {effects['adds']} add a finding"
    return Row("first fixes of planted mistakes", figure, "≥ 9 of 10, 0 add", "each applied alone, and checked again")


def planted() -> list[Row]:
    """All mistakes of all classes, their first fixes, and the false findings in the same systems without mistakes."""
    rows, found = [], []
    for group in groups():
        verdicts: dict[str, list[Planted]] = {"found": [], "elsewhere": [], "silent": []}
        for mistake in mistakes(group):
            verdict, new = judged(mistake)
            verdicts[verdict].append(mistake)
            found.append((mistake, new))
            if verdict != "found":
                print(f"{verdict}: {mistake}", file=sys.stderr)
                for diagnostic in new:
                    print(f"    {Path(diagnostic.path).name}: {diagnostic.code}", file=sys.stderr)
        count = sum(map(len, verdicts.values()))
        figure = listed(f"{len(of_kind)} {verdict}" for verdict, of_kind in verdicts.items())
        rows.append(Row(f"planted mistakes: {group}", figure, "", f"{count} mistakes, one at a time"))
    return [*rows, first_fixes(found), false_findings()]


BENCHMARKS: dict[str, Benchmark] = {"planted": planted}
