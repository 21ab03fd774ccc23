# SPDX-License-Identifier: Apache-2.0
"""Interactive simulation on a terminal: it lists the possible next steps and reads one command per line."""

from __future__ import annotations

import itertools
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TextIO

from as2fm_lsp.cli.model_arguments import fault_text, line_of
from as2fm_lsp.cli.output import flush, print_text
from as2fm_lsp.outputs import OutputFiles
from roaml.durations import duration, moment
from roaml.scxml.names import is_blackboard
from roaml.simulation import Choice, Session
from roaml.smc.fault import FaultError
from roaml.smc.record import Plain, RecordedVariable
from roaml.verification.target import VerificationTarget
from roaml.views.arrays import ArrayReader, without_lengths
from roaml.views.event_words import event_phrase
from roaml.views.library_nodes import is_library_node
from roaml.views.observed import observer_phrase
from roaml.views.values import shown_parameters, shown_value

HELP = """\
  Enter        take the step that the seed decides
  2            take choice 2; 2b: with its outcome b
  t            go on until a machine has handled an event      k   go on for one tick of the tree
  b, b 10      go back one step, ten steps                     g 40, g 3 s   go to a step, or on to a time
  e            go on until the property is decided             u NAME   go on to the next event or message NAME
  s            show the state                                  w FILE   write the run, for --script
  ?            this help                                       q   quit
  Ctrl-C       end a long movement at the step that it has reached
"""


@contextmanager
def interrupts() -> Iterator[Callable[[], bool]]:
    """Catches interrupts (Ctrl-C); yields a function that returns whether there was one."""
    received: list[int] = []
    is_main = threading.current_thread() is threading.main_thread()  # only the main thread can catch signals
    previous = signal.signal(signal.SIGINT, lambda number, _: received.append(number)) if is_main else None
    try:
        yield lambda: bool(received)
    finally:
        if is_main:
            signal.signal(signal.SIGINT, previous)


class Terminal:
    """Shows a session, and executes the commands of the input."""

    def __init__(self, session: Session, target: VerificationTarget, outputs: OutputFiles) -> None:
        self._session = session
        self._target = target
        self._outputs = outputs
        self._arrays: ArrayReader | None = None
        self._read_steps = 0

    def run(self, lines: TextIO) -> None:
        """Execute commands until the input ends or contains `q`."""
        print_text(HELP)
        self._show_choices()
        while True:
            print_text("> ")
            flush()
            line = lines.readline()
            if not line or line.strip() in ("q", "quit"):
                print_text("\n" if not line else "")
                return
            self._do(line.strip())

    def _do(self, line: str) -> None:
        command, _, rest = line.partition(" ")
        if command == "?":
            print_text(HELP)
            return
        if command == "s":
            print_text("".join(f"  {text}\n" for text in self._state()))
            return
        before = self._session.position
        with interrupts() as has_interrupt:
            self._session.is_interrupted = has_interrupt
            try:
                message = self._move(command, rest.strip(), line)
            except FaultError as fault:
                message = f"the next step fails: {fault_text(self._target, fault)}"
            if has_interrupt():
                message = "interrupted"
        self._show_steps(before)
        if message:
            print_text(f"  {message}\n")
        self._show_choices()

    def _move(self, command: str, rest: str, line: str) -> str:
        """Execute a command that moves or saves the session; return a message for the user."""
        session = self._session
        match command:
            case "w":
                return self._save(rest)
            case "":
                session.step()
            case "t":
                session.turn()
            case "k":
                return "" if session.tick() else "the tree was not ticked again"
            case "e":
                session.until_decided()
                return f"{session.save().property}: {session.verdict}"
            case "b":
                if rest and not rest.isdecimal():
                    return "`b` needs a number of steps, such as `b 10`"
                session.back(int(rest or 1))
            case "g":
                return self._go(rest)
            case "u":
                return self._until(rest)
            case _:
                return self._choose(line)
        return ""

    def _save(self, path: str) -> str:
        if not path:
            return "`w` needs the name of a file, such as `w run.json`"
        try:
            self._outputs.write(path, self._session.save().to_json())
        except OSError as error:
            return f"{path}: {error.strerror or error}"
        return f"written to {path}"

    def _go(self, text: str) -> str:
        time = duration(text)
        if text.isdecimal():
            self._session.jump(int(text))
        elif time is None:
            return "`g` needs a step or a time, such as `g 40` or `g 3 s`"
        elif not self._session.until_time(time / 1e9):
            return f"the run ends before {text}"
        return ""

    def _until(self, name: str) -> str:
        if not self._session.has_event(name):
            return f"there is no event, topic, service or action `{name}`; a topic is written as `/name`"
        return "" if self._session.until_sent(name) else f"`{name}` was not sent again"

    def _choose(self, text: str) -> str:
        choices = {str(choice.number): choice for choice in self._session.choices()}
        letter = text[-1:] if text[-1:].isalpha() else ""
        choice = choices.get(text.removesuffix(letter))
        if choice is None:
            return f"`{text}` is neither a choice nor a command; `?` lists the commands"
        outcomes = dict(zip(_LETTERS, choice.outcomes, strict=False))
        if letter and letter not in outcomes:
            return f"choice {choice.number} has no outcome `{letter}`"
        self._session.step(choice, outcomes.get(letter))
        return ""

    # ------------------------------------------------------------ output

    def _show_steps(self, before: int) -> None:
        """Show what the steps after step `before` have changed."""
        session = self._session
        if session.position < self._read_steps:
            self._arrays = None  # the next steps may differ from those that were read
        if session.position <= before:
            return
        if self._arrays is None:
            self._arrays, self._read_steps = ArrayReader(session.automata_of_model, session.start), 0
        first_shown = max(before, session.position - MAX_STEPS_SHOWN) + 1
        for step in itertools.islice(session.steps, self._read_steps, session.position):
            read = self._arrays.read(step)
            if step.number < first_shown:
                continue
            changes = ", ".join(
                f"{self._name(change.variable)}: {shown_value(change.before)} → {shown_value(change.after)}"
                for change in read
                if change.variable.instance >= 0 and session.is_machine(change.variable.instance)
            )
            if changes:
                print_text(f"  {step.number:>6}  {changes}\n")
        self._read_steps = session.position

    def _name(self, variable: RecordedVariable) -> str:
        """The name of a variable of a machine."""
        name = variable.name
        return self._session.phrases(self._session.automata[variable.instance]).get(name, name)

    def _show_choices(self) -> None:
        session = self._session
        state = session.state()
        time = "" if state.time is None else f", {moment(state.time)}"
        decided = f", {session.save().property}: {session.verdict}" if session.is_decided else ""
        print_text(f"step {session.position}{time}{decided}\n")
        end = session.end
        if end is not None:
            print_text(f"  the run has ended: {end.text}\n")
            return
        for choice in session.choices():
            print_text("".join(f"{line}\n" for line in self._choice(choice)))

    def _choice(self, choice: Choice) -> Iterator[str]:
        yield f"  {choice.number:>2}  {choice.text}  {line_of(self._target, choice.origin)}".rstrip()
        if len(choice.outcomes) > 1:
            for letter, outcome in zip(_LETTERS, choice.outcomes, strict=False):
                yield f"      {letter}  by chance, {outcome.probability:g}: {outcome.text}"

    def _state(self) -> Iterator[str]:
        session = self._session
        state = session.state()
        stored: dict[str, dict[str, Plain]] = {}
        for (instance, name), value in session.values():
            stored.setdefault(session.automata[instance] if instance >= 0 else "", {})[name] = value
        shown = {automaton: without_lengths(values) for automaton, values in stored.items()}
        library = {automaton.name for automaton in session.automata_of_model if is_library_node(automaton)}
        of_nodes = {}
        for machine in state.machines:
            phrases, own = session.phrases(machine.automaton), shown.get(machine.automaton, {})
            values = shown_parameters({phrases.get(name, name): value for name, value in own.items()})
            if machine.automaton in library:
                of_nodes[machine.name] = f" ({values})" if values else ""
                continue
            handled = event_phrase(machine.event, session.automata, taken=True) if machine.event else ""
            handles = f", handles {handled}" if handled else ""
            yield f"{machine.name}: {machine.state}{handles}{f' ({values})' if values else ''}"
        for node in state.nodes:
            yield f"{node.name}: {node.status.value}{of_nodes.get(node.name, '')}"
        for event in state.events:
            values = shown_parameters(event.parameters)
            waiting = ", not received yet" if event.is_waiting else ""
            yield f"{event.text}{f' ({values})' if values else ''}, step {event.step}{waiting}"
        boards = (own for name, own in shown.items() if is_blackboard(name))
        common = {**{name: value for own in boards for name, value in own.items()}, **shown.get("", {})}
        for name in {**state.blackboard, **state.shared}:
            yield f"{observer_phrase(name, session.automata) or name}: {shown_value(common[name])}"


MAX_STEPS_SHOWN = 40
"""The maximum number of steps whose changes are shown after a command."""
_LETTERS = "abcdefghijklmnoprsuvwxyz"
