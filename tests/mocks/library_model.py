# SPDX-License-Identifier: Apache-2.0
"""A second implementation of BehaviorTree.CPP, 4.10 and older versions, and of Nav2, as classes that call each other.

It is written from facts about the libraries, independently of the programs in `roaml.libraries.programs`. Leaves take
their outcomes from lists, so a run can be repeated with the random outcomes of another run.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import Any, ClassVar

IDLE, S, F, R, SKIP = "IDLE", "SUCCESS", "FAILURE", "RUNNING", "SKIPPED"
ENDED = (S, F)


class LibraryError(Exception):
    """The library throws an exception."""


class OutOfOutcomesError(Exception):
    """The run continues after the end of the recorded one."""


class World:
    """The state that all nodes of a tree share.

    Attributes:
        calls: leaf and answer for each call of a leaf, and ("halt", leaf).
        outcomes: leaf -> its random outcomes, in order.
        writes: entry -> how often it was written.
        happens: whether events of the world that Nav2's nodes ask about always occur, or never.
        version: the version of BehaviorTree.CPP, as numbers.
    """

    def __init__(
        self,
        entries: dict[str, Any],
        outcomes: dict[str, list[str]],
        rate: int = 10,
        *,
        happens: bool = False,
        version: tuple[int, ...] = (4, 10),
    ) -> None:
        self.version = version
        self.entries, self.outcomes, self.rate, self.happens = entries, outcomes, rate, happens
        self.calls: list[tuple[str, str]] = []
        self.writes: dict[str, int] = dict.fromkeys(entries, 1)

    def run(self, script: str) -> Any:
        """The value of the last statement of a script; Python's syntax is close enough for those that tests use."""
        value: Any = None
        for statement in filter(None, (part.strip() for part in script.split(";"))):
            match = re.fullmatch(r"(\w+)\s*(:=|\+=|-=|=)\s*(.+)", statement)
            if match and not match[3].startswith("="):
                right = eval(match[3].replace("&&", " and ").replace("||", " or "), {}, self.entries)
                if match[2] in ("+=", "-="):
                    right = self.entries[match[1]] + (right if match[2] == "+=" else -right)
                self.write(match[1], right)
                value = right
            else:
                value = eval(statement.replace("&&", " and ").replace("||", " or "), {}, self.entries)
        return value

    def write(self, entry: str, value: Any) -> None:
        self.entries[entry] = value
        self.writes[entry] = self.writes.get(entry, 0) + 1

    def draw(self, leaf: str) -> str:
        if not self.outcomes.get(leaf):
            raise OutOfOutcomesError
        return self.outcomes[leaf].pop(0)

    def ticks(self, milliseconds: float) -> int:
        return math.ceil(milliseconds * self.rate / 1000)


class Node:
    def __init__(self, world: World, name: str, ports: dict[str, str], children: list[Node]) -> None:
        self.world, self.name, self.ports, self.children = world, name, ports, children
        self.status = IDLE

    def number(self, port: str, default: float | None = None) -> Any:
        text = self.ports.get(port)
        if text is None:
            return default
        if text.startswith("{"):
            return self.world.entries[text.strip("{}")]
        return float(text) if "." in text else int(text)

    def execute(self) -> str:
        status = self.before()
        if status is None:
            status = self.tick()
        if status in ENDED:
            self.after("_onSuccess" if status == S else "_onFailure")
            self.after("_post")
        if status != SKIP:
            self.status = status
        return status

    def before(self) -> str | None:
        if self.status == IDLE:
            for key, answer in (("_failureIf", F), ("_successIf", S), ("_skipIf", SKIP)):
                if key in self.ports and self.world.run(self.ports[key]):
                    return answer
            if "_while" in self.ports and not self.world.run(self.ports["_while"]):
                return SKIP
        elif self.status == R and "_while" in self.ports and not self.world.run(self.ports["_while"]):
            self.halt_node()
            return SKIP
        return None

    def after(self, key: str) -> None:
        if key in self.ports:
            self.world.run(self.ports[key])

    def halt_node(self) -> None:
        self.halt()
        self.status = IDLE
        self.after("_onHalted")

    def tick(self) -> str:
        raise NotImplementedError

    def halt(self) -> None:
        for child in self.children:
            reset(child)

    def reset_children(self) -> None:
        for child in self.children:
            reset(child)


def reset(node: Node) -> None:
    if node.status == R:
        node.halt_node()
    node.status = IDLE


# ------------------------------------------------------------------ control nodes


class InTurn(Node):
    """Sequences and fallbacks. `goes_on` is the status after which the next child is ticked."""

    goes_on, yields, remembers = S, False, False
    index = 0
    skipped = 0

    def tick(self) -> str:
        if self.status in (IDLE, SKIP):
            self.skipped = 0
        self.status = R
        while self.index < len(self.children):
            child = self.children[self.index]
            previous = child.status
            answer = child.execute()
            if answer == R:
                return R
            if answer == SKIP:
                self.index += 1
                self.skipped += 1
            elif answer == self.goes_on:
                self.index += 1
                if self.yields and previous == IDLE and self.index < len(self.children):
                    return R
            else:
                if self.remembers:
                    for other in self.children[self.index :]:
                        reset(other)
                else:
                    self.reset_children()
                    self.index = 0
                return answer
        self.reset_children()
        all_skipped = self.skipped == len(self.children)
        self.index = self.skipped = 0  # the node may stay RUNNING
        return SKIP if all_skipped else self.goes_on

    def halt(self) -> None:
        if not self.remembers:
            self.index = 0
        super().halt()


class Sequence(InTurn):
    pass


class Fallback(InTurn):
    goes_on = F


class AsyncSequence(InTurn):
    yields = True


class AsyncFallback(InTurn):
    goes_on, yields = F, True


class SequenceWithMemory(InTurn):
    yields, remembers = True, True


class Reactive(Node):
    goes_on = S

    def tick(self) -> str:
        self.status = R
        all_skipped = True
        for child in self.children:
            answer = child.execute()
            all_skipped &= answer == SKIP
            if answer == R:
                for other in self.children:
                    if other is not child:
                        reset(other)
                return R
            if answer == SKIP:
                reset(child)
            elif answer != self.goes_on:
                self.reset_children()
                return answer
        self.reset_children()
        return SKIP if all_skipped else self.goes_on


class ReactiveSequence(Reactive):
    pass


class ReactiveFallback(Reactive):
    goes_on = F


class Parallel(Node):
    def __init__(self, *given: Any) -> None:
        super().__init__(*given)
        self.clear()

    def clear(self) -> None:
        self.done: dict[int, str] = {}

    def tick(self) -> str:
        count = len(self.children)
        required, allowed = self.number("success_count", -1), self.number("failure_count", 1)
        successes = max(count + required + 1, 0) if required < 0 else required
        failures = max(count + allowed + 1, 0) if allowed < 0 else allowed
        if successes > count or failures > count:
            raise LibraryError
        self.status = R
        skipped = 0
        for i, child in enumerate(self.children):
            if i not in self.done:
                answer = child.execute()
                if answer == SKIP:
                    skipped += 1
                elif answer in ENDED:
                    self.done[i] = answer
            good = list(self.done.values()).count(S)
            bad = list(self.done.values()).count(F)
            result = None
            if good >= successes or (required < 0 and good + skipped >= successes):
                result = S
            elif count - bad < successes or bad == failures:
                result = F
            if result:
                self.clear()
                self.reset_children()
                return result
        return SKIP if skipped == count else R

    def halt(self) -> None:
        self.clear()
        super().halt()


class ParallelAll(Parallel):
    def tick(self) -> str:
        count = len(self.children)
        limit = self.number("max_failures", 1)
        limit = max(count + limit + 1, 0) if limit < 0 else limit
        if limit > count:
            raise LibraryError
        self.status = R
        skipped = 0
        for i, child in enumerate(self.children):
            if i not in self.done:
                answer = child.execute()
                if answer == SKIP:
                    skipped += 1
                elif answer in ENDED:
                    self.done[i] = answer
        if skipped == count:
            return SKIP
        if skipped + len(self.done) >= count:
            bad = list(self.done.values()).count(F)
            self.clear()
            self.reset_children()
            return F if bad >= limit else S
        return R


class IfThenElse(Node):
    branch = 0

    def tick(self) -> str:
        self.status = R
        if self.branch == 0:
            answer = self.children[0].execute()
            if answer == R:
                return R
            if answer == SKIP:
                raise LibraryError
            if answer == F and len(self.children) == 2:
                return F
            self.branch = 1 if answer == S else 2
        answer = self.children[self.branch].execute()
        if answer == R:
            return R
        self.reset_children()
        self.branch = 0
        return answer

    def halt(self) -> None:
        self.branch = 0
        super().halt()


class WhileDoElse(Node):
    def tick(self) -> str:
        self.status = R
        answer = self.children[0].execute()
        if answer == R:
            return R
        if answer == SKIP:
            raise LibraryError
        if answer == S:
            if len(self.children) == 3:
                reset(self.children[2])
            answer = self.children[1].execute()
        else:
            reset(self.children[1])
            answer = self.children[2].execute() if len(self.children) == 3 else F
        if answer != R:
            self.reset_children()
        return answer


class Switch(Node):
    running: Node | None = None

    def tick(self) -> str:
        self.status = R
        variable = self.text("variable")
        chosen = self.children[-1]
        for i, child in enumerate(self.children[:-1]):
            if variable == self.text(f"case_{i + 1}"):
                chosen = child
                break
        if self.running not in (None, chosen):
            reset(self.running)  # type: ignore[arg-type]
        answer = chosen.execute()
        self.running = chosen if answer == R else None
        if answer in ENDED:
            self.reset_children()
        return answer

    def halt(self) -> None:
        self.running = None
        super().halt()

    def text(self, port: str) -> str:
        value = self.ports[port]
        return str(self.world.entries[value.strip("{}")]) if value.startswith("{") else value


class TryCatch(Node):
    index, catching, skipped = 0, False, 0

    def tick(self) -> str:
        if self.status == IDLE:
            self.skipped = 0
        self.status = R
        *tried, catch = self.children
        while not self.catching and self.index < len(tried):
            answer = tried[self.index].execute()
            if answer == R:
                return R
            if answer == F:
                for child in tried:
                    reset(child)
                self.catching = True
            else:
                self.skipped += answer == SKIP
                self.index += 1
        if self.catching:
            if catch.execute() == R:
                return R
            result = F
        else:
            result = SKIP if self.skipped == len(tried) else S
        self.reset_children()
        self.index, self.catching, self.skipped = 0, False, 0
        return result

    def halt(self) -> None:
        if not self.catching and self.ports.get("catch_on_halt") == "true":
            for child in self.children[:-1]:
                reset(child)
            self.children[-1].execute()
        self.index, self.catching = 0, False
        super().halt()


# --------------------------------------------------------------------- decorators


class Decorator(Node):
    """A node with one child. `PORTS`: port -> values in random trees, for a class that `random_trees` does not list."""

    PORTS: ClassVar[dict[str, tuple[str, ...]]] = {}

    def execute(self) -> str:
        answer = super().execute()
        if self.child.status in ENDED:
            self.child.status = IDLE
        return answer

    @property
    def child(self) -> Node:
        return self.children[0]


class Mapped(Decorator):
    to: ClassVar[dict[str, str]] = {}

    def tick(self) -> str:
        self.status = R
        answer = self.child.execute()
        return self.to.get(answer, answer)


class Inverter(Mapped):
    to: ClassVar = {S: F, F: S}


class ForceSuccess(Mapped):
    to: ClassVar = {F: S}


class ForceFailure(Mapped):
    to: ClassVar = {S: F}


class KeepRunningUntilFailure(Mapped):
    to: ClassVar = {S: R, SKIP: R}


class SubTree(Mapped):
    pass


class Counting(Decorator):
    """`Repeat` and `RetryUntilSuccessful`."""

    port, counted = "num_cycles", S
    count = 0

    def tick(self) -> str:
        limit = self.number(self.port)
        self.status = R
        while limit == -1 or self.count < limit:
            previous = self.child.status
            answer = self.child.execute()
            if answer in (R, SKIP):
                return answer
            reset(self.child)
            if answer != self.counted:
                self.count = 0
                return answer
            self.count += 1
            if self.counted == F and self.world.version >= (4, 7):
                limit = self.number(self.port)
            if previous == IDLE and (limit == -1 or self.count < limit):
                return R
        self.count = 0
        return self.counted

    def halt(self) -> None:
        self.count = 0
        super().halt()


class Repeat(Counting):
    pass


class RetryUntilSuccessful(Counting):
    port, counted = "num_attempts", F


class Delay(Decorator):
    left: int | None = None

    def tick(self) -> str:
        if self.left is None:
            self.left = self.world.ticks(self.number("delay_msec"))
            self.status = R
        if self.left > 0:
            self.left -= 1
            return R
        answer = self.child.execute()
        if answer in ENDED:
            self.left = None
        return answer

    def halt(self) -> None:
        self.left = None
        super().halt()


class Timeout(Decorator):
    age: int | None = None

    def tick(self) -> str:
        if self.age is None:
            self.age = 0
            self.status = R
        else:
            self.age += 1
            limit = self.world.ticks(self.number("msec"))
            if self.age == limit > 0 and self.child.status == R:
                reset(self.child)
                self.age = None
                return F
        answer = self.child.execute()
        if answer in ENDED:
            self.age = None
        return answer

    def halt(self) -> None:
        self.age = None
        super().halt()


class RunOnce(Decorator):
    result: str | None = None

    def tick(self) -> str:
        if self.result:
            return SKIP if self.ports.get("then_skip", "true") == "true" else self.result
        self.status = R
        answer = self.child.execute()
        if answer in ENDED:
            self.result = answer
        return answer


class Precondition(Decorator):
    passed = False

    def tick(self) -> str:
        if not self.passed or self.world.version < (4, 7):
            if not self.world.run(self.ports["if"]):
                return self.ports.get("else", F)
            self.passed = True
        answer = self.child.execute()
        if answer in ENDED:
            self.passed = False
        return answer


class Loop(Decorator):
    left: tuple[str, ...] = ()
    filled = running = False

    def tick(self) -> str:
        if self.status == IDLE:
            if self.world.version >= (4, 7) or not self.filled:
                self.left = tuple(self.ports["queue"].split(";"))
            self.filled, self.running = True, False
        if not self.running:
            if not self.left:
                return self.ports.get("if_empty", S)
            first, self.left = self.left[0], self.left[1:]
            self.world.write(self.ports["value"].strip("{}"), int(first))
        if self.status == IDLE:
            self.status = R
        answer = self.child.execute()
        self.running = answer == R
        return F if answer == F else R


class LoopInt(Loop):
    pass


class UpdateDecorator(Decorator):
    otherwise = SKIP
    seen = 0
    running = False

    def tick(self) -> str:
        if not self.running:
            now = self.world.writes.get(self.ports["entry"].strip("{}"), 0)
            if now == self.seen:
                if self.world.version >= (4, 9):
                    reset(self.child)
                return self.otherwise
            self.seen = now
        answer = self.child.execute()
        self.running = answer == R
        return answer

    def halt(self) -> None:
        self.running = False
        if self.world.version >= (4, 9):
            super().halt()


class SkipUnlessUpdated(UpdateDecorator):
    pass


class WaitValueUpdate(UpdateDecorator):
    otherwise = R


# -------------------------------------------------------------------------- Nav2


class PipelineSequence(Node):
    last = 0

    def tick(self) -> str:
        self.status = R
        skipped = 0
        for i, child in enumerate(self.children):
            answer = child.execute()
            if answer == F:
                self.halt()
                return F
            if answer == R and i >= self.last:
                self.last = i
                return R
            skipped += answer == SKIP
        self.halt()
        return SKIP if skipped == len(self.children) else S

    def halt(self) -> None:
        self.last = 0
        super().halt()


class RecoveryNode(Node):
    index, retries = 0, 0

    def tick(self) -> str:
        limit = self.number("number_of_retries", 1)
        self.status = R
        while self.retries <= limit:
            answer = self.children[self.index].execute()
            if answer == R:
                return R
            if self.index == 0 and answer == F and self.retries < limit:
                reset(self.children[0])
                self.index = 1
            elif self.index == 0:
                self.halt_all()
                return answer
            elif answer == SKIP:
                self.index = 0
                return F
            elif answer == F:
                self.halt_all()
                return F
            else:
                reset(self.children[1])
                self.retries += 1
                self.index = 0
        self.halt_all()
        return F

    def halt_all(self) -> None:
        self.halt()
        self.status = IDLE

    def halt(self) -> None:
        self.index, self.retries = 0, 0
        super().halt()


class RoundRobin(Node):
    index, failed = 0, 0

    def tick(self) -> str:
        self.status = R
        skipped, count = 0, len(self.children)
        while self.failed + skipped < count:
            answer = self.children[self.index].execute()
            if answer == R:
                return R
            self.index += 1
            if self.index == count:
                if self.ports.get("wrap_around", "false") != "true":
                    skipped += answer == SKIP
                    break
                self.index = 0
            if answer == S:
                self.failed = 0
                self.reset_children()
                return S
            self.failed += answer == F
            skipped += answer == SKIP
        self.halt()
        self.status = IDLE
        return SKIP if skipped == count else F

    def halt(self) -> None:
        self.index, self.failed = 0, 0
        super().halt()


class NonblockingSequence(Node):
    def tick(self) -> str:
        self.status = R
        result = S
        for child in self.children:
            answer = child.execute()
            if answer == F:
                self.reset_children()
                return F
            if answer == SKIP:
                raise LibraryError
            if answer == R:
                result = R
        if result == S:
            self.reset_children()
        return result


class PersistentSequence(Node):
    def tick(self) -> str:
        key = self.ports["current_child_idx"].strip("{}")
        index = self.world.entries[key]
        self.status = R
        while index < len(self.children):
            answer = self.children[index].execute()
            if answer == R:
                return R
            if answer == F:
                self.reset_children()
                self.world.write(key, 0)
                return F
            index += 1
            self.world.write(key, index)
        self.reset_children()
        self.world.write(key, 0)
        return S


class RateController(Decorator):
    age = 0
    first = True

    def tick(self) -> str:
        if self.status == IDLE:
            self.first, self.age = True, 0
        else:
            self.age += 1
        self.status = R
        due = self.age >= self.world.ticks(1000 / self.number("hz", 10.0))
        if not (self.first or self.child.status == R or due):
            return R
        self.first = False
        answer = self.child.execute()
        if answer == S:
            self.age = 0
        return answer


class SingleTrigger(Decorator):
    triggered = False

    def tick(self) -> str:
        if self.status == IDLE:
            self.triggered = False
        self.status = R
        if self.triggered:
            return F
        answer = self.child.execute()
        self.triggered = answer in ENDED
        return answer


class GoalUpdater(Decorator):
    def tick(self) -> str:
        return self.child.execute()


class WorldController(Decorator):
    """`DistanceController` and `GoalUpdatedController`: the child is ticked at the first tick after IDLE, while it is
    RUNNING, and when the event has occurred."""

    first = True

    def tick(self) -> str:
        if self.status == IDLE:
            self.first = True
        self.status = R
        if not (self.first or self.child.status == R or self.world.happens):
            return R
        self.first = False
        return self.child.execute()


class DistanceController(WorldController):
    pass


class GoalUpdatedController(WorldController):
    pass


class SpeedController(Decorator):
    """With the event, the speed is the highest and the period the shortest."""

    first, age = True, 0

    def tick(self) -> str:
        if self.status == IDLE:
            self.first, self.age = True, 0
        else:
            self.age += 1
        self.status = R
        rate = self.number("max_rate", 1.0) if self.world.happens else self.number("min_rate", 0.1)
        if not self.first and self.child.status != R:
            if self.age < self.world.ticks(1000 / rate):
                return R
            self.age = 0
        self.first = False
        return self.child.execute()


class PathLongerOnApproach(Decorator):
    def tick(self) -> str:
        self.status = R
        return self.child.execute() if self.world.happens else S


class PauseResumeController(Node):
    """Children: resumed, paused, on pause, on resume. A request is seen at the next tick."""

    child = 0

    def tick(self) -> str:
        self.status = R
        count = len(self.children)
        if self.world.happens and self.child in (0, 1):
            left = self.child
            if left < count:
                reset(self.children[left])
            self.child = (2 if count > 2 else 1) if left == 0 else (3 if count > 3 else 0)
        if self.child >= count:
            return R
        child = self.children[self.child]
        answer = child.execute()
        if answer == R:
            return R
        reset(child)
        if answer == F or self.child == 0:
            self.child = 0
            self.reset_children()
            return F if answer == F else S
        self.child = {1: 1, 2: 1, 3: 0}[self.child]
        return R

    def halt(self) -> None:
        self.child = 0
        super().halt()


# ------------------------------------------------------------------------- leaves


class AlwaysSuccess(Node):
    def tick(self) -> str:
        return S


class AlwaysFailure(Node):
    def tick(self) -> str:
        return F


class Sleep(Node):
    left = 0

    def tick(self) -> str:
        if self.status == IDLE:
            self.left = self.world.ticks(self.number("msec"))
        elif self.status != R:
            return self.status
        else:
            self.left -= 1
        return R if self.left > 0 else S


class Script(Node):
    def tick(self) -> str:
        self.world.run(self.ports["code"])
        return S


class ScriptCondition(Node):
    def tick(self) -> str:
        return S if self.world.run(self.ports["code"]) else F


class SetBlackboard(Node):
    def tick(self) -> str:
        value = self.ports["value"]
        known = self.world.entries[value.strip("{}")] if value.startswith("{") else int(value)
        self.world.write(self.ports["output_key"], known)
        return S


class WasEntryUpdated(Node):
    seen = 0

    def tick(self) -> str:
        now = self.world.writes.get(self.ports["entry"].strip("{}"), 0)
        old, self.seen = self.seen, now
        return S if now != old else F


class Check(Node):
    """A condition of the program."""

    def tick(self) -> str:
        answer = self.world.draw(self.name)
        self.world.calls.append((self.name, answer))
        return answer


class Act(Node):
    """A stateful action of the program, which is RUNNING for some ticks."""

    duration = 0
    left = 0

    def tick(self) -> str:
        if self.status in ENDED:
            return self.status
        self.left = self.duration if self.status == IDLE else self.left - 1
        answer = R if self.left > 0 else self.world.draw(self.name)
        self.world.calls.append((self.name, answer))
        return answer

    def halt(self) -> None:
        self.world.calls.append((self.name, "halt"))


def node_class(type_: str) -> Callable[..., Node]:
    """The class of a type of node; `Act2` is an `Act` of two ticks."""
    if type_.startswith("Switch"):
        return Switch
    if type_.startswith("Act"):
        return type("Act", (Act,), {"duration": int(type_[3:])})
    known: Callable[..., Node] = globals()[type_]
    return known
