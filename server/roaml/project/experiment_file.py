# SPDX-License-Identifier: Apache-2.0
"""Files `NAME.experiment.toml` with the arguments of an experiment: their keys, and the mistakes in them
(docs/experiments.md#files).

The keys are the long options of `as2fm-lsp experiment`. Values of parameters are read when the experiment runs.
"""

from __future__ import annotations

import enum
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from fractions import Fraction
from typing import Any

from roaml.comparison import effect_on_probabilities, read_comparison
from roaml.diagnostics import Finding, Fix
from roaml.exact_number import exact_fraction
from roaml.jani.property_text import is_property_text
from roaml.project.paths import resolve
from roaml.record import Record, field
from roaml.regex import regex
from roaml.suggest import close_names, did_you_mean
from roaml.text import SourceFile, Span, TextEdit
from roaml.toml import Path, Places, TomlError, loads, places

MODEL, SET, UNIT, PROPERTY, FIND, MEETS, RESUME = "model", "set", "unit", "property", "find", "meets", "resume"
_ASKED = regex(r"\s*(\S+)\s*([<>=≤≥].*)")
_MODEL = regex(r"^[ \t]*model[ \t]*=[ \t]*([\"'])([^\"'\n]+)\1", re.MULTILINE)


class KeyForm(enum.Enum):
    """What the value of a key is."""

    VALUE = "a text or a number"
    FLAG = "`true` or `false`"
    ENTRIES = "a list of texts, or a table"


class ExperimentKey(Record, frozen=True):
    """A key of a file.

    Attributes:
        about: what it means, in a sentence of Markdown.
        words: its values, if there are few.
        names_file: whether its values are paths of files that must exist, relative to the file.
    """

    about: str
    form: KeyForm = KeyForm.VALUE
    words: tuple[str, ...] = ()
    names_file: bool = False


_ENTRIES, _FLAG = KeyForm.ENTRIES, KeyForm.FLAG
KEYS: Mapping[str, ExperimentKey] = {
    MODEL: ExperimentKey("The system, the tree with mocks, or the JANI model.", names_file=True),
    SET: ExperimentKey(
        'The values of each parameter: a list, or a range `"20:120:10"`, which is from 20 to 120 in steps of 10.',
        _ENTRIES,
    ),
    PROPERTY: ExperimentKey("The properties that are computed. Without it, all are.", _ENTRIES),
    FIND: ExperimentKey("Find the values of this parameter for which `meets` is met."),
    MEETS: ExperimentKey('With `find`: the expectation, such as `"delivered >= 0.99"`.'),
    "assume-monotone": ExperimentKey("With `find`: assume that the property only rises or only falls.", _FLAG),
    "plot": ExperimentKey("Files into which the points are drawn: `.svg`, `.html` or `.pdf`.", _ENTRIES),
    "beside": ExperimentKey(
        "CSV files with values from elsewhere, such as measurements, that are shown beside the points.",
        _ENTRIES,
        names_file=True,
    ),
    UNIT: ExperimentKey("The units of parameters, for plots.", _ENTRIES),
    "theme": ExperimentKey(
        "The colors of SVG files.", words=("auto", "light", "dark", "high-contrast", "high-contrast-light")
    ),
    "format": ExperimentKey("The format of the table.", words=("text", "csv", "json", "markdown")),
    "output": ExperimentKey("The file into which the table is written."),
    "scheduler": ExperimentKey("With `uniform`, values under uniform choices.", words=("uniform",)),
    "exhaustive": ExperimentKey("Only exact values, however many states there are.", _FLAG),
    "exact": ExperimentKey("The same as `exhaustive`.", _FLAG),
    "slopes": ExperimentKey("Also compute the derivatives of exact probabilities by the parameters.", _FLAG),
    "method": ExperimentKey(
        "How traces are generated; without it, values are exact where possible.",
        words=("adaptive", "okamoto", "sprt", "fixed"),
    ),
    "epsilon": ExperimentKey("Half the width of the interval of an estimate (0.01)."),
    "confidence": ExperimentKey("The probability with which an interval contains the true value (0.95)."),
    "max-traces": ExperimentKey("The maximum number of traces of an estimate."),
    "max-steps": ExperimentKey("The maximum number of steps of a trace (1000000)."),
    "max-states": ExperimentKey("The maximum number of states that are explored for each point."),
    "max-transitions": ExperimentKey("The maximum number of transitions that are explored for each point."),
    "seed": ExperimentKey("The seed of the random numbers (0)."),
    "jobs": ExperimentKey("The number of processes. It does not change the results."),
    "dask": ExperimentKey("The address of the scheduler of a Dask cluster."),
    RESUME: ExperimentKey("The file in which the points are saved. Those that it contains are not computed again."),
    "max-time": ExperimentKey('Overrides `<max_time>` of the system, such as `"100 s"`.'),
    "reaction-time": ExperimentKey(
        'How long machines may wait before a possible step: `any`, `instant`, or `"20 ms"`.'
    ),
    "tree-semantics": ExperimentKey(
        "The meaning of the nodes of BehaviorTree.CPP in systems.", words=("behaviortree-cpp", "as2fm")
    ),
    "ros-path": ExperimentKey("Folders with ROS interface packages.", _ENTRIES),
    "params-file": ExperimentKey("Parameter files of ROS 2, which set other parameters.", _ENTRIES, names_file=True),
    "mock": ExperimentKey('Mocks of leaves, such as `"FollowPath: $(var p) in 8 s"`.', _ENTRIES),
    "mocks": ExperimentKey("A file with mocks.", names_file=True),
    "entry": ExperimentKey("Entries of the blackboard at the start.", _ENTRIES),
    "tick-rate": ExperimentKey("The tick rate of a tree with mocks, in Hz (10)."),
    "live": ExperimentKey("Write the points and plots as JSON Lines while the experiment runs.", _FLAG),
    "constant": ExperimentKey("The same as `set`.", _ENTRIES),
    "quiet": ExperimentKey("Write only results and errors.", _FLAG),
    "verbose": ExperimentKey("Also write what is read and how long it takes.", _FLAG),
}
"""All keys, in the order in which they are offered."""


class AskedModel(Record, frozen=True):
    """The names that an experiment with a system can use: its parameters and properties.

    Attributes:
        probabilities: the properties whose results are probabilities.
        bounds: parameter of the system -> its least and its greatest value, included; `None` if there is none.
    """

    parameters: tuple[str, ...]
    properties: tuple[str, ...]
    bounds: Mapping[str, tuple[Fraction | None, Fraction | None]] = field(default_factory=dict)
    probabilities: frozenset[str] = frozenset()


def key_name(written: str) -> str:
    """The key as it is listed in `KEYS`."""
    return written.replace("_", "-")


def model_in(source: SourceFile) -> str | None:
    """The path of the model that a file names, which may be edited and not valid TOML; `None` if it names none."""
    match = _MODEL.search(source.text)
    return resolve(source.path, match[2]) if match is not None else None


def experiment_findings(
    source: SourceFile,
    read: Callable[[str], object | None],
    asked: Callable[[str], AskedModel | None],
) -> Iterator[Finding]:
    """The mistakes in a file.

    Args:
        read: returns the file with a path; `None` if it cannot be read.
        asked: returns the names of a system; `None` if the path is not that of a known system.
    """
    try:
        table = loads(source.text)
    except TomlError as error:
        message = str(error)
        yield Finding("toml-syntax", error.span, f"{message[:1].lower()}{message[1:]}")
        return
    reader = _Reader(source, places(source.text), read)
    if not isinstance(table.get(MODEL), str):
        start = Span(0, min(1, len(source.text)))
        yield Finding("invalid-setting", start, 'the file names no model; add `model = "main.xml"`')
    for key, value in table.items():
        yield from reader.entry(key, value)
    yield from reader.together(table)
    written = table.get(MODEL)
    names = asked(resolve(source.path, written)) if isinstance(written, str) else None
    if names is not None:
        yield from reader.names(table, names)


class _Reader:
    def __init__(self, source: SourceFile, known: Places, read: Callable[[str], object | None]) -> None:
        self._source = source
        self._known = known
        self._read = read

    def entry(self, written: str, value: Any) -> Iterator[Finding]:
        """The mistakes in a key and in the form of its value."""
        key = KEYS.get(key_name(written))
        if key is None:
            close = close_names(written, KEYS)
            text = f"there is no option `{written}`{did_you_mean(close)}"
            yield self._at(self._known.keys.get((written,)), (written,), text, close)
            return
        flag, entries = key.form is KeyForm.FLAG, key.form is KeyForm.ENTRIES
        fits = isinstance(value, bool) if flag else isinstance(value, (str, int, float)) and not isinstance(value, bool)
        if not fits and not (entries and isinstance(value, (list, dict))):
            yield self._at(None, (written,), f"`{written}` must be {key.form.value}")
        elif key.words and value not in key.words:
            close = close_names(str(value), key.words)
            hint = did_you_mean(close) or f"; the values are {_listed(key.words)}"
            yield self._at(None, (written,), f"`{value}` is not a value of `{written}`{hint}", close)
        elif key.names_file:
            for path, name in _texts((written,), value):
                if self._read(resolve(self._source.path, name)) is None:
                    yield self._at(
                        None, path, f"there is no file `{name}`; paths are relative to the folder of this file"
                    )

    def together(self, table: Mapping[str, Any]) -> Iterator[Finding]:
        """The keys that need another one, or exclude it."""
        if FIND not in table:
            if MEETS in table:
                yield self._at_key(MEETS, f"`{MEETS}` needs `{FIND}`, the parameter for which values are searched")
        elif MEETS not in table:
            yield self._at_key(FIND, f'`{FIND}` needs `{MEETS}`, such as `{MEETS} = "delivered >= 0.99"`')
        else:
            if PROPERTY in table:
                yield self._at_key(PROPERTY, f"`{FIND}` computes the property in `{MEETS}`; remove `{PROPERTY}`")
            if RESUME in table:
                yield self._at_key(RESUME, f"`{FIND}` saves no points; remove `{RESUME}`")

    def _at_key(self, key: str, message: str) -> Finding:
        return self._at(self._known.keys.get((key,)), (key,), message)

    def names(self, table: Mapping[str, Any], names: AskedModel) -> Iterator[Finding]:
        """The names that the model does not have."""
        swept: list[str] = []
        for path, name, span in self._named(table, SET, "constant"):
            swept.append(name)
            yield from self._unknown(span, path, name, names.parameters, "parameter")
        for path, name, text in self._values(table):
            yield from self._outside(path, name, text, names)
        for path, name in _texts((PROPERTY,), table.get(PROPERTY, [])):
            if not is_property_text(name):
                yield from self._unknown(None, path, name, names.properties, "property")
        for path, name, span in self._named(table, UNIT):
            if name not in swept:
                close = close_names(name, swept)
                text = f"`{name}` is not a parameter of this experiment{did_you_mean(close)}"
                yield self._at(span, path, text, close)
        meets = table.get(MEETS)
        asked = _ASKED.fullmatch(meets) if isinstance(meets, str) else None
        comparison = read_comparison(asked[2]) if asked is not None and asked[1] in names.probabilities else None
        if comparison is not None and (effect := effect_on_probabilities(comparison)):
            text = (
                f"`{asked[1] if asked else ''}` is a probability, which is from 0 to 1, so this is {effect}; change it"
            )
            yield self._at(None, (MEETS,), text)
        find = table.get(FIND)
        if isinstance(find, str) and find not in swept:
            close = close_names(find, swept)
            yield self._at(None, (FIND,), f"`{find}` has no values to try; add it to `set`{did_you_mean(close)}", close)

    def _named(self, table: Mapping[str, Any], *keys: str) -> Iterator[tuple[Path, str, Span | None]]:
        """The names in the entries `NAME = VALUE` of tables, and in lists of texts of this form."""
        for key in keys:
            value = table.get(key, {})
            if isinstance(value, dict):
                yield from (((key, name), name, self._known.keys.get((key, name))) for name in value)
            else:
                yield from ((path, text.partition("=")[0].strip(), None) for path, text in _texts((key,), value))

    def _values(self, table: Mapping[str, Any]) -> Iterator[tuple[Path, str, str]]:
        """The values of each parameter, as far as they are texts or numbers: their places, the names of the parameters,
        and the texts of the values."""
        for key in (SET, "constant"):
            value = table.get(key, {})
            for name, entry in value.items() if isinstance(value, dict) else ():
                yield from ((path, name, text) for path, text in _texts((key, name), _as_texts(entry)))
            for path, text in () if isinstance(value, dict) else _texts((key,), value):
                name, _, values = text.partition("=")
                yield path, name.strip(), values

    def _outside(self, path: Path, name: str, text: str, names: AskedModel) -> Iterator[Finding]:
        """Report a value that is less than the least or greater than the greatest value of its parameter."""
        least, most = names.bounds.get(name, (None, None))
        for number in _ends(text):
            if least is not None and number < least:
                bound = f"at least {_number(least)}"
            elif most is not None and number > most:
                bound = f"at most {_number(most)}"
            else:
                continue
            yield self._at(None, path, f"`{name}` must be {bound}, but one of the values is {_number(number)}")
            return

    def _unknown(
        self, span: Span | None, path: Path, name: str, known: tuple[str, ...], what: str
    ) -> Iterator[Finding]:
        if name not in known:
            close = close_names(name, known)
            hint = did_you_mean(close) if close else f"; it has {_listed(sorted(known))}" if known else ""
            yield self._at(span, path, f"the system has no {what} `{name}`{hint}", close)

    def _at(self, span: Span | None, path: Path, message: str, close: Iterable[str] = ()) -> Finding:
        """A finding at a span, by default that of the value at a path, with a fix for each similar name."""
        span = span or self._known.values.get(path) or self._known.keys.get(path) or Span(0, 1)
        quote = self._source.text[span.start : span.start + 1]
        quote = quote if quote in ("'", '"') else ""
        fixes = tuple(
            Fix(f"Change to `{name}`", (TextEdit(span, f"{quote}{name}{quote}"),), preferred=number == 0)
            for number, name in enumerate(close)
        )
        return Finding(
            "invalid-setting", span, message, fixes=fixes if quote or span in self._known.keys.values() else ()
        )


def _texts(path: Path, value: Any) -> Iterator[tuple[Path, str]]:
    """The texts in a value: itself, or those in a list."""
    if isinstance(value, str):
        yield path, value
    elif isinstance(value, list):
        yield from (((*path, number), text) for number, text in enumerate(value) if isinstance(text, str))


def _listed(names: Iterable[str]) -> str:
    return ", ".join(f"`{name}`" for name in names)


def _as_texts(value: Any) -> Any:
    """A number as a text, also in a list; other values as they are."""
    if isinstance(value, list):
        return [_as_texts(entry) for entry in value]
    return str(value) if isinstance(value, (int, float)) and not isinstance(value, bool) else value


def _ends(text: str) -> Iterator[Fraction]:
    """The numbers in a list of values, of a range only its ends: the step is its last or its second number."""
    for entry in text.split(","):
        numbers = [exact_fraction(part) for part in entry.split(":")]
        known = [number for number in numbers if number is not None]
        if known and len(known) == len(numbers):
            yield known[0]
            yield from (max(known[1:]),) if len(known) > 1 else ()


def _number(value: Fraction) -> str:
    return str(value.numerator) if value.denominator == 1 else f"{float(value):g}"
