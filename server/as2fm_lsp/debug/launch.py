# SPDX-License-Identifier: Apache-2.0
"""The `launch` request: reading the model and starting the requested run."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping

from as2fm_lsp.debug.arguments import Arguments, RequestError
from as2fm_lsp.mocked_models import (
    MAX_RATE,
    MockDeclarations,
    MockMessages,
    check_declarations,
    load_mocked_tree,
    mocked_system_texts,
    names_tree,
    read_rate,
)
from roaml import api
from roaml.debugging.debugger import Debugger, Log
from roaml.debugging.sources import Sources
from roaml.debugging.start import Start, StartError, Watch, start
from roaml.diagnostics import Diagnostic
from roaml.disk import MAX_DATA, NotReadableError, UnreadableReason, is_valid_path, required, status_of
from roaml.durations import REACTION_TIME, ReactionTime, duration, reaction_time
from roaml.language.grammar import XML_GRAMMARS
from roaml.mocks.mock import MockError
from roaml.model.parameters import Overrides
from roaml.project.configuration import find_settings
from roaml.project.settings import ament_prefixes
from roaml.record import Record, replace
from roaml.scxml.names import SUCCEEDS
from roaml.simulation import RunError, SavedSession
from roaml.smc.fault import FaultError
from roaml.smc.record import TraceVerdict
from roaml.suggest import listing
from roaml.text import SourceFile
from roaml.verification.target import VerificationTarget

MAX_SAVED = 1 << 26
"""The maximum size of a saved session in bytes."""


class Launch(Record, frozen=True):
    """The arguments of `launch`.

    Attributes:
        program: the system file, a file of behavior trees, or a JANI model.
        stops_on_entry: whether the run stops at its start.
        max_time: overrides the time limit of the system, in ns.
        reaction_time: overrides the reaction time of the system.
        parameters: names and texts of values for parameters that the models of a system declare.
        constants: `NAME=VALUE` for constants of a JANI model.
        mocks: the mocks of leaves without a plugin, and the parameters of a tree without a system.
    """

    program: str
    start: Start
    stops_on_entry: bool
    max_time: int | None
    reaction_time: ReactionTime | None
    parameters: tuple[tuple[str, str], ...]
    constants: tuple[str, ...]
    ros_paths: tuple[str, ...]
    mocks: MockDeclarations


def warm_up() -> None:
    """Import the rules and read the grammars of XML files, which every `launch` needs."""
    api.load  # noqa: B018 - `roaml.api` imports its modules on use
    for grammar in XML_GRAMMARS:
        grammar.elements  # noqa: B018 - computed once


def launch_of(arguments: Arguments) -> Launch:
    """The arguments of a `launch` request, checked.

    Raises:
        RequestError: an argument is missing or not valid, or the saved session cannot be read.
    """
    program = _program(arguments.text("program", None))
    against, in_favour = arguments.natural("against", 0), arguments.natural("inFavor", 0)
    if against and in_favour:
        raise RequestError("`against` and `inFavor` exclude each other")
    saved = arguments.text("session")
    max_time = arguments.text("maxTime")
    nanoseconds = duration(max_time) if max_time else None
    if max_time and nanoseconds is None:
        raise RequestError(f'`maxTime` is `{max_time}`, which is not a duration such as "10 s"')
    written = arguments.text("reactionTime")
    reaction = reaction_time(written) if written else None
    if written and reaction is None:
        raise RequestError(f"`reactionTime` is `{written}`; {REACTION_TIME}")
    begin = Start(
        arguments.text("property"),
        arguments.natural("seed", 0),
        arguments.natural("trace", 0),
        against or in_favour,
        TraceVerdict.PASSED if in_favour else TraceVerdict.FAILED,
        _saved(os.path.join(os.path.dirname(program), saved)) if saved else None,
    )
    return Launch(
        program,
        begin,
        arguments.flag("stopOnEntry", not begin.nth),
        nanoseconds,
        reaction,
        tuple(_values(arguments, "parameters").items()),
        tuple(f"{name}={value}" for name, value in _values(arguments, "constants").items()),
        tuple(arguments.texts("rosPath")),
        _mocks(arguments, os.path.dirname(program)),
    )


def _program(text: str) -> str:
    """The absolute path of the model.

    Raises:
        RequestError: there is no file that can be read.
    """
    if not text or not is_valid_path(text):
        raise RequestError("`program` is not the path of a file")
    path = os.path.abspath(text)
    status = status_of(path, MAX_DATA)
    if isinstance(status, UnreadableReason):
        raise RequestError(f"{path}: {status.value}")
    return path


def _mocks(arguments: Arguments, folder: str) -> MockDeclarations:
    file, rate = arguments.text("mocksFile"), None
    if not is_valid_path(file):
        raise RequestError("`mocksFile` is not a path")
    if arguments.has("tickRate"):
        rate = read_rate(str(arguments.decimal("tickRate", 0)))
        if rate is None:
            raise RequestError(f"`tickRate` must be a number of Hz, greater than 0 and at most {MAX_RATE}")
    return MockDeclarations(
        tuple(arguments.texts("mocks")),
        os.path.join(folder, file) if file else None,
        _values(arguments, "entries"),
        rate,
    )


def _values(arguments: Arguments, name: str) -> Mapping[str, str]:
    """The members of an object with values, as texts; empty if it is missing."""
    values = arguments.members.get(name) or {}
    if not isinstance(values, dict):
        raise RequestError(f"`{name}` must be an object")
    return {key: str(value).lower() if isinstance(value, bool) else str(value) for key, value in values.items()}


def _saved(path: str) -> SavedSession:
    try:
        return SavedSession.from_json(required(path, MAX_SAVED).decode("utf-8"))
    except NotReadableError as error:
        raise RequestError(str(error)) from None
    except ValueError as error:
        raise RequestError(f"{path}: {error}") from None


def load(launch: Launch, log: Log, watch: Watch) -> Debugger:
    """The debugger for a `launch` request.

    Raises:
        RequestError: the model cannot be run, or the run does not exist.
    """
    try:
        return start(_sources(launch, log), launch.start, log, watch)
    except api.ModelError as error:
        hint, others = "", [name for name in error.unset[1:] if name]
        if any(error.unset[:1]):
            also = f"; nothing sets {listing(others)} either" if others else ""
            hint = f", with `entries` in the launch configuration{also}"
        raise RequestError(f"{_first(error.result.diagnostics, error.result.source)}{hint}") from None
    except api.JaniError as error:
        source = error.source
        raise RequestError(_first(error.diagnostics, lambda _: source)) from None
    except OSError as error:
        raise RequestError(f"{error.filename or launch.program}: {error.strerror or error}") from None
    except (
        StartError,
        RunError,
        MockError,
        api.ParameterError,
        api.PathError,
        api.PropertyError,
        api.ConstantError,
    ) as error:
        raise RequestError(str(error)) from None
    except FaultError as fault:
        raise RequestError(f"the model cannot be run: {fault.message}") from None


def _sources(launch: Launch, log: Log) -> Sources:
    path, mocks = launch.program, launch.mocks
    settings, problems = find_settings(path)
    if problems:
        raise RequestError(problems[0])
    settings = replace(settings, ament_prefixes=ament_prefixes())
    check_declarations(path, mocks)
    overrides = Overrides(launch.max_time, None, launch.reaction_time, values=launch.parameters)
    if path.endswith(".jani"):
        return Sources(api.target(path, launch.ros_paths, settings, None, overrides, launch.constants))
    messages = MockMessages(lambda text: log(text, None), str, '`"mocks": ["*: 0.9 in 1 s"]`')
    if names_tree(path):
        settings = replace(settings, reaction_time=launch.reaction_time or settings.reaction_time)
        tree = load_mocked_tree(path, mocks, launch.max_time, settings, messages, counts=False, uses_proposal=True)
        return Sources(_with_one_property(tree.target, launch.start), tree=tree.mocked.tree)
    around = replace(settings, overrides=overrides)
    texts = None if mocks.is_empty else mocked_system_texts(path, mocks, launch.ros_paths, around, messages)
    system = api.load(path, launch.ros_paths, settings, texts, overrides)
    return Sources(api.as_target(system), system.analysis)


def _with_one_property(target: VerificationTarget, begin: Start) -> VerificationTarget:
    """The model of a tree without a system, with only the property of the run: `succeeds` if none is named. The
    properties of a tree exclude each other, so every run would stop where one of them is violated."""
    name = (begin.saved.property if begin.saved else begin.property) or SUCCEEDS
    properties = tuple(property_ for property_ in target.model.properties if property_.name == name)
    return replace(target, model=replace(target.model, properties=properties)) if properties else target


def _first(diagnostics: tuple[Diagnostic, ...], source_of: Callable[[str], SourceFile]) -> str:
    first = diagnostics[0]
    line = source_of(first.path).lines.position(first.span.start).line + 1
    more = f" ({len(diagnostics) - 1} more)" if len(diagnostics) > 1 else ""
    return f"{first.path}:{line}: {first.message}{more}"
