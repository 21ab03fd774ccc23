# SPDX-License-Identifier: Apache-2.0
"""Whole systems with changes across their files, so that files no longer fit each other.

A name is changed in only some files; elements, files and trees are moved to another file or system; inputs are listed
twice, elsewhere or not at all. Most files stay well-formed, so most cases reach the parts of the tool that analyse a
whole system, and many are translated.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from random import Random
from typing import TypeAlias

from fuzz.checked import problems_of_check
from fuzz.corpus import Model, snippets, systems
from fuzz.elements import elements_of, piece, put
from fuzz.strategy import Failure, Strategy
from roaml.text import Span
from roaml.xml_syntax import Attribute, Element

MAX_LENGTH = 300_000
"""The maximum number of characters of a file. Larger files may take longer."""

_WORD = re.compile(r"[A-Za-z_][A-Za-z_0-9]*")
_NAMING = ("name", "id", "ID", "topic", "service_name", "action_name", "event", "key", "target", "type", "src")
_CROSSING = (
    "bt_1000_tick",
    "bt_1001_response",
    "topic_level_msg",
    "__as2fm__clock",
    "clock",
    "blackboard",
    "main",
    "M",
)
"""Names that the translation uses, or similar ones."""

Texts: TypeAlias = dict[str, str]
Change: TypeAlias = Callable[[Random, Texts, Model], str]
"""A function that changes some texts and returns a description."""


@dataclass
class Changed:
    """A changed system.

    Attributes:
        model: the original model.
        texts: all files, changed or not.
        changes: a description of the changes.
    """

    seed: int
    model: Model
    texts: Texts
    changes: list[str] = field(default_factory=list)

    def description(self) -> Iterator[str]:
        yield self.model.name
        yield from self.changes

    def files(self) -> dict[str, str | bytes]:
        return {path: text for path, text in self.texts.items() if self.model.texts.get(path) != text}

    def run(self) -> Iterator[Failure]:
        return problems_of_check(self.model.main, self.texts, self.model.ros_paths, Random(self.seed))


def make(seed: int) -> Changed:
    random = Random(seed)
    models = [model for model in (*systems(), *snippets()) if len(model.texts) > 1]
    case = Changed(seed, random.choice(models), {})
    case.texts.update(case.model.texts)
    for _ in range(random.choice([1, 1, 2, 3])):
        change = random.choice(CHANGES)
        case.changes.append(change(random, case.texts, random.choice(models)))
    case.texts = {path: text[:MAX_LENGTH] for path, text in case.texts.items()}
    return case


def rename_somewhere(random: Random, texts: Texts, other: Model) -> str:
    """Replace a name by another one of the system, in some of the files that contain it."""
    names = sorted({name for text in texts.values() for name in _names(text)})
    if len(names) < 2:
        return "nothing"
    old, new = random.sample(names, 2)
    if random.random() < 0.2:
        new = random.choice(_CROSSING)
    holding = [path for path, text in texts.items() if old in text]
    for path in random.sample(holding, random.randint(1, len(holding))) if holding else []:
        texts[path] = re.sub(rf"(?<![\w]){re.escape(old)}(?![\w])", lambda _: new, texts[path])
    return f"{old} -> {new}"


def swap_attributes(random: Random, texts: Texts, other: Model) -> str:
    """Exchange the values of two attributes with the same name in different files."""
    places = [(path, a) for path in sorted(texts) for a in _attributes(texts[path]) if a.name in _NAMING]
    if len(places) < 2:
        return "nothing"
    path, one = random.choice(places)
    same = [(p, a) for p, a in places if a.name == one.name and (p, a) != (path, one)]
    if not same:
        return "nothing"
    other_path, another = random.choice(same)
    values = (piece(texts[path], one.value_span), piece(texts[other_path], another.value_span))
    changes = sorted([(path, one.value_span, values[1]), (other_path, another.value_span, values[0])], reverse=True)
    for where, span, value in changes:
        texts[where] = put(texts[where], span, value)
    return f"{one.name}: {values[0]} <-> {values[1]}"


def move_element(random: Random, texts: Texts, other: Model) -> str:
    """Move or copy an element from a file to another one, of this system or of another one."""
    sources = [path for path in sorted(texts) if _elements(texts[path])]
    if not sources:
        return "nothing"
    target = random.choice(sources)
    foreign = random.random() < 0.3
    origin = other.texts if foreign else texts
    paths = [path for path in sorted(origin) if _elements(origin[path])]
    if not paths:
        return "nothing"
    source = random.choice(paths)
    taken = random.choice(_elements(origin[source]))
    named = [e for e in _elements(texts[target]) if e.name == taken.name] or _elements(texts[target])
    at = random.choice(named).span.end
    written = piece(origin[source], taken.span)[:20_000]
    if not foreign and source != target and random.random() < 0.5:
        texts[source] = put(texts[source], taken.span, "")
    texts[target] = texts[target][:at] + written + texts[target][at:]
    return f"<{taken.name}> of {os.path.basename(source)} into {os.path.basename(target)}"


def exchange_files(random: Random, texts: Texts, other: Model) -> str:
    """Exchange the texts of two files of a system, or replace one by a file of another system."""
    path = random.choice(sorted(texts))
    if random.random() < 0.5 and len(texts) > 1:
        second = random.choice([name for name in sorted(texts) if name != path])
        texts[path], texts[second] = texts[second], texts[path]
        return f"{os.path.basename(path)} <-> {os.path.basename(second)}"
    same = [name for name in sorted(other.texts) if os.path.splitext(name)[1] == os.path.splitext(path)[1]]
    if not same:
        return "nothing"
    source = random.choice(same)
    texts[path] = other.texts[source]
    return f"{os.path.basename(path)} is {source}"


def add_machine(random: Random, texts: Texts, other: Model) -> str:
    """List a machine of another system, or a machine of this system again under another name."""
    mains = [path for path in sorted(texts) if "<roaml" in texts[path] and "</node_models>" in texts[path]]
    machines = [path for path in sorted(other.texts) if path.endswith((".ascxml", ".scxml"))]
    if not mains or not machines:
        return "nothing"
    main, machine = random.choice(mains), random.choice(machines)
    new = os.path.join(os.path.dirname(main), f"added_{random.randrange(3)}.ascxml")
    texts[new] = other.texts[machine]
    entry = f'<input type="node-ascxml" src="{os.path.basename(new)}" />'
    texts[main] = texts[main].replace("</node_models>", f"{entry}</node_models>", 1)
    return f"{os.path.basename(machine)} of {other.name} is listed"


def drop_file(random: Random, texts: Texts, other: Model) -> str:
    """Empty a file, or remove it from the system file."""
    path = random.choice(sorted(texts))
    if random.random() < 0.5:
        texts[path] = ""
        return f"{os.path.basename(path)} is empty"
    name = os.path.basename(path)
    for file, text in texts.items():
        texts[file] = re.sub(rf'<input[^<>]*src="[^"]*{re.escape(name)}"\s*/>', "", text)
    return f"{name} is not listed"


def change_number(random: Random, texts: Texts, other: Model) -> str:
    """Change a parameter, bound, rate or size."""
    places = [(path, m) for path in sorted(texts) for m in re.finditer(r'(?<=[\["= ])\d+(?:\.\d+)?', texts[path])]
    if not places:
        return "nothing"
    path, match = random.choice(places)
    new = random.choice(["0", "1", "2", "7", "100", "1000", "99999", "2147483647", "0.5", "1e-9", "3e9", "-1"])
    texts[path] = put(texts[path], Span(*match.span()), new)
    return f"{match[0]} -> {new} in {os.path.basename(path)}"


def change_property(random: Random, texts: Texts, other: Model) -> str:
    """Change the question or the variables of a property."""
    files = [path for path in sorted(texts) if path.endswith(".jani")]
    if not files:
        return "nothing"
    path = random.choice(files)
    values = list(re.finditer(r'"(?:op|exp|states|fun|left|right|name)"\s*:\s*("[^"]*"|\{[^{}]*\})', texts[path]))
    if not values:
        return "nothing"
    match = random.choice(values)
    forms = ["true", "0.5", '"initial"', '{"op": "initial"}', '{"op": "¬", "exp": true}', '"x"', "[]", '{"op": "F"}']
    forms += ['"Pmin"', '"Pmax"', '"U"', '"G"', '"∧"', '"values"', '"max"', '"avg"', '{"op": "deadlock"}']
    forms += [random.choice(values)[1], '{"op": "filter", "fun": "values", "values": true, "states": true}']
    new = random.choice(forms)
    texts[path] = texts[path][: match.start(1)] + new + texts[path][match.end(1) :]
    return f"{match[0][:60]} -> {new}"


CHANGES: tuple[Change, ...] = (
    *(rename_somewhere,) * 4,
    *(swap_attributes,) * 3,
    *(move_element,) * 3,
    exchange_files,
    *(add_machine,) * 2,
    drop_file,
    *(change_number,) * 3,
    *(change_property,) * 2,
)


def _names(text: str) -> set[str]:
    values = (a.value.strip() for a in _attributes(text) if a.name in _NAMING)
    return {value for value in values if _WORD.fullmatch(value)}


def _elements(text: str) -> list[Element]:
    return elements_of(text) if text.lstrip().startswith("<") else []


def _attributes(text: str) -> list[Attribute]:
    return [attribute for element in _elements(text) for attribute in element.attributes]


STRATEGY = Strategy("systems", "changes systems across their files", make, share=4)
