# SPDX-License-Identifier: Apache-2.0
"""Models with mocks that the user declares: trees without a system, and systems with leaves that have no plugin
(docs/spec/mocks.md)."""

from __future__ import annotations

import os
import stat
from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from types import MappingProxyType
from typing import TYPE_CHECKING

from roaml.disk import UnreadableReason, read, required
from roaml.durations import DEFAULT_MAX_TIME
from roaml.exact_number import exact_fraction
from roaml.mocks.mock import Mock, MockableWords, MockError, read_mock, read_mocks
from roaml.project.settings import Settings, ament_prefixes
from roaml.record import Record, field, replace
from roaml.text import decode

if TYPE_CHECKING:
    from roaml.api.trees import LoadedTree
    from roaml.lower.programs.executed import ExecutedNode
    from roaml.mocks.proposal import MockableLeaf

MAX_RATE = 10_000
"""The maximum tick rate, in Hz."""
NO_TEXTS: Mapping[str, bytes] = MappingProxyType({})


class MockDeclarations(Record, frozen=True):
    """The mocks that the user declares, and the parameters of a tree without a system.

    Attributes:
        texts: mocks such as `FollowPath: 0.9 in 2 s`.
        file: the path of a file with further mocks; `None` if there is none.
        entries: name of a blackboard entry -> its text at the start.
        rate: the tick rate of the tree in Hz; `None` for the default.
    """

    texts: tuple[str, ...] = ()
    file: str | None = None
    entries: Mapping[str, str] = field(default_factory=dict)
    rate: Fraction | None = None

    @property
    def has_mocks(self) -> bool:
        return bool(self.texts) or self.file is not None

    @property
    def is_empty(self) -> bool:
        return not (self.has_mocks or self.entries or self.rate)

    def mocks(self, parameters: Callable[[], Mapping[str, str]] | None = None) -> tuple[Mock, ...]:
        """The declared mocks, followed by those in the file.

        Args:
            parameters: returns the values of the parameters of a system, by name, which replace `$(var NAME)`
                (docs/spec/parameters.md#uses).

        Raises:
            MockError: a mock is not valid, or the file is not valid UTF-8.
            OSError: the file cannot be read.
        """
        texts, in_file = self.texts, None if self.file is None else _text_of(self.file)
        if parameters is not None and any("$(var" in text for text in (*texts, in_file or "")):
            from roaml.api.parametric_mocks import with_values  # noqa: PLC0415 - most mocks use no parameters

            known = parameters()
            texts = tuple(with_values(text, known) for text in texts)
            in_file = None if in_file is None else with_values(in_file, known)
        mocks = tuple(read_mock(text) for text in texts)
        return mocks if in_file is None else mocks + read_mocks(in_file)


class MockMessages(Record, frozen=True):
    """How messages about mocks reach the user.

    Attributes:
        write: receives notes on the mocks that are used.
        shown: a path -> its text in messages.
        example: how the user declares a mock.
    """

    write: Callable[[str], None]
    shown: Callable[[str], str]
    example: str


def read_rate(text: str) -> Fraction | None:
    """The tick rate in Hz that a text contains; `None` if it is not greater than 0 and at most `MAX_RATE`."""
    rate = exact_fraction(text)
    return rate if rate is not None and 0 < rate <= MAX_RATE else None


def names_tree(path: str, texts: Mapping[str, bytes] = NO_TEXTS) -> bool:
    """Whether a path names a file with behavior trees. `texts` replaces the content of files."""
    if path.endswith(".jani"):
        return False
    data = texts.get(os.path.abspath(path)) or read(path)
    if isinstance(data, UnreadableReason):
        return False  # reported where the file is read
    from roaml.model.kinds import FileKind, kind_of  # noqa: PLC0415 - a JANI model does not need the grammars

    return kind_of(path, decode(path, data).text) is FileKind.TREE


def check_declarations(path: str, declared: MockDeclarations, texts: Mapping[str, bytes] = NO_TEXTS) -> None:
    """Check that declarations fit the kind of a model.

    Raises:
        MockError: they do not.
    """
    if path.endswith(".jani") and not declared.is_empty:
        raise MockError("mocks, entries and a tick rate are for behavior trees; a JANI model has none")
    if (declared.entries or declared.rate) and not names_tree(path, texts):
        raise MockError("entries and a tick rate are for files of behavior trees; a system declares them in its files")


def load_mocked_tree(
    path: str,
    declared: MockDeclarations,
    max_time: int | None,
    settings: Settings,
    messages: MockMessages,
    *,
    counts: bool,
    uses_proposal: bool = False,
    texts: Mapping[str, bytes] = NO_TEXTS,
) -> LoadedTree:
    """A tree without a system, with the declared mocks; if there are none, with those in the file beside the tree. The
    file with mocks is one of the files of the target.

    If no mocks are declared and there is no such file, a proposal is written into it.

    Args:
        max_time: the limit of the simulated time in ns; `None` for the default.
        counts: whether mocks count their answers, for measurements.
        uses_proposal: whether proposed mocks are used at once. They are also added to the file if it lacks some, and
            used if it cannot be written. Otherwise, a `MockError` asks the user to review them.
        texts: absolute path -> bytes that replace the content of the file.

    Raises:
        MockError: a mock is not valid, leaves have no mock, or mocks were proposed and are not used.
        OSError: the file with mocks cannot be read.
        PathError, ModelError: as `load_tree`.
    """
    from roaml.api.trees import load_tree  # noqa: PLC0415 - systems start faster without these
    from roaml.mocks.network import DEFAULT_RATE, MissingMocksError, MockOptions  # noqa: PLC0415
    from roaml.mocks.unfolding import mockable_words  # noqa: PLC0415
    from roaml.model.kinds import mocks_path  # noqa: PLC0415

    beside = mocks_path(path)
    if not declared.has_mocks and os.path.isfile(beside):
        messages.write(f"uses the mocks of {messages.shown(beside)}")
        declared = replace(declared, file=beside)
    mocks = declared.mocks()
    rate, limit = declared.rate or DEFAULT_RATE, max_time or DEFAULT_MAX_TIME
    run = MockOptions(mocks, declared.entries, rate, limit, counts, settings.reaction_time)
    try:
        tree = load_tree(path, run, settings, texts)
    except MissingMocksError as missing:
        if texts or (declared.has_mocks and declared.file != beside):  # nothing is written beside standard input
            raise _without_proposal(path, missing.leaves, messages) from None
        leaves = missing.mockable
        if not uses_proposal:
            raise _review(path, beside, leaves, messages, is_new=declared.file is None) from None
        _keep_proposal(path, beside, leaves, messages)
        declared = replace(declared, file=beside if os.path.isfile(beside) else None)
        proposed = tuple(leaf.proposed for leaf in leaves if leaf.mock is None)
        tree = load_tree(path, replace(run, mocks=mocks + proposed), settings, texts)
    _report_unused(mocks, mockable_words(tree.mocked.tree), messages)
    if declared.file is None:
        return tree
    return replace(tree, target=replace(tree.target, files=(*tree.target.files, os.path.abspath(declared.file))))


def _without_proposal(path: str, nodes: Sequence[ExecutedNode], messages: MockMessages) -> MockError:
    """The error about nodes without a mock for which nothing can be proposed."""
    parents = list(dict.fromkeys(node.type for node in nodes if node.children))
    if not parents:
        return _missing_mocks(path, [node.type for node in nodes], messages)
    return MockError(
        f"{messages.shown(path)}: no library describes these nodes with children: {', '.join(parents)}; "
        f"declare in mocks which nodes of a library they behave like, for example `{parents[0]}: as Sequence`"
    )


def keep_proposal(path: str, leaves: Sequence[MockableLeaf]) -> str:
    """Write the proposed mocks of a tree into the file beside it, or add those that it lacks.

    Returns:
        The number of leaves that had no mock, in words, such as `2 leaves`; "" if all had one.

    Raises:
        OSError: the file cannot be read or written.
    """
    from as2fm_lsp.atomic_write import write_file  # noqa: PLC0415 - most trees have mocks
    from roaml.mocks.proposal import completed_text, proposed_text  # noqa: PLC0415
    from roaml.model.kinds import mocks_path  # noqa: PLC0415

    beside = mocks_path(path)
    if os.path.isfile(beside):
        text = completed_text(required(beside).decode("utf-8"), leaves)
    else:
        text = proposed_text(os.path.basename(path), leaves)
    write_file(beside, text)
    missing = [node for leaf in leaves if leaf.is_missing for node in leaf.nodes]
    return count_of_nodes(missing) if missing else ""


def _keep_proposal(path: str, beside: str, leaves: Sequence[MockableLeaf], messages: MockMessages) -> None:
    reason = _keeping_error(path, beside, leaves)
    if reason:
        messages.write(f"uses proposed mocks, which could not be written into {messages.shown(beside)}: {reason}")
    else:
        messages.write(f"proposed mocks for {_counted(leaves)}: review them in {messages.shown(beside)}")


def _keeping_error(path: str, beside: str, leaves: Sequence[MockableLeaf]) -> str:
    """Write proposed mocks; return why they could not be written, "" if they are."""
    reason = _why_not_written(beside)
    try:
        if not reason:
            keep_proposal(path, leaves)
    except OSError as error:
        return error.strerror or str(error)
    return reason


def _review(
    path: str, beside: str, leaves: Sequence[MockableLeaf], messages: MockMessages, *, is_new: bool
) -> MockError:
    """The error that asks the user to review proposed mocks. They are written if there was no file with mocks."""
    lines = "\n".join(f"  {leaf.line}" for leaf in leaves if leaf.is_missing)
    if not is_new:
        nodes = _noun(any(leaf.kind.has_children for leaf in leaves if leaf.is_missing))[1]
        return MockError(f"{messages.shown(beside)}: {nodes} have no mock; add lines for them, for example\n{lines}")
    reason = _keeping_error(path, beside, leaves)
    if reason:
        return MockError(
            f"{messages.shown(path)}: its leaves need mocks, and a proposal could not be written into "
            f"{messages.shown(beside)}: {reason}; write these lines into a file and name it with --mocks\n{lines}"
        )
    counted = _counted(leaves)
    leaves_ = f"its {counted.removeprefix('1 ')} needs a mock" if counted in _SINGLE else f"its {counted} need mocks"
    events = sum(not leaf.is_missing for leaf in leaves)
    proposal = "a proposal" if not events else f"a proposal, with {events} more for random events,"
    return MockError(
        f"{messages.shown(path)}: {leaves_}; {proposal} is in {messages.shown(beside)}, with a reason for each: "
        f"review it and repeat the command, or set mocks with {messages.example}"
    )


def count_of_nodes(nodes: Sequence[ExecutedNode]) -> str:
    """The number of nodes without a mock, such as `2 leaves`; `2 nodes` if some of them have children."""
    one, many = _noun(any(node.children for node in nodes))
    return f"1 {one}" if len(nodes) == 1 else f"{len(nodes)} {many}"


def _noun(has_parents: bool) -> tuple[str, str]:
    """What nodes without a mock are called, one and several.

    Args:
        has_parents: whether some of them have children.
    """
    return ("node", "nodes") if has_parents else ("leaf", "leaves")


_SINGLE = ("1 leaf", "1 node")


def _counted(leaves: Iterable[MockableLeaf]) -> str:
    """How many leaves, or nodes if some have children, have no mock and, if one line describes several of them, how
    many kinds, each with a line."""
    missing = [leaf for leaf in leaves if leaf.is_missing]
    nodes = [node for leaf in missing for node in leaf.nodes]
    text = count_of_nodes(nodes)
    kinds = "1 kind" if len(missing) == 1 else f"{len(missing)} kinds"
    return text if len(missing) == len(nodes) else f"{text} of {kinds}"


def _why_not_written(beside: str) -> str:
    """Why a file is not written, although the user may be permitted to: its folder belongs to an installed package, or
    nobody has the permission to write into it; "" if there is no reason."""
    folder = os.path.dirname(os.path.realpath(beside))
    installed = [os.path.realpath(prefix) for prefix in ament_prefixes()]
    if any(f"{folder}{os.sep}".startswith(f"{prefix.rstrip(os.sep)}{os.sep}") for prefix in installed):
        return "the folder belongs to an installed package"
    is_writable = os.stat(folder).st_mode & (stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH)
    return "" if is_writable else "the folder is read-only"


def mocked_system_texts(
    path: str,
    declared: MockDeclarations,
    ros_paths: Iterable[str],
    settings: Settings,
    messages: MockMessages,
    texts: Mapping[str, bytes] = NO_TEXTS,
) -> Mapping[str, str | bytes]:
    """The texts of a system's files with the declared mocks.

    Raises:
        MockError: a mock is not valid, or cannot be used for the nodes that it matches, or leaves have none.
        OSError: the file with mocks cannot be read.
        PathError: the path is not a system file.
    """
    from roaml.api.mocked_systems import mock_system  # noqa: PLC0415 - systems without mocks start faster

    def parameters() -> Mapping[str, str]:
        from roaml.api.systems import values_of_parameters  # noqa: PLC0415

        return values_of_parameters(path, ros_paths, settings, texts)

    mocks = declared.mocks(parameters)
    mocked = mock_system(path, mocks, ros_paths, settings, texts)
    if mocked.missing:
        raise _missing_mocks(path, mocked.missing, messages)
    _report_unused(mocks, mocked.words, messages)
    leaves = len({mock.leaf.type for mock in mocked.planned})
    parts = [f"{leaves} {'type' if leaves == 1 else 'types'} of leaves"] if leaves else []
    if mocked.events:
        nodes = "1 node that depends" if mocked.events == 1 else f"{mocked.events} nodes that depend"
        parts.append(f"{nodes} on random events")
    if parts:
        messages.write(f"uses mocks for {' and '.join(parts)}")
    return {**texts, **mocked.texts}


def _text_of(path: str) -> str:
    """The text of a file with mocks."""
    try:
        return required(path).decode("utf-8")
    except UnicodeDecodeError:
        raise MockError(f"{path}: not valid UTF-8; fix the encoding") from None


def _missing_mocks(path: str, types: Iterable[str], messages: MockMessages) -> MockError:
    listed = ", ".join(dict.fromkeys(types))
    return MockError(f"{messages.shown(path)}: these leaves need mocks: {listed}; for example {messages.example}")


def _report_unused(mocks: Iterable[Mock], words: MockableWords, messages: MockMessages) -> None:
    for mock in mocks:
        if reason := words.why_unused(mock):
            messages.write(f"the mock `{mock.pattern}` {reason}")
