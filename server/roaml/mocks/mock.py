# SPDX-License-Identifier: Apache-2.0
"""Mocks of leaves, as they are written on the command line: `FollowPath: 0.9 in 2 s` (docs/spec/mocks.md#leaves)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fnmatch import fnmatchcase
from fractions import Fraction
from typing import TYPE_CHECKING

from roaml.record import Record, replace
from roaml.regex import regex
from roaml.suggest import close_names, did_you_mean
from roaml.text import Span

if TYPE_CHECKING:
    from roaml.distributions.outcomes import Outcomes
    from roaml.mocks.likeness import Likeness
    from roaml.model.drawn_durations import DataReader, DrawnDuration

_MOCK = regex(r"(?P<name>.+?)\s*:\s*(?P<probability>[^\s:]+)(?:\s+in\s+(?P<duration>.+))?\Z")
KEYWORD = "as"
"""The word before the node of a library like which a node is executed."""
_LIKE = regex(rf"(?P<name>.+?)\s*:\s*{KEYWORD}\s+(?P<like>.+)\Z")
_FORMS = "`NODE: 0.9 in 2 s`, or for a node with children as `NODE: as Sequence`"
ALL = "*"
TREE_MARK = "/"
"""Separates the name of a tree from that of a node."""


class MockError(ValueError):
    """A mock is not valid; the message states the reason."""


def drawn_ticks(duration: DrawnDuration, rate: Fraction) -> Outcomes:
    """The numbers of ticks of the tree until a leaf with a drawn duration ends: rounded up, 0 for a negative duration.

    Args:
        rate: the ticks of the tree per second.

    Raises:
        MockError: there are too many different numbers of ticks.
    """
    from roaml.distributions.laws import LawError  # noqa: PLC0415 - few mocks need it

    try:
        return duration.ticks(1000 / rate)
    except LawError as error:
        raise MockError(
            f"`{duration.text}` cannot be the duration of a mock at {float(rate):g} ticks per second: {error}; use a "
            "lower tick rate or shorter durations"
        ) from None


class Mock(Record, frozen=True):
    """A mock: the behaviour of the leaves, or of the nodes with children, whose name or type matches a pattern.

    Attributes:
        pattern: the name of a node or of its type; `*` matches any text and `?` any character. In a system with several
            trees, the name of a tree can precede it: `anna/Grasp`.
        probability: the probability of SUCCESS or, for nodes that depend on the world, of their event at a tick.
        duration: the time for which an action is RUNNING, in ms or as a distribution.
        like: the node of a library like which nodes with children are executed; `None` for a mock of leaves, of which
            alone `probability` and `duration` are.
    """

    pattern: str
    probability: float
    duration: Fraction | DrawnDuration = Fraction(0)
    like: Likeness | None = None

    def with_data(self, read: DataReader) -> Mock:
        """This mock, in which the duration has the values in its file.

        Args:
            read: the name of a file as the mock writes it -> its text; `None` if it cannot be read.

        Raises:
            MockError: the file cannot be read, or is not valid.
        """
        if isinstance(self.duration, Fraction):
            return self
        from roaml.model.drawn_durations import DurationError  # noqa: PLC0415 - few mocks need it

        try:
            return replace(self, duration=self.duration.with_data(read))
        except DurationError as error:
            raise MockError(f"the mock `{self.pattern}: {self.behaviour()}` has no data: {error}") from None

    @property
    def data_file(self) -> str:
        """The name of the file from which the durations are drawn; "" if there is none."""
        if isinstance(self.duration, Fraction) or self.duration.data is None:
            return ""
        return self.duration.data.file

    def behaviour(self, *, is_instant: bool = False) -> str:
        """The probability and the duration, as they are written in a mock: `0.9 in 2 s`.

        Args:
            is_instant: whether the node ignores the duration, such as a condition.
        """
        if self.like is not None:
            return f"{KEYWORD} {self.like.text}"
        share = f"{self.probability:g}"
        if is_instant or not self.duration:
            return share
        if not isinstance(self.duration, Fraction):
            return f"{share} in {self.duration.text}"
        seconds = self.duration / 1000
        return f"{share} in {float(self.duration):g} ms" if seconds < 1 else f"{share} in {float(seconds):g} s"


def read_mock(text: str) -> Mock:
    """The mock in a text such as `FollowPath: 0.9 in 2 s`.

    Raises:
        MockError: `text` is not a valid mock.
    """
    if (like := _LIKE.match(text.strip())) is not None:
        from roaml.mocks.likeness import LikenessError, read_likeness  # noqa: PLC0415 - few mocks need the libraries

        try:
            return Mock(like["name"], 1.0, like=read_likeness(like["like"]))
        except LikenessError as error:
            raise MockError(f"`{text.strip()}` is not a mock: {error}") from None
    match = _MOCK.match(text.strip())
    if match is None:
        raise MockError(f"`{text.strip()}` is not a mock; write one as {_FORMS}")
    if match["probability"] == KEYWORD:
        raise MockError(f"`{text.strip()}` names no node of a library; write a mock as {_FORMS}")
    try:
        probability = float(match["probability"])
    except ValueError:
        probability = -1.0
    if not 0 <= probability <= 1:
        raise MockError(f"`{match['probability']}` in `{text.strip()}` is not a probability from 0 to 1")
    if match["duration"] is None:
        return Mock(match["name"], probability)
    from roaml.model.drawn_durations import DurationError, read_duration  # noqa: PLC0415 - not all mocks need it

    try:
        return Mock(match["name"], probability, read_duration(match["duration"].strip(), f" in `{text.strip()}`"))
    except DurationError as error:
        raise MockError(str(error)) from None


def read_mocks(text: str) -> tuple[Mock, ...]:
    """The mocks in the text of a file. Each line contains one mock; `#` begins a comment.

    Raises:
        MockError: a line is not a valid mock.
    """
    return tuple(read_mock(text[span.start : span.end]) for span in mock_spans(text))


def mock_spans(text: str) -> Iterator[Span]:
    """The places of the mocks in the text of a file, without comments and the blanks around them."""
    start = 0
    for line in text.splitlines(keepends=True):
        mock = without_comment(line).rstrip()
        if mock.strip():
            yield Span(start + len(mock) - len(mock.lstrip()), start + len(mock))
        start += len(line)


_QUOTED_OR_COMMENT = regex(r"""[(,=]\s*(?:'[^'\n]*'|"[^"\n]*")|#""")


def without_comment(line: str) -> str:
    """The part of a line before its comment. `#` in an argument in quotes, such as the name of a file, begins none."""
    comment = next((match for match in _QUOTED_OR_COMMENT.finditer(line) if match[0] == "#"), None)
    return line if comment is None else line[: comment.start()]


def named_mocks(mocks: Mapping[str, str]) -> tuple[Mock, ...]:
    """The mocks in a mapping from nodes to texts such as `0.9 in 2 s`.

    Raises:
        MockError: a mock is not valid.
    """
    return tuple(read_mock(f"{node}: {mock}") for node, mock in mocks.items())


def likeness_for(mocks: Sequence[Mock], name: str, type_: str, tree: str = "") -> Mock | None:
    """The mock that states like which node of a library a node with children is executed, selected as by `mock_for`."""
    return _selected([mock for mock in mocks if mock.like is not None], name, type_, tree)


def mock_for(mocks: Sequence[Mock], name: str, type_: str, succeeds: bool = False, tree: str = "") -> Mock | None:
    """The mock for a leaf: the mock with the name of the node as pattern, otherwise the mock with the type of the node
    as pattern, otherwise the first mock whose pattern matches, otherwise the mock `*`. `None` if no mock matches. Of
    mocks for the same name or type, the one that begins with the name of the tree is used.

    Args:
        succeeds: whether the node is known to always succeed. Then a mock with the probability 1 replaces the mock `*`.
        tree: the name of the executed tree; "" if it has none.
    """
    return _selected([mock for mock in mocks if mock.like is None], name, type_, tree, succeeds=succeeds)


def _selected(mocks: Sequence[Mock], name: str, type_: str, tree: str, *, succeeds: bool = False) -> Mock | None:
    for exact in node_words(name, tree) + node_words(type_, tree):
        for mock in mocks:
            if mock.pattern == exact:
                return mock
    patterns = [mock for mock in mocks if mock.pattern != ALL]
    for mock in patterns:
        if matches(mock.pattern, node_words(name, tree) + node_words(type_, tree)):
            return mock
    if succeeds:
        return Mock(type_, 1.0)
    return next((mock for mock in mocks if mock.pattern == ALL), None)


def node_words(word: str, tree: str) -> tuple[str, ...]:
    """What mocks can call the nodes with a name or type in a tree, the most specific name first."""
    return (f"{tree}{TREE_MARK}{word}", word) if tree else (word,)


class MockableWords(Record, frozen=True):
    """What mocks can call the nodes of trees: their names, their types, and further `node_words`.

    Attributes:
        trees: the trees in words, such as `the tree`.
        nodes: the words for nodes that are executed by a library, or have no children.
        parents: the words for nodes with children that a mock can declare to be executed like a node of a library.
        ambiguous: the names of nodes that share a mock with nodes of other names, because a system has one plugin for
            each type and tree.
        plugged: what mocks can call the nodes that plugins of the system execute, so that they need no mock.
    """

    trees: str
    nodes: tuple[str, ...]
    parents: tuple[str, ...] = ()
    ambiguous: tuple[str, ...] = ()
    plugged: tuple[str, ...] = ()

    def why_unused(self, mock: Mock) -> str:
        """Why a mock has no effect and what to do, as the end of a sentence that begins with the mock; "" if it may
        have one. `*` may always have one."""
        own, others = (self.nodes, self.parents) if mock.like is None else (self.parents, self.nodes)
        if mock.pattern == ALL or matches(mock.pattern, own):
            return ""
        if mock.like is None and matches(mock.pattern, self.ambiguous):
            return "is for one name, but nodes of the same type have other names; write a mock for the type"
        if mock.like is None and matches(mock.pattern, self.plugged):
            return "is not used, because the system lists a plugin for the node; remove the mock, or this plugin"
        if not matches(mock.pattern, others):
            return f"matches no node of {self.trees}{did_you_mean(self.close(mock)) or '; remove it'}"
        if mock.like is None:
            return f"is for leaves, but the node has children; write for example `{mock.pattern}: {KEYWORD} Sequence`"
        return "is for nodes with children that no library describes, but the node is not one of these; remove it"

    def close(self, mock: Mock) -> tuple[str, ...]:
        """The words for nodes that are similar to the pattern of a mock, the most similar first; empty if it matches a
        node."""
        words = (*self.nodes, *self.parents, *self.ambiguous, *self.plugged)
        return () if matches(mock.pattern, words) else close_names(mock.pattern, words)


def matches(pattern: str, words: Iterable[str]) -> bool:
    """Whether a pattern of a mock matches one of the names or types of nodes. Only a pattern that names a tree matches
    a word that names one: `a*` does not match all nodes of the tree `anna`."""
    names_tree = TREE_MARK in pattern
    return any(fnmatchcase(word, pattern) for word in words if names_tree or TREE_MARK not in word)
