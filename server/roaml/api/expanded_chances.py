# SPDX-License-Identifier: Apache-2.0
"""The probabilities of a system that depend on its parameters, if nothing else does.

The expansion replaces parameters by their values (docs/spec/parameters.md#expansion), and records each edit. A
parameter on which only probabilities depend changes only edits inside of attributes `prob`, and of `loss` in channels.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeAlias

from roaml.diagnostics import Severity
from roaml.exact_number import exact_fraction
from roaml.expansion.channels import CHANNEL, LOSS
from roaml.experiments.parametric import Chances
from roaml.experiments.sweeps import Setting
from roaml.project.analysis import Analysis
from roaml.project.checking import own_severity
from roaml.record import Record, replace
from roaml.xml_syntax import Document, Element

Place: TypeAlias = tuple[str, int, int]
"""The path under which an expanded text is analysed, how many expansions were made before the one of an edit, and the
offset of the edit in the text before it: for the first expansion, in the file of the user."""
_PLACES = (0.41, 0.59)
"""Where the values of a parameter that are compared are between its least and its greatest value."""


class ExpandedChances(Record, frozen=True):
    """The probabilities that are written at some places, and what is left of 1."""

    analysis: Analysis
    path: str
    places: tuple[Place, ...]

    def at(self, setting: Setting) -> list[float] | None:
        texts = _texts(self.analysis, self.path, setting)
        if texts is None or not texts.keys() >= set(self.places):
            return None
        numbers = [exact_fraction(texts[place]) for place in self.places]
        known = [number for number in numbers if number is not None]
        if len(known) < len(numbers):
            return None
        return [float(number) for number in (*known, *(1 - number for number in known))]


def expanded_chances(analysis: Analysis, path: str, ranges: Mapping[str, tuple[float, float]]) -> Chances | None:
    """The probabilities that depend on parameters; `None` if there are none, or if anything else does.

    Args:
        analysis: an analysis with the values of the other parameters.
        path: the system file.
        ranges: parameter -> its least and its greatest value.
    """
    expanded = analysis.expanded(path)
    if expanded is None or expanded.expansion.drawn:  # the values of draws may depend on the parameters
        return None
    low, high = (
        {name: repr(least + (most - least) * place) for name, (least, most) in ranges.items()} for place in _PLACES
    )
    base = _texts(analysis, path, tuple(low.items()))
    places: set[Place] = set()
    for name in ranges:
        other = _texts(analysis, path, tuple({**low, name: high[name]}.items()))
        if base is None or other is None or base.keys() != other.keys():
            return None
        places |= {place for place, text in base.items() if text != other[place]}
    sources = {place: expanded.expansion.source(place[0]) for place in places}
    if not places or not all(not p[1] and _is_probability(analysis.document(sources[p]), p[2]) for p in places):
        return None
    return ExpandedChances(analysis, path, tuple(sorted(places)))


def _texts(analysis: Analysis, path: str, setting: Setting) -> dict[Place, str] | None:
    """The new texts of all edits of the expansion for a setting; `None` if the parameters cannot have these values."""
    overrides = replace(analysis.overrides, values=(*analysis.overrides.values, *setting))
    other = Analysis(analysis.files, analysis.registry, analysis.memo, (path,), overrides, analysis.tree_settings)
    expanded = other.expanded(path)
    if expanded is None:
        return None
    findings = (finding for of_file in expanded.expansion.findings.values() for finding in of_file)
    if any(own_severity(finding) is Severity.ERROR for finding in findings):
        return None
    return {
        (name, number, edit.span.start): edit.new_text
        for name, text in expanded.expansion.texts.items()
        for number, expansion in enumerate(text.expansions)
        for edit in expansion.edits
    }


def _is_probability(document: Document | None, offset: int) -> bool:
    """Whether an offset is inside of an attribute `prob`, or of the `loss` of a channel."""
    if document is None or document.root is None:
        return False
    waiting: list[Element] = [document.root]
    while waiting:
        element = waiting.pop()
        attribute = element.get(LOSS if element.name == CHANNEL else "prob")
        if attribute is not None and attribute.span.start <= offset <= attribute.span.end:
            return True
        waiting += element.elements
    return False
